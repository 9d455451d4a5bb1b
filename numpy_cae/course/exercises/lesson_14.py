"""The exercises of lesson 14, beyond the papers: the losses with which three projects begin."""

from __future__ import annotations

import numpy as np

from numpy_cae.course.exercises.exercise import (
    Arguments,
    Check,
    Claim,
    Exercise,
    copies,
    exercise,
    require_same,
    unaltered,
)
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.gradients import check_gradients
from numpy_cae.verify.property import require_equal

TREES = {2: (-1, 0), 3: (-1, 0, 1), 4: (-1, 0, 0, 2)}


def bones_off(q, lengths, parents):
    """mean (|b| - l)² over bones and frames, as `manifold.constraints.bone_lengths_off` has it."""
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
    """N Σ |X_{i+1} - X_i|²; `manifold.geodesic.energy` has its mean over the features."""
    steps = np.diff(path, axis=0)

    def pullback(dloss=1.0):
        d = np.zeros_like(path)
        d[1:] += 2 * dloss * len(steps) * steps
        d[:-1] -= 2 * dloss * len(steps) * steps
        return d

    return len(steps) * np.sum(steps**2), pullback


def observed_error(x_hat, x, known):
    """mean (x̂ - x)² over what is known."""
    difference = np.where(known, x_hat - x, 0.0)
    count = known.sum()

    def pullback(dloss=1.0):
        return 2 * dloss / count * difference

    return np.sum(difference**2) / count, pullback


def _body(case: Case) -> dict[str, object]:
    rng = case.rng()
    q = spread(rng, (case["frames"], case["joints"], 3))
    return {
        "q": q,
        "lengths": rng.uniform(0.2, 0.6, case["joints"]),
        "parents": TREES[case["joints"]],
    }


def _path(case: Case) -> dict[str, object]:
    return {"path": spread(case.rng(), (case["points"], case["numbers"]))}


def _observed(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["frames"], case["channels"])
    known = rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
    return {"x_hat": spread(rng, shape), "x": rng.permutation(spread(rng, shape)), "known": known}


def _with_nothing(case: Case) -> dict[str, object]:
    arguments = _observed(case)
    arguments["x"] = np.where(arguments["known"], arguments["x"], np.nan)
    return arguments


def _bones_by_loops(q, lengths, parents):
    gaps = [
        (np.sqrt(sum((frame[joint] - frame[parent]) ** 2)) - lengths[joint]) ** 2
        for frame in q
        for joint, parent in enumerate(parents)
        if parent != -1
    ]
    return sum(gaps) / len(gaps)


def _energy_by_loops(path):
    return (len(path) - 1) * sum(
        (path[i + 1, c] - path[i, c]) ** 2
        for i in range(len(path) - 1)
        for c in range(path.shape[1])
    )


def _known_by_loops(x_hat, x, known):
    squares = [(x_hat[i] - x[i]) ** 2 for i in np.ndindex(known.shape) if known[i]]
    return sum(squares) / len(squares)


def _loss_is(definition, arguments: Arguments) -> Check:
    def check(function, case: Case) -> None:
        loss, _ = _pair(function(*copies(arguments(case))))
        require_same(loss, definition(*copies(arguments(case))), ("the loss",))

    return check


def _gradient_is_right(arguments: Arguments) -> Check:
    """For the first argument."""

    def check(function, case: Case) -> None:
        first, *rest = copies(arguments(case))
        (name, *_) = arguments(case)

        def f(x):
            loss, pullback = _pair(function(x, *rest))
            return np.float64(loss), pullback

        check_gradients(f, first, rng=case.rng(), names=(name,))

    return check


def _upstream_is_one(arguments: Arguments) -> Check:
    def check(function, case: Case) -> None:
        _, pullback = _pair(function(*copies(arguments(case))))
        require_same(pullback(), pullback(1.0), ("the gradient without an argument",))

    return check


def _at_the_lengths(function, case: Case) -> None:
    q, _, parents = _body(case).values()
    q = np.repeat(q[:1], case["frames"], axis=0)
    lengths = np.zeros(len(parents))
    for joint, parent in enumerate(parents):
        if parent != -1:
            lengths[joint] = np.linalg.norm(q[0, joint] - q[0, parent])
    loss, pullback = _pair(function(q, lengths, parents))
    require_same(loss, 0.0, ("the loss",))
    require_equal("the gradient", pullback(), np.zeros_like(q))


def _straight(function, case: Case) -> None:
    path = _path(case)["path"]
    shares = np.linspace(0, 1, case["points"])[:, None]
    line = (1 - shares) * path[0] + shares * path[-1]
    loss, pullback = _pair(function(line))
    require_same(loss, np.sum((path[-1] - path[0]) ** 2), ("the energy of an even straight path",))
    inner = pullback()[1:-1]
    require_equal("its gradient between the ends", inner, np.zeros_like(inner))


def _free(function, case: Case) -> None:
    x_hat, x, known = _with_nothing(case).values()
    loss, pullback = _pair(function(x_hat, x, known))
    require_same(loss, _known_by_loops(x_hat, x, known), ("the loss",))
    require_same(pullback()[~known], np.zeros(np.sum(~known)), ("the gradient of the unknown",))


def _pair(returned):
    if not (isinstance(returned, tuple | list) and len(returned) == 2 and callable(returned[1])):
        raise AssertionError("it does not return two things: the loss and its pullback")
    return returned


def _loss_claims(definition, arguments: Arguments, where: str) -> tuple[Claim, ...]:
    """What every loss is held to."""
    return (
        Claim("value", "the loss is that of the definition, loop by loop",
              _loss_is(definition, arguments), 2),
        Claim(f"gradient for {where}", f"the pullback's gradient for {where} is that of central "
              "differences", _gradient_is_right(arguments), 4),
        Claim("upstream default", "with no upstream gradient given it is 1",
              _upstream_is_one(arguments)),
    )  # fmt: skip


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "bones_off",
        "first all bones b = q[:, ends] - q[:, starts], then their lengths; a bone pulls at both "
        "of its ends, in opposite directions, and a joint may stand at the end of one bone and the "
        "start of others",
        bones_off,
        _body,
        {"frames": (1, 2), "joints": (2, 3, 4)},
        (
            *_loss_claims(_bones_by_loops, _body, "q"),
            Claim("at rest", "where every bone has its length, loss and gradient are 0",
                  _at_the_lengths),
            unaltered(_body),
        ),
    ),
    exercise(
        "path_energy",
        "np.diff gives the steps; each point but the ends stands in two of them, once with a plus "
        "and once with a minus",
        path_energy,
        _path,
        {"points": (2, 3, 4, 5), "numbers": (1, 2, 3)},
        (
            *_loss_claims(_energy_by_loops, _path, "path"),
            Claim("straight", "of an even straight path it is the squared distance of its ends, "
                  "and nothing pulls at the points between", _straight, 2),
            unaltered(_path),
        ),
    ),
    exercise(
        "observed_error",
        "the mean is over what is known alone: divide by how many those are",
        observed_error,
        _observed,
        {"frames": (1, 2, 3), "channels": (1, 2, 3)},
        (
            *_loss_claims(_known_by_loops, _observed, "x_hat"),
            Claim("unknown", "what is unknown, NaN even, adds nothing and is pulled at by nothing",
                  _free, 2, "0 times NaN is NaN: choose with np.where, do not multiply"),
            unaltered(_observed),
        ),
    ),
)  # fmt: skip
