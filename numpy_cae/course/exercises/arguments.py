"""The arguments of an exercise, drawn as the file `lesson_NN.toml` states.

x = "batch frames channels"                    an array of these sizes
x = {array = "batch frames", within = 1.3}     with entries between -1.3 and 1.3
x = {array = "batch", within = 1.3, around = 2} with entries between 0.7 and 3.3
x = {uniform = "batch frames", within = 0.5}   between -0.5 and 0.5, on no grid
known = {half = "batch frames"}                booleans, half of them True, or one more
taps = {size = "taps"}                         a size
loss = {recorded = "LOSS"}                     the function of this text, which records its calls
q = {by = "some_joint"}                        a function of (case, rng, arguments so far)
bound = 0.9                                    a value
"""

from collections.abc import Callable, Mapping

import numpy as np

from numpy_cae.course.exercises.checks import Recorded
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.operation import shape_of

Arguments = Callable[[Case], dict[str, object]]


def drawn(entries: Mapping[str, object], space: Mapping[str, object]) -> Arguments:
    """Arguments in the order of the call; `space` has what the entries name."""

    def arguments(case: Case) -> dict[str, object]:
        rng = case.rng()
        made: dict[str, object] = {}
        for name, entry in entries.items():
            made[name] = _drawn(entry, case, rng, space, made)
        return made

    return arguments


def _drawn(
    entry: object, case: Case, rng: np.random.Generator, space: Mapping, made: dict
) -> object:
    match entry:
        case str(sizes):
            return spread(rng, shape_of(case, sizes))
        case {"array": sizes, "within": largest}:
            return spread(rng, shape_of(case, sizes), largest) + entry.get("around", 0.0)
        case {"half": sizes}:
            shape = shape_of(case, sizes)
            return rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
        case {"uniform": sizes, "within": largest}:
            return uniform(rng, shape_of(case, sizes), largest)
        case {"size": name}:
            return case[name]
        case {"recorded": name}:
            return Recorded(space[name])
        case {"by": name}:
            return space[name](case, rng, made)
    return entry


def uniform(rng: np.random.Generator, shape: tuple[int, ...], bound: float) -> np.ndarray:
    """Random entries between -bound and bound: sums of those on a grid would tie in the pooling."""
    return rng.uniform(-bound, bound, shape).round(3)
