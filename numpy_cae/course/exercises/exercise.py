"""An exercise of a lesson: the function that a student writes, and its properties.

Most exercises are operations and have the properties that `verify` states of them. The others
(forward kinematics, the features, a step of descent, ...) state their own, in the same form, so
that all are drawn, shrunk, reported and graded in the same way.

The text file `lesson_NN.toml` states the exercises of a lesson. The entry `makes` says what they
add up to. Each table is an exercise:

points      what the exercise earns
arguments   how each argument is drawn, or a function that draws all (`arguments.py`)
like        an operation of `numpy_cae.ops` that has the same arguments and sizes
sizes       the options of each size, the simplest first
            "values" are the classes of values, CLASSES in `arguments.py`
inputs      the arguments that get a gradient
returns     what the function returns: the value, then `the pullback` or the gradients; without it,
            a function with inputs is an operation that only the lesson has
linear_in   the arguments in which such an operation is linear
float32     whether float32 has to stay float32 (`every_exercise.toml`)
pure        false if no argument can be altered (`every_exercise.toml`)
given       what a solution may call: operations, and exercises of earlier lessons
hints       the hints that `course.report` prints with hint=1, a direction, and hint=2
hint_for    with the second hint: the hint of a property that does not hold
properties  the statement of each property, or a table with it and fields of `Property`;
            `gradient` names the arrays whose gradients the property is about, "" being all, and
            `part` the only one of several results that it is about, or the only columns

The checks that only one exercise has are in `own_checks.py`. An exercise without arguments is an
operation of `numpy_cae.ops`.
"""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

from numpy_cae import ops
from numpy_cae.course.exercises import arguments, checks
from numpy_cae.course.exercises.own_checks import CHECKS
from numpy_cae.course.solutions import building_blocks, first_paper, second_paper
from numpy_cae.course.suspects import accuse
from numpy_cae.verify.operations.operation import OPERATIONS, Operation, sizes_of
from numpy_cae.verify.operations.operation_catalogue import Exercise, properties_of_operation
from numpy_cae.verify.operations.property import EXAMPLES, GRADIENT, REST, VALUE, Property
from numpy_cae.verify.operations.shared_properties import shared_properties

FOLDER = Path(__file__).parent
SOLUTIONS = vars(building_blocks) | vars(first_paper) | vars(second_paper) | {"accuse": accuse}
TABLES = {
    path.stem.removeprefix("lesson_"): tomllib.loads(path.read_text(encoding="utf-8"))
    for path in sorted(FOLDER.glob("*.toml"))
}
SHARED_PROPERTIES = TABLES.pop("every_exercise")
"""The properties that exercises share, by the entry that states that they have them."""
MAKES = {number: table.pop("makes") for number, table in TABLES.items()}
"""What the exercises of each lesson add up to, by the number of the lesson, 00 to 14."""
ENTRIES = {name: entries for table in TABLES.values() for name, entries in table.items()}
"""What is stated of each exercise."""


@cache
def hints_of(name: str) -> tuple[list[str], dict[str, str]]:
    """The two hints of an exercise, and those of its properties by name; none of others."""
    entries = ENTRIES.get(name, {})
    stages = [" ".join(hint.split()) for hint in entries.get("hints", ())]
    return stages, {n: " ".join(hint.split()) for n, hint in entries.get("hint_for", {}).items()}


def with_hint(exercise: Exercise, stage: int) -> Exercise:
    """The exercise with a hint that a report shows; at stage 0, how to get a hint.

    Raises a ValueError if there is no such stage.
    """
    if stage not in (0, 1, 2):
        raise ValueError(f"hint is 1 or 2, got {stage!r}")
    stages, of_properties = hints_of(exercise.name)
    if not stages:
        return exercise
    if stage == 0:
        more = f'course.report("{exercise.name}", {exercise.name}, hint=1) in a cell of your own'
        return replace(exercise, hint=f"{more} prints one")
    if stage == 1:
        return replace(exercise, hint=f"{stages[0]} (more: hint=2)")
    properties = (replace(p, hint=of_properties.get(p.name, "")) for p in exercise.properties)
    return replace(exercise, properties=tuple(properties), hint=stages[1])


