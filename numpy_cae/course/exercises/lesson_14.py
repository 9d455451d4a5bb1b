"""The exercises of lesson 14, beyond the papers: the losses with which three projects begin."""

import numpy as np

from numpy_cae.course.exercises.checks import (
    PULLBACK,
    Differentiated,
    copies,
    drawn,
    require_parts,
    require_same,
    states,
)
from numpy_cae.course.exercises.exercise import Exercise, differentiated_exercise
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import Property, require_equal

TREES = {2: (-1, 0), 3: (-1, 0, 1), 4: (-1, 0, 0, 2)}
RETURNS = ("the loss", PULLBACK)


def bones_off(q, lengths, parents):
    """mean (|b| - l)² over bones and frames, as in `numpy_cae.beyond.constraints`."""
    ends = [joint for joint, parent in enumerate(parents) if parent != -1]
    starts = [parents[joint] for joint in ends]
    bones = q[:, ends] - q[:, starts]
    measured = np.linalg.norm(bones, axis=-1, keepdims=True)
    gap = measured - lengths[ends][:, None]

    def pullback(dloss=1.0):
        d_bones = dloss * 2 * gap / gap.size * bones / measured
        dq = np.zeros_like(q)
        for n, (end, start) in enumerate(zip(ends, starts, strict=True)):
            dq[:, end] += d_bones[:, n]
            dq[:, start] -= d_bones[:, n]
        return dq

    return np.mean(gap**2), pullback


def path_energy(path):
    """N Σ |X_{i+1} - X_i|²"""
    steps = np.diff(path, axis=0)

    def pullback(dloss=1.0):
        d = np.zeros_like(path)
        d[1:] += 2 * dloss * len(steps) * steps
        d[:-1] -= 2 * dloss * len(steps) * steps
        return d

    return len(steps) * np.sum(steps**2), pullback


def observed_error(x_hat, x, known):
    """mean (x̂ - x)² over the known values."""
    difference = np.where(known, x_hat - x, 0.0)
    count = known.sum()

    def pullback(dloss=1.0):
        return 2 * dloss / count * difference

    return np.sum(difference**2) / count, pullback


def _bones_by_loops(q, lengths, parents):
    gaps = [
        (np.sqrt(sum((frame[joint] - frame[parent]) ** 2)) - lengths[joint]) ** 2
        for frame in q
        for joint, parent in enumerate(parents)
        if parent != -1
    ]
    return sum(gaps) / len(gaps)


def _energy_by_loops(path):
    squares = [
        (path[i + 1, c] - path[i, c]) ** 2 for i, c in np.ndindex(np.diff(path, axis=0).shape)
    ]
    return (len(path) - 1) * sum(squares)


def _observed_by_loops(x_hat, x, known):
    squares = [(x_hat[i] - x[i]) ** 2 for i in np.ndindex(known.shape) if known[i]]
    return sum(squares) / len(squares)


def _bone_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    q = spread(rng, (case["frames"], case["joints"], 3))
    lengths = rng.uniform(0.2, 0.6, case["joints"])
    return {"q": q, "lengths": lengths, "parents": TREES[case["joints"]]}


_path_arguments = drawn(path="points numbers")


def _observed_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["frames"], case["channels"])
    known = rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
    return {"x_hat": spread(rng, shape), "x": rng.permutation(spread(rng, shape)), "known": known}


BONES = Differentiated(_bone_arguments, _bones_by_loops, ("q",), RETURNS)
ENERGY = Differentiated(_path_arguments, _energy_by_loops, ("path",), RETURNS)
OBSERVED = Differentiated(_observed_arguments, _observed_by_loops, ("x_hat",), RETURNS)


@states("at rest", "if every bone has its length, loss and gradient are 0")
def _right_lengths(function, case: Case) -> None:
    q, lengths, parents = _bone_arguments(case).values()
    q = np.repeat(q[:1], case["frames"], axis=0)
    for joint, parent in enumerate(parents):
        if parent != -1:
            lengths[joint] = np.linalg.norm(q[0, joint] - q[0, parent])
    loss, pullback = require_parts(function(q, lengths, parents), RETURNS)
    require_same(loss, 0.0, ("the loss",))
    require_equal("the gradient", pullback(), np.zeros_like(q))


@states(
    "straight", "for a straight path with equal steps it is the squared distance of the ends", 2
)
def _straight_path(function, case: Case) -> None:
    path = _path_arguments(case)["path"]
    shares = np.linspace(0, 1, case["points"])[:, None]
    line = (1 - shares) * path[0] + shares * path[-1]
    loss, pullback = require_parts(function(line), RETURNS)
    expected = np.sum((path[-1] - path[0]) ** 2)
    require_same(loss, expected, ("the energy of a straight path with equal steps",))
    inner = pullback()[1:-1]
    require_equal("its gradient between the ends", inner, np.zeros_like(inner))


@states("unknown", "an unknown value, NaN included, adds no loss and gets no gradient", 2)
def _unknown_values(function, case: Case) -> None:
    x_hat, x, known = _observed_arguments(case).values()
    x = np.where(known, x, np.nan)
    loss, pullback = require_parts(function(x_hat, x, known), RETURNS)
    require_same(loss, _observed_by_loops(x_hat, x, known), ("the loss",))
    zeros = np.zeros(np.sum(~known))
    require_same(pullback()[~known], zeros, ("the gradient of an unknown value",))


def _loss_exercise(solution, loss: Differentiated, sizes, *properties: Property) -> Exercise:
    """An exercise about a loss and its pullback, whose upstream gradient is 1 by default."""

    @states("upstream default", "the upstream gradient is 1 by default")
    def upstream_is_one(function, case: Case) -> None:
        _, pullback = require_parts(function(*copies(loss.arguments(case))), RETURNS)
        require_same(pullback(), pullback(1.0), ("the gradient without an argument",))

    return differentiated_exercise(
        solution,
        loss,
        sizes,
        upstream_is_one,
        *properties,
        value="the loss is that of the definition, computed by loops",
        gradients={f"gradient for {loss.inputs[0]}": (4,)},
        given="unit_rows zero_values",
    )


EXERCISES = (
    _loss_exercise(bones_off, BONES, {"frames": (1, 2), "joints": (2, 3, 4)}, _right_lengths),
    _loss_exercise(
        path_energy, ENERGY, {"points": (2, 3, 4, 5), "numbers": (1, 2, 3)}, _straight_path
    ),
    _loss_exercise(
        observed_error, OBSERVED, {"frames": (1, 2, 3), "channels": (1, 2, 3)}, _unknown_values
    ),
)
