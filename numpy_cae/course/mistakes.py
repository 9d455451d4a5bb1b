"""The likely mistake in an exercise that is no operation: a wrong function that does the same.

The folder `known_mistakes` has a text file for each exercise: patches of its solution in the form
of `numpy_cae.verify.operations.patch`.
"""

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np

from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.diagnosis import SEVERAL, same
from numpy_cae.verify.operations.patch import Patch, patches_in
from numpy_cae.verify.operations.property import Property, drawn_upstream, failure

FOLDER = Path(__file__).parent / "known_mistakes"


def likely_mistake(stated: Property, implementation: Callable, solution: Callable) -> str:
    """The sentence on the mistake because of which a property does not hold, or "".

    It is named only if the wrong function does in every case of the property what the
    implementation does, and the solution in several cases does not.
    """
    cases = stated.cases()
    for observed in (_of_one_call, _of_every_call):
        results = [observed(stated, implementation, case) for case in cases]
        right = (observed(stated, solution, case) for case in cases)
        if sum(not same(*pair) for pair in zip(results, right, strict=True)) < SEVERAL:
            continue  # it fails with other arguments, which the check makes of the case's
        for patch in patches_of(stated.operation):
            wrong = wrong_function(patch, solution)
            others = (observed(stated, wrong, case) for case in cases)
            if all(same(*pair) for pair in zip(results, others, strict=False)):
                return patch.sentence
    return ""


@cache
def patches_of(name: str) -> tuple[Patch, ...]:
    """The known mistakes in an exercise, as patches of its solution."""
    path = FOLDER / f"{name}.txt"
    return tuple(patches_in(path.read_text("utf-8"), name)) if path.is_file() else ()


@cache
def wrong_function(patch: Patch, solution: Callable) -> Callable:
    """The solution with a known mistake."""
    return patch.applied_to(solution)


def _of_one_call(stated: Property, function: Callable, case: Case) -> list[np.ndarray]:
    """All that a call with the case's arguments returns, and the arguments afterwards."""
    given = list(stated.arguments(case).values())
    try:
        with np.errstate(all="ignore"):
            return [*_arrays(function(*given), case), *_arrays(given, case)]
    except (Exception, SystemExit) as error:
        return [_named(error)]


def _of_every_call(stated: Property, function: Callable, case: Case) -> list[np.ndarray]:
    """All that the calls of the property's check return."""
    seen: list[np.ndarray] = []

    def recorded(*arguments):
        try:
            returned = function(*arguments)
        except Exception as error:
            seen.append(_named(error))
            raise
        seen.extend([np.array("returned"), *_arrays(returned, case), *_arrays(arguments, case)])
        return returned

    failure(stated, recorded, case)
    return seen


def _named(error: BaseException) -> np.ndarray:
    """The error by its type and text; of an AssertionError, the text is the student's own."""
    is_own = isinstance(error, AssertionError)
    return np.array(type(error).__name__ if is_own else repr(error))


def _arrays(thing: object, case: Case) -> Iterator[np.ndarray]:
    """The arrays and numbers in a thing, those that a pullback returns, and a recorder's calls."""
    if hasattr(thing, "calls"):
        yield from _arrays(thing.calls, case)
    elif isinstance(thing, dict):
        yield from _arrays([thing[name] for name in sorted(thing)], case)
    elif isinstance(thing, tuple) and len(thing) == 2 and callable(thing[1]):
        yield from _arrays(thing[0], case)
        yield from _arrays(thing[1](drawn_upstream(case, thing[0])), case)
    elif isinstance(thing, list | tuple):
        for part in thing:
            yield from _arrays(part, case)
    elif isinstance(thing, np.ndarray | np.generic | float | int):
        yield np.copy(thing)
