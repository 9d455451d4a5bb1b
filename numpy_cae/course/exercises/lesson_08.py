"""The exercises of lesson 08, using the manifold: blind repair, filling in, comparing, and the
linear map that they are compared with."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from numpy_cae.course.exercises.checks import copies, drawn, require_same, same_as, states
from numpy_cae.course.exercises.exercise import exercise
from numpy_cae.evaluation import retrieval
from numpy_cae.manifold.compare import G
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import Property

WINDOWS = {"batch": (1, 2), "frames": (2, 3, 4, 6), "channels": (1, 2, 3)}


@dataclass(frozen=True)
class Blur:
    """A projection that differs from the identity: a mean of each frame and the one before it."""

    share: float

    def __call__(self, x: np.ndarray) -> np.ndarray:
        return self.share * x + (1 - self.share) * np.roll(x, 1, axis=1) + 0.1

    def __repr__(self) -> str:
        return f"lambda x: {self.share} * x + {1 - self.share} * np.roll(x, 1, axis=1) + 0.1"


def rescale(x):
    """X_c / (1 - p̂), p̂ being the share of zeros in each window."""
    return x / (1 - zeroed_fraction(x))


def denoising_weights(second, cross, kept):
    """M⁻¹ B of `numpy_cae.evaluation.Moments`, one probability for every value."""
    m = kept**2 * second
    np.fill_diagonal(m, kept * np.diag(second))
    return np.linalg.solve(m, kept * cross)


def fill_unknown(x, known, project):
    """The projection of the known values, where they are unknown."""
    return np.where(known, x, project(np.where(known, x, 0.0)))


def average_precision(distances, alike):
    """For one query: the mean precision at the rank of each motion that is alike."""
    return float(retrieval.average_precision(distances[None], alike[None])[0])


def _rescale_by_loops(x):
    result = np.empty(x.shape)
    for n, window in enumerate(x):
        zeros = entries = 0
        for feature in window.T:
            if any(value != 0 for value in feature):
                zeros += sum(value == 0 for value in feature)
                entries += len(feature)
        result[n] = window / (1 - zeros / entries)
    return result


def _equation_4_by_loops(y_0, y_1):
    total = 0.0
    for one, other in zip(y_0.T, y_1.T, strict=True):
        total += (max(one) - max(other)) ** 2 + (min(one) - min(other)) ** 2
    return total


def _precision_by_loops(distances, alike):
    found, precisions = 0, []
    for rank, motion in enumerate(sorted(range(len(distances)), key=lambda n: distances[n]), 1):
        if alike[motion]:
            found += 1
            precisions.append(found / rank)
    return sum(precisions) / len(precisions)


def _damaged_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    x = spread(rng, shape)
    for window in range(shape[0]):
        for channel in range(shape[2]):
            lost = rng.permutation(shape[1])[: rng.integers(1, shape[1])]
            x[window, lost, channel] = 0.0
    x = np.concatenate([x, np.zeros((*shape[:2], case["still"]))], axis=2)
    return {"x": x}


def _random_samples(case: Case) -> tuple[np.ndarray, np.ndarray]:
    rng = case.rng()
    inputs = case["inputs"]
    z = rng.standard_normal((2 * inputs + 2, inputs))
    mixed = z @ rng.standard_normal((inputs, inputs))
    return mixed, mixed @ rng.standard_normal((inputs, case["outputs"])) + z[:, :1]


def _moment_arguments(case: Case) -> dict[str, object]:
    z, x = _random_samples(case)
    return {"second": z.T @ z / len(z), "cross": z.T @ x / len(z), "kept": case["tenths"] / 10}


def _hole_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    known = rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
    return {"x": spread(rng, shape), "known": known, "project": Blur(0.75)}


def _nan_hole_arguments(case: Case) -> dict[str, object]:
    arguments = _hole_arguments(case)
    arguments["x"][~arguments["known"]] = np.nan
    return arguments


def _unit_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    both = spread(rng, (case["first"] + case["second"], case["units"]), 0.9)
    return {"y_0": both[: case["first"]], "y_1": both[case["first"] :]}


def _ranking_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    alike = np.arange(case["motions"]) < min(case["alike"], case["motions"])
    distances = spread(rng, (case["motions"],)) + 3.0
    return {"distances": distances, "alike": rng.permutation(alike)}


def _least_squares_over_masks(denoising_weights, case: Case) -> None:
    """Every mask, weighted by its probability, in one least-squares problem."""
    z, x = _random_samples(case)
    kept = case["tenths"] / 10
    rows, targets = [], []
    for mask in product((0.0, 1.0), repeat=z.shape[1]):
        mask = np.array(mask)
        weight = np.sqrt(np.prod(np.where(mask == 1, kept, 1 - kept)))
        rows.append(weight * mask * z)
        targets.append(weight * x)
    expected = np.linalg.lstsq(np.concatenate(rows), np.concatenate(targets), rcond=None)[0]
    found = denoising_weights(*copies(_moment_arguments(case)))
    require_same(found, expected, ("the weights",))


@states("known", "known values stay exactly as they are", 1)
def _known_values_stay(fill_unknown, case: Case) -> None:
    x, known, project = _hole_arguments(case).values()
    found = fill_unknown(x.copy(), known.copy(), project)[known]
    require_same(found, x[known], ("a known value",))


@states("order", "the order of the frames does not matter")
def _order_of_time(function, case: Case) -> None:
    y_0, y_1 = _unit_arguments(case).values()
    order = case.rng().permutation(len(y_0))
    before, found = (function(y.copy(), y_1.copy()) for y in (y_0, y_0[order]))
    require_same(found, before, ("G of the same units in another order",))


@states("best", "it is 1 if all motions that are alike come first")
def _perfect_ranking(function, case: Case) -> None:
    distances, alike = _ranking_arguments(case).values()
    first = np.where(alike, distances, distances + 10.0)
    found = function(first, alike.copy())
    require_same(found, 1.0, ("if all motions that are alike come first, it",))


EXERCISES = (
    exercise(
        rescale,
        _damaged_arguments,
        {**WINDOWS, "still": (0,)},
        Property(
            "still features",
            "a feature that is zero in every frame does not count",
            same_as(_rescale_by_loops, _damaged_arguments),
            2,
            {"still": (1, 2)},
        ),
        Property(
            "nothing lost",
            "a window without zeros is not changed",
            same_as(lambda x: x, drawn(x="batch frames channels")),
        ),
        value="each window is divided by its share of values that are not zero",
        definition=_rescale_by_loops,
        points=3,
    ),
    exercise(
        denoising_weights,
        _moment_arguments,
        {"inputs": (1, 2, 3, 4), "outputs": (1, 2), "tenths": (5, 3, 8)},
        Property(
            "value",
            "they solve M A = B, the means over all masks, weighted by probability",
            _least_squares_over_masks,
            4,
        ),
        Property(
            "nothing lost",
            "with kept = 1 they are ordinary least squares",
            _least_squares_over_masks,
            2,
            {"tenths": (10,)},
        ),
    ),
    exercise(
        fill_unknown,
        _hole_arguments,
        WINDOWS,
        _known_values_stay,
        Property(
            "nothing there",
            "the values of x where it is unknown do not matter, NaN included",
            same_as(fill_unknown, _nan_hole_arguments),
            2,
        ),
        value="an unknown value is that of the projection of the window with zeros there",
        points=3,
        given="zero_values",
    ),
    exercise(
        G,
        _unit_arguments,
        {"first": (1, 2, 3), "second": (1, 2, 3), "units": (1, 2, 3)},
        _order_of_time,
        value="it is equation 4, unit by unit",
        definition=_equation_4_by_loops,
        points=3,
    ),
    exercise(
        average_precision,
        _ranking_arguments,
        {"motions": (1, 2, 3, 5, 8), "alike": (1, 2, 3)},
        _perfect_ranking,
        value="it is the mean of found so far / rank, over the ranks of the motions alike",
        definition=_precision_by_loops,
        points=3,
    ),
)
