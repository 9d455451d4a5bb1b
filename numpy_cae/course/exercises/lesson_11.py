"""The exercises of lesson 11, matching distributions: one dimension, slices, the whole loss."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from numpy_cae.course.exercises.exercise import (
    Claim,
    Exercise,
    exercise,
    operation_exercise,
    same_as,
    unaltered,
)
from numpy_cae.course.exercises.lesson_05 import scattered
from numpy_cae.course.exercises.lesson_10 import (
    OF_READING,
    OF_WRITING,
    WHOLE,
    gradients_of_loss,
    loss_back,
)
from numpy_cae.course.exercises.weights_by_name import (
    defined_read,
    defined_write,
    drawn_clips,
    drawn_weights,
    keeps_float32,
    two,
    unaltered_by_name,
)
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.operation import Operation
from numpy_cae.verify.property import require_equal

WEIGHT = 0.7  # large beside the lesson's, so that a lost share shows


def wasserstein_1d(p, q):
    """The squared 2-Wasserstein distance of two sets of numbers, and its pullback."""
    order = np.argsort(p)
    gap = p[order] - np.sort(q)

    def pullback(dloss=1.0):
        dp = np.empty_like(gap)
        dp[order] = (2 * float(dloss) / len(gap)) * gap
        return dp

    return np.mean(gap * gap), pullback


def unit_rows(drawn):
    """Each row divided by its length."""
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


def regularised_loss(weights, x, prior, directions, weight):
    """Reconstruction and λ times the discrepancy, and its derivatives, from the package."""
    model = SequentialAutoencoder.from_weights(weights)
    losses, gradients = model.loss_and_gradients(x, prior, directions, weight)
    return x.dtype.type(losses.total), gradients


def _cheapest(p, q):
    """The mean square of the gaps, in the cheapest of all assignments."""
    return min(np.mean((p - q[list(order)]) ** 2) for order in permutations(range(len(q))))


def _two_sets(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["points"],)
    return {"p": spread(rng, shape), "q": spread(rng, shape, 1.3)}


def _rows(case: Case) -> dict[str, object]:
    return {"drawn": spread(case.rng(), (case["directions"], case["dimensions"]))}


def _to_regularise(case: Case) -> dict[str, object]:
    rng = case.rng()
    points = (case["batch"], case["latent"])
    return {
        "weights": drawn_weights(case, rng),
        "x": drawn_clips(case, rng),
        "prior": scattered(rng, points, 1.0),
        "directions": unit_rows(scattered(rng, (case["directions"], case["latent"]), 1.0)),
        "weight": WEIGHT,
    }


def _total(function, case: Case) -> None:
    arguments = _to_regularise(case)
    loss, _ = two(function(*arguments.values()), "the loss and the gradients by name")
    weights, x, prior, directions, weight = arguments.values()
    z = defined_read(weights, x)
    reconstruction = definitions.mean_squared_error(defined_write(weights, z, x.shape[1]), x)
    discrepancy = definitions.sliced_wasserstein(z, prior, directions)
    require_equal("the loss", loss, reconstruction + weight * discrepancy)


EXERCISES: tuple[Exercise, ...] = (
    operation_exercise(
        Operation(
            "wasserstein_1d",
            {"points": (1, 2, 3, 4, 5)},
            _two_sets,
            ("p",),
            _cheapest,
        ),
        "sort both, subtract. np.argsort says where each sorted number came from, which is where "
        "its gradient goes back to",
        wasserstein_1d,
        hints={
            "value": "the smallest of p goes with the smallest of q: both have to be sorted",
            "gradient for p": "gap[i] belongs to p[order[i]], not to p[i]; and every gap has a "
            "share of 1/N in the mean",
        },
    ),
    exercise(
        "unit_rows",
        "the length of a row is the root of the sum of its squares; keepdims=True leaves it in a "
        "shape that divides the rows",
        unit_rows,
        _rows,
        {"directions": (1, 2, 3), "dimensions": (1, 2, 3)},
        (
            Claim(
                "value",
                "each row is divided by its own length",
                same_as(unit_rows, _rows),
                2,
                "axis=1 adds up along a row",
            ),
            unaltered(_rows),
        ),
    ),
    operation_exercise(
        "sliced_wasserstein",
        "p = z · θ for one direction, the one-dimensional distance, and dz = dp · θ; then the mean "
        "over the directions",
        hints={
            "gradient for z": "a number p[i] = Σ z[i, d] θ[d] moves z[i] along θ; each direction "
            "has a share of 1/L",
        },
    ),
    exercise(
        "regularised_loss",
        "z is used twice: it is decoded, and it is a point among the prior's. Add both gradients "
        "before you go back through the encoder",
        regularised_loss,
        _to_regularise,
        {**WHOLE, "directions": (1, 2)},
        (
            Claim(
                "value",
                "the loss is reconstruction + λ · discrepancy, loop by loop",
                _total,
                2,
            ),
            Claim(
                "gradients of writing",
                "the decoder's gradients are those of central differences of your own loss",
                gradients_of_loss(_to_regularise, OF_WRITING),
                2,
                "the discrepancy knows nothing of the decoder",
            ),
            Claim(
                "gradients of reading",
                "the encoder's gradients are those of central differences of your own loss",
                gradients_of_loss(_to_regularise, OF_READING),
                4,
                "two shares meet at z; the second is that of λ times the discrepancy",
            ),
            keeps_float32(_to_regularise, loss_back),
            unaltered_by_name(_to_regularise),
        ),
        given=("read_clips", "write_clips", "mean_squared_error"),
    ),
)