def exercises_of(number: str) -> tuple[Exercise, ...]:
    """The exercises of a lesson."""
    exercises = []
    for name, entries in TABLES[number].items():
        if "arguments" in entries or "like" in entries:
            solution = SOLUTIONS[name]
            properties = tuple(_properties(solution, entries))
        else:
            solution = getattr(ops, name)
            properties = properties_of_operation(name)
        exercises.append(Exercise(name, solution, properties, provided=_words(entries, "given")))
    return tuple(exercises)


def _properties(solution: Callable, entries: Mapping) -> Sequence[Property]:
    """Those of an operation if a function returns a value and its pullback, else those stated."""
    operation = _as_operation(solution, entries)
    if operation.differentiated and "returns" not in entries:
        return [_without_tiny_in_float32(property_) for property_ in shared_properties(operation)]
    forms = dict(entries.get("properties", {}))
    for entry, default in (("float32", False), ("pure", True)):
        if entries.get(entry, default):
            forms |= SHARED_PROPERTIES[entry]
    returns = tuple(entries.get("returns", ()))
    properties = []
    for name, form in forms.items():
        form = {"states": form} if isinstance(form, str) else form
        properties.append(_property(operation, returns, name, form))
    return properties


def _without_tiny_in_float32(property_: Property) -> Property:
    """The property; that of the dtype without tiny numbers, whose order float32 may change."""
    if property_.name != "dtype" or "values" not in property_.sizes:
        return property_
    values = tuple(name for name in property_.sizes["values"] if name != "tiny")
    return replace(property_, sizes={**property_.sizes, "values": values})


def _as_operation(solution: Callable, entries: Mapping) -> Operation:
    """An exercise, with the arguments of an operation, or drawn as stated, or by a function.

    The value has to be that of the solution, the gradients those of the student's value.
    """
    sizes = sizes_of(entries.get("sizes", {}))
    if "like" in entries:
        operation = OPERATIONS[entries["like"]]
        draw = operation.arguments
        sizes = {**operation.sizes, **sizes}
    elif isinstance(entries["arguments"], str):
        draw = getattr(arguments, entries["arguments"])
    else:
        draw = arguments.draw_as_stated(entries["arguments"])
    return Operation(
        solution.__name__,
        sizes,
        draw,
        _words(entries, "inputs"),
        linear_in=_words(entries, "linear_in"),
        reference=solution,
        by_differences=True,
        saturates="values" in entries.get("sizes", {}),
    )


def _property(exercise: Operation, returns: checks.Names, name: str, entry: Mapping) -> Property:
    check = _check(exercise, returns, name, entry)
    group = REST if entry.get("form") else VALUE
    if "gradient" in entry:
        group = GRADIENT
    return Property(
        name,
        entry.get("states", checks.AGREES),
        lambda function, case: check(function, case, **exercise.arguments(case)),
        operation=exercise.name,
        arguments=exercise.arguments,
        sizes={**exercise.sizes, **sizes_of(entry.get("sizes", {}))},
        group=group,
        examples=entry.get("examples", EXAMPLES),
    )


def _check(exercise: Operation, returns: checks.Names, name: str, entry: Mapping) -> Callable:
    """The check that only this exercise has, or the usual one for this property."""
    if special := CHECKS.get((exercise.name, name)):
        return special
    if any(name in shared for shared in SHARED_PROPERTIES.values()):
        return partial(getattr(checks, name), exercise.arguments)
    inputs = exercise.differentiated
    if name == "upstream default":
        check = partial(checks.upstream_is_one, returns)
    elif "gradient" in entry:
        chosen = _words(entry, "gradient")
        solution = SOLUTIONS[exercise.name]
        check = partial(checks.gradients_agree, solution, inputs, returns, chosen)
    else:
        part = returns[0] if inputs else entry.get("part")
        check = partial(checks.agrees, SOLUTIONS[exercise.name], returns, part)
    return checks.on_copies(check)


def _words(entries: Mapping, name: str) -> tuple[str, ...]:
    """The words of an entry; none without it."""
    return tuple(entries.get(name, "").split())
