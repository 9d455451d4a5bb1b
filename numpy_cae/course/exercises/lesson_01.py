"""The checks and arguments of lesson 01, a motion is an array."""

import numpy as np

from numpy_cae.course.exercises.checks import checks, require_same
from numpy_cae.course.solutions.lesson_01 import chain_to_root
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal

QUARTER = "by quarters"


def random_tree(case: Case, rng: np.random.Generator, made: dict) -> tuple[int, ...]:
    """The parents of a random tree in which every parent precedes its children."""
    rng = np.random.default_rng([case.seed, 2])
    return (-1, *(int(rng.integers(0, joint)) for joint in range(1, case["joints"])))


def some_joint(case: Case, rng: np.random.Generator, made: dict) -> int:
    """A joint."""
    return case.seed % case["joints"]


def some_axes(case: Case, rng: np.random.Generator, made: dict) -> tuple[int, ...]:
    """Different axes of rotation in any order."""
    return tuple(int(axis) for axis in rng.permutation(3)[: case["channels"]])


def some_angles(case: Case, rng: np.random.Generator, made: dict) -> tuple[float, ...]:
    """An angle in degrees for each channel."""
    return tuple(float(angle) for angle in 90 * spread(rng, (case["channels"],)))


def rotations(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """A rotation of each joint in each frame, by quarter turns about the axes or by any angle."""
    from scipy.spatial.transform import Rotation

    counts = (case["frames"], case["joints"])
    count = int(np.prod(counts))
    if case["turns"] == QUARTER:
        every = Rotation.create_group("O").as_matrix().round() + 0.0
        return every[rng.integers(len(every), size=count)].reshape(*counts, 3, 3)
    return Rotation.from_rotvec(spread(rng, (count, 3))).as_matrix().reshape(*counts, 3, 3)


def translations(case: Case, rng: np.random.Generator, made: dict) -> np.ndarray:
    """Translations, whole numbers beside quarter turns, so that paper is enough to check them."""
    shape = (case["frames"], case["joints"], 3)
    whole = rng.choice([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0], shape)
    return whole if case["turns"] == QUARTER else spread(rng, shape)


@checks("chain_to_root", "chain")
def _chain_as_array(function, case, parents, joint):
    chain = np.asarray(chain_to_root(parents, joint))
    require_same(function(parents, joint), chain, ("the chain",))


@checks("forward_kinematics", "rest pose")
def _rest_pose(function, case, parents, rotations, translations):
    positions = function(parents, np.broadcast_to(np.eye(3), rotations.shape), translations)
    for joint in range(case["joints"]):
        expected = translations[:, list(chain_to_root(parents, joint))].sum(axis=1)
        what = f"without rotations, the position of joint {joint}"
        require_equal(what, positions[:, joint], expected)
