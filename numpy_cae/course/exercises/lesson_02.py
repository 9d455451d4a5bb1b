"""The exercises of lesson 02, what to learn from: the 63 features and the conversion back."""

from collections.abc import Callable

import numpy as np

from numpy_cae.course.exercises.checks import array, drawn, states
from numpy_cae.course.exercises.exercise import exercise
from numpy_cae.course.solutions.lesson_02 import (
    from_features,
    heading_angle,
    to_features,
    turn_about_y,
)
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal

FRAMES = {"frames": (2, 3, 5, 8)}


def _random_headings(case: Case, rng: np.random.Generator | None = None) -> np.ndarray:
    """Angles that grow by up to 1.9 radians per frame, past whole turns."""
    rng = case.rng()
    return spread(rng, (1,), 3.0) + np.cumsum(spread(rng, (case["frames"],), 1.0) + 0.9)


def _random_lines(case: Case, rng: np.random.Generator) -> np.ndarray:
    """Lines across a body with these headings."""
    theta = _random_headings(case)
    rng = np.random.default_rng([case.seed, 4])
    width = rng.uniform(0.3, 0.8, len(theta))
    tilt = rng.uniform(-0.2, 0.2, len(theta))
    return np.stack([width * np.cos(theta), tilt, -width * np.sin(theta)], axis=-1)


_across_arguments = drawn(across=_random_lines)
_position_arguments = drawn(positions="frames 20 3", theta=_random_headings)


def _feature_arguments(case: Case) -> dict[str, object]:
    features = to_features(**_position_arguments(case))
    rng = np.random.default_rng([case.seed, 5])
    x, z, heading = (float(number) for number in rng.uniform(-2, 2, 3).round(2))
    return {"features": features, "x": x, "z": z, "heading": heading}


@states("faces", "facing +Z is 0, facing +X is a quarter turn (up to whole turns)")
def _known_directions(function, case, across):
    lines = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
    for line, expected in zip(lines, (0.0, np.pi / 2, np.pi), strict=True):
        angle = np.asarray(function(line[None]))
        if angle.shape != (1,):
            raise AssertionError(f"for one frame it has shape {angle.shape}, expected (1,)")
        error = (angle[0] - expected + np.pi) % (2 * np.pi) - np.pi
        require_equal(f"for across {line.tolist()}, the angle's error", error, 0.0)


@states("turns", "the angle changes by the body's rotation, past whole turns too")
def _changes_of_heading(function, case, across):
    changes = np.diff(np.asarray(function(across)))
    require_equal("the change from frame to frame", changes, np.diff(_random_headings(case)))


def _columns(columns: slice, what: str) -> Callable[..., None]:
    def check(function, case, positions, theta):
        features = np.asarray(function(positions, theta))
        expected = to_features(positions, theta)
        if features.shape != expected.shape:
            raise AssertionError(f"the features have shape {features.shape}, not {expected.shape}")
        require_equal(what, features[:, columns], expected[:, columns])

    return check


@states(
    "elsewhere",
    "the same motion, moved and facing another direction, has the same features",
    is_form=True,
)
def _elsewhere(function, case, positions, theta):
    angle = 0.5 + case.seed % 5
    moved = turn_about_y(positions, np.full(len(theta), angle)) + [3.0, 0.0, -2.0]
    expected = function(positions, theta)
    what = "of the moved and rotated motion, a feature"
    require_equal(what, function(moved, theta + angle), expected)


@states("first frame", "the first pose is at (x, z) and faces heading")
def _first_frame(function, case, **given):
    positions = np.asarray(function(*given.values()))
    require_equal("a position in the first frame", positions[0], from_features(**given)[0])


_POSITIONS = "the first 60 are R(-θ) (p - h), joint by joint"
_VELOCITY = "the next two are x and z of R(-θ_t) (h_{t+1} - h_t)"

EXERCISES = (
    exercise(heading_angle, _across_arguments, FRAMES, _known_directions, _changes_of_heading),
    exercise(
        turn_about_y,
        drawn(vectors="frames vectors 3", angles=array("frames", 3.0)),
        {"frames": (1, 2, 3), "vectors": (1, 2, 3)},
        value="the vectors of each frame are rotated about Y by the angle of that frame",
    ),
    exercise(
        to_features,
        _position_arguments,
        FRAMES,
        states("positions", _POSITIONS)(_columns(slice(0, 60), "a position")),
        states("velocity", _VELOCITY)(_columns(slice(60, 62), "the velocity")),
        states("turn", "the last is θ_{t+1} - θ_t")(_columns(slice(62, 63), "the change")),
        _elsewhere,
    ),
    exercise(
        from_features,
        _feature_arguments,
        FRAMES,
        _first_frame,
        value="h_{t+1} = h_t + R(θ_t) v_t, θ_{t+1} = θ_t + ω_t, p_t = h_t + R(θ_t) q_t",
    ),
)
