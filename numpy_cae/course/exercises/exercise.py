"""An exercise of a lesson: the function that a student writes, and its properties.

Most exercises are operations and have the properties that `verify` states of them. The others
(forward kinematics, the features, a step of descent, ...) state their own, in the same form, so
that all are drawn, shrunk, reported and graded alike. The hints are in `hints.md`.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

from numpy_cae import ops
from numpy_cae.course.exercises.checks import Arguments, Differentiated, same_as, unchanged
from numpy_cae.verify.operations.catalogue import Exercise, properties_of
from numpy_cae.verify.operations.operation import OPERATIONS, Operation, Sizes
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shared_properties import shared_properties
from numpy_cae.verify.operations.single_properties import single_properties


def operation_exercise(
    operation: str | Operation,
    solution: Callable | None = None,
    given: str = "",
) -> Exercise:
    """An exercise in the form of `numpy_cae.ops`: a function that returns value and pullback.

    `operation` is the name of one of `numpy_cae.ops`, whose function is the default solution, or
    one that only the lesson has. `given` names functions of earlier lessons that a solution may
    call: operations, or other exercises.
    """
    if isinstance(operation, str):
        operation = OPERATIONS[operation]
    if operation.name in OPERATIONS:
        properties = properties_of(operation.name)
    else:
        properties = (*shared_properties(operation), *single_properties(operation))
    solution = solution or getattr(ops, operation.name)
    return Exercise(operation.name, solution, properties, given=tuple(given.split()))


def exercise(
    solution: Callable,
    arguments: Arguments,
    sizes: Sizes,
    *properties: Property,
    value: str = "",
    definition: Callable | None = None,
    points: int = 2,
    pure: bool = True,
    given: str = "",
) -> Exercise:
    """An exercise that is no operation, with properties of its own.

    `solution` is the package's own function, with the name of the exercise; `arguments` makes its
    arguments from a case, by name, in the order of the call. `value` states, for `points`,
    that a function returns what the definition (by default the solution) returns; if `pure`, a
    property is added: no argument is changed.
    """
    if value:
        check = same_as(definition or solution, arguments)
        properties = (Property("value", value, check, points), *properties)
    if pure:
        properties = (*properties, unchanged(arguments))
    name = solution.__name__
    stated = (
        replace(each, operation=name, arguments=arguments, sizes={**sizes, **each.sizes})
        for each in properties
    )
    return Exercise(name, solution, tuple(stated), given=tuple(given.split()))


def differentiated_exercise(
    solution: Callable,
    function: Differentiated,
    sizes: Sizes,
    *properties: Property,
    value: str,
    gradients: Mapping[str, tuple],
    float32: bool = False,
    given: str = "",
) -> Exercise:
    """An exercise that returns a value and its derivatives.

    `gradients` has, by the name of a property, its points and the names of the arrays (by default
    all).
    """
    properties = (
        function.value(value),
        *(function.gradient(name, *options) for name, options in gradients.items()),
        *((function.keeps_float32(),) if float32 else ()),
        *properties,
    )
    return exercise(solution, function.arguments, sizes, *properties, given=given)
