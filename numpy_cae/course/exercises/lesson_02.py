"""The checks and arguments of lesson 02, what to learn from: the features and the way back."""

import numpy as np

from numpy_cae.course.exercises.checks import checks
from numpy_cae.course.solutions.lesson_02 import from_features, to_features
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal


def headings(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Angles that grow by up to 1.9 radians per frame, past whole turns."""
    rng = case.rng()
    return spread(rng, (1,), 3.0) + np.cumsum(spread(rng, (case["frames"],), 1.0) + 0.9)


def lines_across(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Lines across a body with these headings."""
    theta = headings(case, rng, made)
    rng = np.random.default_rng([case.seed, 4])
    width = rng.uniform(0.3, 0.8, len(theta))
    tilt = rng.uniform(-0.2, 0.2, len(theta))
    return np.stack([width * np.cos(theta), tilt, -width * np.sin(theta)], axis=-1)


def feature_arguments(case: Case) -> dict[str, object]:
    """The features of random positions, and where and facing which way they begin."""
    positions = spread(case.rng(), (case["frames"], 20, 3))
    features = to_features(positions, headings(case, case.rng(), {}))
    rng = np.random.default_rng([case.seed, 5])
    x, z, heading = (float(number) for number in rng.uniform(-2, 2, 3).round(2))
    return {"features": features, "x": x, "z": z, "heading": heading}


@checks("heading_angle", "faces")
def _known_directions(function, case, across):
    lines = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
    for line, expected in zip(lines, (0.0, np.pi / 2, np.pi), strict=True):
        angle = np.asarray(function(line[None]))
        if angle.shape != (1,):
            raise AssertionError(f"for one frame it has shape {angle.shape}, expected (1,)")
        error = (angle[0] - expected + np.pi) % (2 * np.pi) - np.pi
        require_equal(f"for across {line.tolist()}, the angle's error", error, 0.0)


@checks("heading_angle", "turns")
def _changes_of_heading(function, case, across):
    changes = np.diff(np.asarray(function(across)))
    expected = np.diff(headings(case, case.rng(), {}))
    require_equal("the change from frame to frame", changes, expected)


@checks("from_features", "first frame")
def _first_frame(function, case, **given):
    positions = np.asarray(function(*given.values()))
    require_equal("a position in the first frame", positions[0], from_features(**given)[0])
