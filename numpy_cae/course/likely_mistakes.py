"""The likely mistake in an exercise that is no operation: a wrong function that does the same.

The folder `known_mistakes` has a text file for each exercise: patches of its solution in the form
of `numpy_cae.verify.operations.patch`.
"""

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from numpy_cae.course.exercises.checks import arrays_in
from numpy_cae.course.exercises.gradient_trials import VERDICTS
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.counterexample import failing_case, failure
from numpy_cae.verify.operations.diagnosis import SEVERAL, misplaced_gradient, same
from numpy_cae.verify.operations.operation_catalogue import Exercise
from numpy_cae.verify.operations.patch import Patch, patches_in
from numpy_cae.verify.operations.property import Property

FOLDER = Path(__file__).parent / "known_mistakes"
SHOWN_BY = {VERDICTS.operation: VERDICTS}
"""What shows which mistake an exercise has, where a property that fails does not."""

SHAPE = re.compile(r"\(\d+,(?:\d+,?)*\)")
"""A shape in the message of an error, as NumPy writes it: (1,2,3)."""
Observation = list[np.ndarray]
Observe = Callable[[Property, Callable, Case], Observation]


@cache
def patches_of(name: str) -> tuple[Patch, ...]:
    """The known mistakes in an exercise, as patches of its solution."""
    path = FOLDER / f"{name}.txt"
    return tuple(patches_in(path.read_text("utf-8"), name)) if path.is_file() else ()


@cache
def wrong_function(patch: Patch, solution: Callable) -> Callable:
    """The solution with a known mistake."""
    return patch.applied_to(solution)


def diagnose_exercise(exercise: Exercise) -> Callable[[Property, Callable], str]:
    """The function that names the mistake in an implementation of an exercise, or ""."""

    def diagnose(tested: Property, implementation: Callable) -> str:
        shown_by = SHOWN_BY.get(tested.operation, tested)
        mistake = likely_mistake(shown_by, implementation, exercise)
        operation = getattr(tested.check, "operation", None)
        if mistake or operation is None:
            return mistake
        return misplaced_gradient(tested, operation, implementation)

    return diagnose


def likely_mistake(tested: Property, implementation: Callable, exercise: Exercise) -> str:
    """The sentence on the mistake because of which a property does not hold, or "".

    It is named only if the wrong function does in every case of the property what the
    implementation does, the solution in several cases does not, and the implementation fails where
    the mistake is caught, too.
    """
    property_named = {property_.name: property_ for property_ in exercise.properties}
    for observe in (_observe_one_call, _observe_every_call):
        for patch in _patches_that_do_the_same(tested, implementation, exercise, observe):
            caught_by = property_named[patch.caught_by]
            if failing_case(caught_by, implementation) is not None:
                return patch.sentence
    return ""


def _patches_that_do_the_same(
    tested: Property, implementation: Callable, exercise: Exercise, observe: Observe
) -> list[Patch]:
    """The known mistakes with which the solution does what an implementation does in every case.

    None, where the solution itself does so in all cases but a few. The cases are tried one by one,
    smallest arrays first, and only with the mistakes that are left: an unknown mistake, of which
    none is left after a case or two, is told as fast as a right answer.
    """
    patches = list(patches_of(tested.operation))
    cases_that_differ = 0
    for case in tested.cases():
        if not patches:
            return []
        observation = observe(tested, implementation, case)
        doing_the_same = []
        for patch in patches:
            wrong = wrong_function(patch, exercise.solution)
            if same(observation, observe(tested, wrong, case)):
                doing_the_same.append(patch)
        patches = doing_the_same
        if patches and not same(observation, observe(tested, exercise.solution, case)):
            cases_that_differ += 1
    if cases_that_differ < SEVERAL:
        return []  # it fails with other arguments, which the check makes of the case's
    return patches


def _observe_one_call(tested: Property, function: Callable, case: Case) -> Observation:
    """All that a call with the case's arguments returns, and the arguments afterwards."""
    arguments = list(tested.arguments(case).values())
    try:
        with np.errstate(all="ignore"):
            return arrays_in([function(*arguments), arguments], case)
    except (Exception, SystemExit) as error:
        return [_as_array(error)]


def _observe_every_call(tested: Property, function: Callable, case: Case) -> Observation:
    """All that the calls of the property's check return."""
    observation: Observation = []

    def record(*arguments):
        try:
            returned = function(*arguments)
        except Exception as error:
            observation.append(_as_array(error))
            raise
        observation.extend([np.array("returned"), *arrays_in([returned, arguments], case)])
        return returned

    failure(tested, record, case)
    return observation


def _as_array(error: BaseException) -> np.ndarray:
    """The error by its type and text; of an AssertionError, the text is the student's own.

    Where the text names shapes, those count: their order is that of two summands.
    """
    name = type(error).__name__
    if isinstance(error, AssertionError):
        return np.array(name)
    shapes = sorted(SHAPE.findall(str(error)))
    return np.array(f"{name} {shapes}" if shapes else repr(error))
