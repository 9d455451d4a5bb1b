"""An exercise of a lesson: the function that a student writes, and its properties.

Most exercises are operations and have the properties that `verify` states of them. The others
(forward kinematics, the features, a step of descent, ...) state their own, in the same form, so
that all are drawn, shrunk, reported and graded in the same way. The hints are in `hints.md`.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

from numpy_cae import ops
from numpy_cae.course.exercises.checks import (
    Arguments,
    Differentiated,
    purity,
    same_as,
    states,
    with_arguments,
)
from numpy_cae.verify.operations.catalogue import Exercise, properties_of_operation
from numpy_cae.verify.operations.operation import Operation, Sizes
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.shared_properties import shared_properties


def operation_exercise(name: str, given: str = "") -> Exercise:
    """An operation of `numpy_cae.ops` as an exercise: a function that returns value and pullback.

    `given` names functions of earlier lessons that a solution may call: operations, or other
    exercises.
    """
    return Exercise(
        name, getattr(ops, name), properties_of_operation(name), given=tuple(given.split())
    )


def composed_exercise(
    solution: Callable,
    arguments: Arguments,
    inputs: str,
    sizes: Sizes,
    linear_in: tuple[str, ...] = (),
    given: str = "",
) -> Exercise:
    """An exercise in the form of an operation that only the lesson has.

    The value has to be that of the solution, the gradients for the `inputs` those of the student's
    own value.
    """
    value = lambda *arguments: solution(*arguments)[0]  # noqa: E731
    names = tuple(inputs.split())
    operation = Operation(solution.__name__, sizes, arguments, names, value, linear_in)
    properties = tuple(shared_properties(operation))
    return Exercise(operation.name, solution, properties, given=tuple(given.split()))


def exercise(
    solution: Callable,
    arguments: Arguments,
    sizes: Sizes,
    *properties: Property,
    value: str = "",
    pure: bool = True,
    given: str = "",
) -> Exercise:
    """An exercise that is no operation, with properties of its own.

    `solution` is the package's own function, with the name of the exercise; `arguments` makes its
    arguments from a case, by name, in the order of the call. `value` states that a function
    returns what the solution returns; if the exercise is `pure`, a function may change no
    argument. The sizes of a property replace those of the exercise.
    """
    name = solution.__name__
    if value:
        properties = (states("value", value)(same_as(solution)), *properties)
    if pure:
        properties = (*properties, purity)
    bound = (
        replace(
            each,
            operation=name,
            check=with_arguments(each.check, arguments),
            arguments=arguments,
            sizes={**sizes, **each.sizes},
        )
        for each in properties
    )
    return Exercise(name, solution, tuple(bound), given=tuple(given.split()))


def differentiated_exercise(
    solution: Callable,
    arguments: Arguments,
    inputs: tuple[str, ...],
    returns: tuple[str, ...],
    sizes: Sizes,
    *properties: Property,
    value: str,
    gradients: Mapping[str, tuple[str, ...]],
    float32: bool = False,
    given: str = "",
) -> Exercise:
    """An exercise that returns a value and its derivatives.

    `inputs` are the arguments that get a gradient, and `returns` names what the function returns,
    as in `Differentiated`. `gradients` has, by the name of a property, the names of the arrays,
    or () for all.
    """
    function = Differentiated(solution, inputs, returns)
    properties = (
        function.value(value),
        *(function.gradient(name, only) for name, only in gradients.items()),
        *((function.keeps_float32(),) if float32 else ()),
        *properties,
    )
    return exercise(solution, arguments, sizes, *properties, given=given)
