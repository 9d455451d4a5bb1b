"""The likely mistake in an exercise that is no operation: a wrong function that does the same.

The folder `known_mistakes` has a text file for each exercise: a right function, two empty lines,
and patches of it in the form of `numpy_cae.verify.operations.patch`.
"""

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np

from numpy_cae.course.exercises import CATALOGUE
from numpy_cae.course.exercises.lesson_12 import VERDICTS
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.diagnosis import SEVERAL, same
from numpy_cae.verify.operations.patch import Patch, patches_in
from numpy_cae.verify.operations.property import Property, drawn_upstream
from numpy_cae.verify.operations.trial import failure

FOLDER = Path(__file__).parent / "known_mistakes"
SHOWN_BY = {VERDICTS.operation: VERDICTS}
"""What shows which mistake an exercise has, where a property that fails does not."""


def likely_mistake(stated: Property, implementation: Callable) -> str:
    """The sentence on the mistake because of which a property does not hold, or "".

    It is named only if the wrong function does in every case of the property what the
    implementation does, and the right one in several cases does not.
    """
    stated = SHOWN_BY.get(stated.operation, stated)
    name, cases = stated.operation, stated.cases()
    for observed in (_of_one_call, _of_every_call):
        results = [observed(stated, implementation, case) for case in cases]
        right = (observed(stated, CATALOGUE[name].solution, case) for case in cases)
        if sum(not same(*pair) for pair in zip(results, right, strict=True)) < SEVERAL:
            continue  # it fails with other arguments, which the check makes of the case's
        for sentence, wrong in wrong_functions(name):
            others = (observed(stated, wrong, case) for case in cases)
            if all(same(*pair) for pair in zip(results, others, strict=False)):
                return sentence
    return ""


@cache
def wrong_functions(name: str) -> tuple[tuple[str, Callable], ...]:
    """What is wrong, and the wrong function, for each known mistake in an exercise."""
    return tuple((patch.sentence, _function(patch, right)) for right, patch in patches_of(name))


def patches_of(name: str) -> Iterator[tuple[str, Patch]]:
    """The source of a right function, and a patch of it, for each known mistake."""
    path = FOLDER / f"{name}.txt"
    if path.is_file():
        right, _, patches = path.read_text("utf-8").rpartition("\n\n\n")
        yield from ((right, patch) for patch in patches_in(patches, name))


def _function(patch: Patch, right: str) -> Callable:
    space = {"np": np, **{name: each.solution for name, each in CATALOGUE.items()}}
    source = "\n".join(patch.changed(right.splitlines()))
    exec(compile(source, f"<{patch.name}>", "exec"), space)
    return space[patch.operation]


def _of_one_call(stated: Property, function: Callable, case: Case) -> list[np.ndarray]:
    """All that a call with the case's arguments returns, and the arguments afterwards."""
    given = list(stated.arguments(case).values())
    try:
        with np.errstate(all="ignore"):
            return [*_arrays(function(*given), case), *_arrays(given, case)]
    except (Exception, SystemExit) as error:
        return [np.array(type(error).__name__)]


def _of_every_call(stated: Property, function: Callable, case: Case) -> list[np.ndarray]:
    """All that the calls of the property's check return."""
    seen: list[np.ndarray] = []

    def recorded(*arguments):
        try:
            returned = function(*arguments)
        except Exception as error:
            seen.append(np.array(type(error).__name__))
            raise
        seen.extend([np.array("returned"), *_arrays(returned, case), *_arrays(arguments, case)])
        return returned

    failure(stated, recorded, case)
    return seen


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
