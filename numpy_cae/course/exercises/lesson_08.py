"""The exercises of lesson 08, using the manifold: blind repair, filling in, comparing, and the
linear map that all of it is measured against."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from numpy_cae.course.exercises.exercise import (
    Claim,
    Exercise,
    copies,
    exercise,
    require_same,
    same_as,
    unaltered,
)
from numpy_cae.manifold.blind import lost_share
from numpy_cae.manifold.compare import G
from numpy_cae.measures import retrieval
from numpy_cae.verify.case import Case, spread

WINDOWS = {"batch": (1, 2), "frames": (2, 3, 4, 6), "channels": (1, 2, 3)}


@dataclass(frozen=True)
class Blur:
    """A projection that no one takes for the identity: of each frame and the one before it."""

    share: float

    def __call__(self, x: np.ndarray) -> np.ndarray:
        return self.share * x + (1 - self.share) * np.roll(x, 1, axis=1) + 0.1

    def __repr__(self) -> str:
        return f"lambda x: {self.share} * x + {1 - self.share} * np.roll(x, 1, axis=1) + 0.1"


def rescale(x):
    """X_c / (1 - p̂), with the share that is zero of each window."""
    return x / (1 - lost_share(x))


def denoising_weights(second, cross, kept):
    """M⁻¹ B of `numpy_cae.baselines.Moments`, one probability for every value."""
    m = kept**2 * second
    np.fill_diagonal(m, kept * np.diag(second))
    return np.linalg.solve(m, kept * cross)


def fill_unknown(x, known, project):
    """The projection of what is known, taken where nothing is."""
    return np.where(known, x, project(np.where(known, x, 0.0)))


def average_precision(distances, alike):
    """Of one query: the precision at the rank of each motion that is alike, averaged."""
    return float(retrieval.average_precision(distances[None], alike[None])[0])


def _damaged(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    x = spread(rng, shape)
    for window in range(shape[0]):
        for channel in range(shape[2]):
            lost = rng.permutation(shape[1])[: rng.integers(1, shape[1])]
            x[window, lost, channel] = 0.0
    x = np.concatenate([x, np.zeros((*shape[:2], case["still"]))], axis=2)
    return {"x": x}


def _whole(case: Case) -> dict[str, object]:
    return {"x": spread(case.rng(), (case["batch"], case["frames"], case["channels"]))}


def _counted_and_divided(x):
    """The share of zeros window by window, features that never move left out."""
    result = np.empty(x.shape)
    for n, window in enumerate(x):
        zeros = entries = 0
        for feature in window.T:
            if any(value != 0 for value in feature):
                zeros += sum(value == 0 for value in feature)
                entries += len(feature)
        result[n] = window / (1 - zeros / entries)
    return result


def _samples(case: Case) -> tuple[np.ndarray, np.ndarray]:
    rng = case.rng()
    inputs = case["inputs"]
    z = rng.standard_normal((2 * inputs + 2, inputs))
    mixed = z @ rng.standard_normal((inputs, inputs))
    return mixed, mixed @ rng.standard_normal((inputs, case["outputs"])) + z[:, :1]


def _moments(case: Case) -> dict[str, object]:
    z, x = _samples(case)
    return {"second": z.T @ z / len(z), "cross": z.T @ x / len(z), "kept": case["tenths"] / 10}


def _best_of_all_masks(denoising_weights, case: Case) -> None:
    """Every way of losing values, as often as it happens, in one least-squares problem."""
    z, x = _samples(case)
    kept = case["tenths"] / 10
    rows, wanted = [], []
    for mask in product((0.0, 1.0), repeat=z.shape[1]):
        mask = np.array(mask)
        often = np.sqrt(np.prod(np.where(mask == 1, kept, 1 - kept)))
        rows.append(often * mask * z)
        wanted.append(often * x)
    expected = np.linalg.lstsq(np.concatenate(rows), np.concatenate(wanted), rcond=None)[0]
    found = denoising_weights(*copies(_moments(case)))
    require_same(found, expected, ("the weights",))


def _holes(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    known = rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
    return {"x": spread(rng, shape), "known": known, "project": Blur(0.75)}


def _holes_of_nothing(case: Case) -> dict[str, object]:
    arguments = _holes(case)
    arguments["x"][~arguments["known"]] = np.nan
    return arguments


def _known_kept(fill_unknown, case: Case) -> None:
    x, known, project = _holes(case).values()
    require_same(fill_unknown(x.copy(), known.copy(), project)[known], x[known], ("what is known",))


def _units(case: Case) -> dict[str, object]:
    rng = case.rng()
    k = case["units"]
    both = spread(rng, (case["first"] + case["second"], k), 0.9)
    return {"y_0": both[: case["first"]], "y_1": both[case["first"] :]}


def _equation_4(y_0, y_1):
    total = 0.0
    for one, other in zip(y_0.T, y_1.T, strict=True):
        total += (max(one) - max(other)) ** 2 + (min(one) - min(other)) ** 2
    return total


def _when_is_no_matter(function, case: Case) -> None:
    y_0, y_1 = _units(case).values()
    later = case.rng().permutation(len(y_0))
    before = function(y_0.copy(), y_1.copy())
    require_same(
        function(y_0[later], y_1.copy()), before, ("G of the same units in another order",)
    )


def _ranked(case: Case) -> dict[str, object]:
    rng = case.rng()
    alike = np.arange(case["motions"]) < min(case["alike"], case["motions"])
    distances = spread(rng, (case["motions"],)) + 3.0
    return {"distances": distances, "alike": rng.permutation(alike)}


def _by_ranks(distances, alike):
    found, precisions = 0, []
    for rank, motion in enumerate(sorted(range(len(distances)), key=lambda n: distances[n]), 1):
        if alike[motion]:
            found += 1
            precisions.append(found / rank)
    return sum(precisions) / len(precisions)


def _one_at_best(function, case: Case) -> None:
    distances, alike = _ranked(case).values()
    first = np.where(alike, distances, distances + 10.0)
    require_same(function(first, alike.copy()), 1.0, ("where all that is alike comes first, it",))


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "rescale",
        "count the zeros of each window over its frames and features, leaving out features that "
        "are zero in every frame, and divide; keepdims=True keeps the axes for the division",
        rescale,
        _damaged,
        {**WINDOWS, "still": (0,)},
        (
            Claim(
                "value",
                "each window is divided by the share of it that is not zero",
                same_as(_counted_and_divided, _damaged),
                3,
                "one share for each window, over both other axes",
            ),
            Claim(
                "still features",
                "a feature that is zero in every frame does not count",
                same_as(_counted_and_divided, _damaged),
                2,
                "(x == 0).all(axis=1) says of which features nothing can be told",
                {"still": (1, 2)},
            ),
            Claim(
                "nothing lost",
                "a window without zeros stays as it is",
                same_as(lambda x: x, _whole),
            ),
            unaltered(_damaged),
        ),
    ),
    exercise(
        "denoising_weights",
        "M and B are expectations over the masks: two different values are both kept with "
        "probability kept squared, a value with itself with probability kept",
        denoising_weights,
        _moments,
        {"inputs": (1, 2, 3, 4), "outputs": (1, 2), "tenths": (5, 3, 8)},
        (
            Claim(
                "value",
                "they are the least-squares weights over every way of losing values, counted out",
                _best_of_all_masks,
                4,
                "the diagonal of M is multiplied by kept once, everything else twice",
            ),
            Claim(
                "nothing lost",
                "with kept = 1 they are ordinary least squares",
                _best_of_all_masks,
                2,
                "np.linalg.solve(m, b) solves M A = B",
                {"tenths": (10,)},
            ),
            unaltered(_moments),
        ),
    ),
    exercise(
        "fill_unknown",
        "three steps: zero where nothing is known, project, and take back only what was unknown; "
        "np.where does the first and the last",
        fill_unknown,
        _holes,
        WINDOWS,
        (
            Claim(
                "value",
                "the unknown is the projection's, of a window with zeros there",
                same_as(fill_unknown, _holes),
                3,
                "project is given the whole window, and called once",
            ),
            Claim("known", "what is known stays, to the bit", _known_kept, 1),
            Claim(
                "nothing there",
                "it does not matter what stands where nothing is known: it may be NaN",
                same_as(fill_unknown, _holes_of_nothing),
                2,
                "0 times NaN is NaN: choose with np.where, do not multiply",
            ),
            unaltered(_holes),
        ),
    ),
    exercise(
        "G",
        "max over time of each unit, for both motions; the squared norm of the difference; the "
        "same with min; add",
        G,
        _units,
        {"first": (1, 2, 3), "second": (1, 2, 3), "units": (1, 2, 3)},
        (
            Claim(
                "value",
                "it is equation 4, unit by unit",
                same_as(_equation_4, _units, ("G",)),
                3,
                "time is axis 0; the two motions may have different numbers of frames",
            ),
            Claim("order", "when something happens does not matter", _when_is_no_matter),
            unaltered(_units),
        ),
    ),
    exercise(
        "average_precision",
        "np.argsort(distances) gives the motions nearest first; look up alike in that order, and "
        "np.cumsum counts how many were found so far",
        average_precision,
        _ranked,
        {"motions": (1, 2, 3, 5, 8), "alike": (1, 2, 3)},
        (
            Claim(
                "value",
                "it is the mean of found so far / rank, over the ranks of what is alike",
                same_as(_by_ranks, _ranked, ("the average precision",)),
                3,
                "the first rank is 1",
            ),
            Claim("best", "it is 1 where everything alike comes first", _one_at_best),
            unaltered(_ranked),
        ),
    ),
)
