"""The exercises of lesson 02, what to learn from: the 63 features and the way back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.course.exercises.exercise import (
    Claim,
    Exercise,
    copies,
    exercise,
    require_same,
    same_as,
    unaltered,
)
from numpy_cae.motion import JOINTS, RootTransform, features_to_positions
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.property import require_equal

FRAMES = {"frames": (2, 3, 5, 8)}


def heading_angle(across: np.ndarray) -> np.ndarray:
    forward = np.cross(across, [0.0, 1.0, 0.0])
    return np.unwrap(np.arctan2(forward[:, 0], forward[:, 2]))


def _spinning(case: Case) -> np.ndarray:
    """Angles that grow by up to a third of a turn a frame and pass whole turns."""
    rng = case.rng()
    return spread(rng, (1,), 3.0) + np.cumsum(spread(rng, (case["frames"],), 1.0) + 0.9)


def _across(case: Case) -> dict[str, object]:
    theta = _spinning(case)
    rng = np.random.default_rng([case.seed, 4])
    width, tilt = rng.uniform(0.3, 0.8, len(theta)), rng.uniform(-0.2, 0.2, len(theta))
    return {"across": np.stack([width * np.cos(theta), tilt, -width * np.sin(theta)], axis=-1)}


def _faces(function: Callable, case: Case) -> None:
    across = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
    for line, expected in zip(across, (0.0, np.pi / 2, np.pi), strict=True):
        angle = np.asarray(function(line[None].copy()))
        if angle.shape != (1,):
            raise AssertionError(f"of one frame it has shape {angle.shape}, expected (1,)")
        off = (angle[0] - expected + np.pi) % (2 * np.pi) - np.pi
        require_equal(f"across {line.tolist()}, the angle's error", off, 0.0)


def _turns_add_up(function: Callable, case: Case) -> None:
    found = np.asarray(function(*copies(_across(case))))
    require_equal("the turn from frame to frame", np.diff(found), np.diff(_spinning(case)))


def turn_about_y(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    about_y = Rotation.from_rotvec(angles[:, None] * [0.0, 1.0, 0.0]).as_matrix()
    return np.einsum("fij,fnj->fni", about_y, vectors)


def _vectors(case: Case) -> dict[str, object]:
    rng = case.rng()
    vectors = spread(rng, (case["frames"], case["vectors"], 3))
    return {"vectors": vectors, "angles": spread(rng, (case["frames"],), 3.0)}


def _undone(function: Callable, case: Case) -> None:
    vectors, angles = _vectors(case).values()
    back = function(np.array(function(vectors.copy(), angles.copy())), -angles)
    require_equal("turned and turned back", back, vectors)


def to_features(positions: np.ndarray, theta: np.ndarray) -> np.ndarray:
    floor = positions[:, 0] * [1.0, 0.0, 1.0]
    local = turn_about_y(positions - floor[:, None], -theta)
    step = turn_about_y(np.diff(floor, axis=0)[:, None], -theta[:-1])[:, 0]
    changes = np.column_stack([step[:, 0], step[:, 2], np.diff(theta)])
    changes = np.concatenate([changes, changes[-1:]])
    return np.concatenate([local.reshape(len(positions), -1), changes], axis=1)


def _walking(case: Case) -> dict[str, object]:
    positions = spread(case.rng(), (case["frames"], len(JOINTS), 3))
    return {"positions": positions, "theta": _spinning(case)}


def _columns(columns: slice, what: str) -> Callable:
    def check(function: Callable, case: Case) -> None:
        given = _walking(case)
        found = np.asarray(function(*copies(given)))
        expected = to_features(**given)
        if found.shape != expected.shape:
            raise AssertionError(f"the features have shape {found.shape}, not {expected.shape}")
        require_equal(what, found[:, columns], expected[:, columns])

    return check


def _elsewhere(function: Callable, case: Case) -> None:
    positions, theta = _walking(case).values()
    turn = 0.5 + case.seed % 5
    turned = turn_about_y(positions, np.full(len(theta), turn)) + [3.0, 0.0, -2.0]
    require_equal(
        "elsewhere and facing another way, a feature",
        function(turned, theta + turn),
        function(positions.copy(), theta.copy()),
    )


def from_features(features: np.ndarray, x: float, z: float, heading: float) -> np.ndarray:
    return features_to_positions(features, RootTransform(x, z, heading))


def _features(case: Case) -> dict[str, object]:
    features = to_features(**_walking(case))
    rng = np.random.default_rng([case.seed, 5])
    x, z, heading = (float(number) for number in rng.uniform(-2, 2, 3).round(2))
    return {"features": features, "x": x, "z": z, "heading": heading}


def _round_trip(function: Callable, case: Case) -> None:
    positions, theta = _walking(case).values()
    start = (float(positions[0, 0, 0]), float(positions[0, 0, 2]), float(theta[0]))
    back = function(to_features(positions, theta), *start)
    require_same(back, positions, ("there and back, a position",))


def _first_frame(function: Callable, case: Case) -> None:
    given = _features(case)
    found = np.asarray(function(*copies(given)))
    require_equal("a position in the first frame", found[0], from_features(**given)[0])


def _last_velocity(function: Callable, case: Case) -> None:
    given = _features(case)
    other = given | {"features": given["features"].copy()}
    other["features"][-1, 60:] += 1.0
    require_equal(
        "with another last velocity, a position",
        function(*copies(other)),
        function(*copies(given)),
    )


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "heading_angle",
        "forward is square to both Y and across: a cross product. Of its x and z, arctan2 makes an "
        "angle; np.unwrap takes the jumps of a whole turn out",
        heading_angle,
        _across,
        FRAMES,
        (
            Claim(
                "faces",
                "facing +Z is 0, facing +X a quarter turn (whole turns aside)",
                _faces,
                2,
                "with the left side at +X and up at +Y, is your forward +Z or -Z?",
            ),
            Claim(
                "turns",
                "angles change by what the body turns, past whole turns too",
                _turns_add_up,
                1,
                "arctan2 jumps by 2π where the body faces -Z",
            ),
            unaltered(_across),
        ),
    ),
    exercise(
        "turn_about_y",
        "y stays; x and z mix by the angle's sine and cosine, and a small positive angle takes +Z "
        "towards +X. angles[:, None] lets a frame's angle reach all its vectors",
        turn_about_y,
        _vectors,
        {"frames": (1, 2, 3), "vectors": (1, 2, 3)},
        (
            Claim(
                "value",
                "each frame's vectors are turned about Y by that frame's angle",
                same_as(turn_about_y, _vectors, ("the turned vector",)),
                3,
            ),
            Claim("undone", "turning by -angle undoes it", _undone),
            unaltered(_vectors),
        ),
    ),
    exercise(
        "to_features",
        "take the hips' place on the floor from every joint, turn by -θ; the velocity is the step "
        "of the hips to the next frame, turned by the same -θ",
        to_features,
        _walking,
        FRAMES,
        (
            Claim(
                "positions",
                "the first 60 are R(-θ) (p - h), joint by joint",
                _columns(slice(0, 60), "a position"),
                2,
                "only x and z of the hips are taken away: a jump must stay a jump",
            ),
            Claim(
                "velocity",
                "the next two are x and z of R(-θ_t) (h_{t+1} - h_t)",
                _columns(slice(60, 62), "the velocity"),
                2,
                "a step has one frame less than the motion; the last repeats the one before",
            ),
            Claim("turn", "the last is θ_{t+1} - θ_t", _columns(slice(62, 63), "the turn")),
            Claim(
                "elsewhere",
                "the same motion elsewhere, facing another way, has the same features",
                _elsewhere,
                2,
            ),
            unaltered(_walking),
        ),
    ),
    exercise(
        "from_features",
        "first the headings, by a running sum of the turns; with them each step can be turned into "
        "the world; then the places, by a running sum of the steps",
        from_features,
        _features,
        FRAMES,
        (
            Claim("first frame", "the first pose stands at (x, z) and faces heading", _first_frame),
            Claim(
                "value",
                "h_{t+1} = h_t + R(θ_t) v_t, θ_{t+1} = θ_t + ω_t, p_t = h_t + R(θ_t) q_t",
                same_as(from_features, _features, ("a position",)),
                3,
                "frame 0 has summed nothing yet, frame 1 one step",
            ),
            Claim(
                "round trip",
                "there and back gives the positions again",
                _round_trip,
                2,
            ),
            Claim("last velocity", "the last frame's velocity leads nowhere", _last_velocity),
            unaltered(_features),
        ),
    ),
)
