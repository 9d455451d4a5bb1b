"""The exercises of lesson 01, a motion is an array."""

import numpy as np

from numpy_cae.course.exercises.checks import drawn, require_same, same_as, states
from numpy_cae.course.exercises.exercise import exercise
from numpy_cae.course.solutions.lesson_01 import (
    chain_to_root,
    forward_kinematics,
    rotation_from_channels,
    speeds,
)
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal

TREE_SIZES = {"joints": (1, 2, 3, 4, 6, 8)}
QUARTER = "by quarters"
MOTION_SIZES = {"frames": (1, 2, 3), **TREE_SIZES, "turns": (QUARTER, "by any angle")}


def random_tree(case: Case, rng: np.random.Generator) -> tuple[int, ...]:
    """The parents of a random tree in which every parent precedes its children."""
    rng = np.random.default_rng([case.seed, 2])
    return (-1, *(int(rng.integers(0, joint)) for joint in range(1, case["joints"])))


def random_rotations(case: Case, rng: np.random.Generator, *counts: int) -> np.ndarray:
    """Rotation matrices, (*counts, 3, 3), by quarter turns about the axes or by any angle."""
    from scipy.spatial.transform import Rotation

    count = int(np.prod(counts))
    if case["turns"] == QUARTER:
        every = Rotation.create_group("O").as_matrix().round() + 0.0
        return every[rng.integers(len(every), size=count)].reshape(*counts, 3, 3)
    return Rotation.from_rotvec(spread(rng, (count, 3))).as_matrix().reshape(*counts, 3, 3)


def random_offsets(case: Case, rng: np.random.Generator) -> np.ndarray:
    """Translations, whole numbers beside quarter turns, so that paper is enough to check them."""
    shape = (case["frames"], case["joints"], 3)
    whole = rng.choice([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0], shape)
    return whole if case["turns"] == QUARTER else spread(rng, shape)


_speed_arguments = drawn(
    positions="frames joints 3", rate=lambda case, rng: (30.0, 120.0)[case.seed % 2]
)
_tree_arguments = drawn(parents=random_tree, joint=lambda case, rng: case.seed % case["joints"])
_channel_arguments = drawn(
    axes=lambda case, rng: tuple(int(axis) for axis in rng.permutation(3)[: case["channels"]]),
    angles=lambda case, rng: tuple(float(a) for a in 90 * spread(rng, (case["channels"],))),
)
_motion_arguments = drawn(
    parents=random_tree,
    rotations=lambda case, rng: random_rotations(case, rng, case["frames"], case["joints"]),
    translations=random_offsets,
)


@states("chain", "the joint, its parent, and so on, the root last")
def _chain_as_array(function, case, parents, joint):
    chain = np.asarray(chain_to_root(parents, joint))
    require_same(function(parents, joint), chain, ("the chain",))


@states("rotation", "the matrix keeps lengths and does not mirror", is_form=True)
def _is_rotation(function, case, axes, angles):
    matrix = np.asarray(function(axes, angles))
    require_equal("the matrix times its transpose", matrix @ matrix.T, np.eye(3))
    require_equal("its determinant", np.linalg.det(matrix), 1.0)


@states("rest pose", "without rotations a joint is at the sum of the translations on its chain")
def _rest_pose(function, case, parents, rotations, translations):
    positions = function(parents, np.broadcast_to(np.eye(3), rotations.shape), translations)
    for joint in range(case["joints"]):
        expected = translations[:, list(chain_to_root(parents, joint))].sum(axis=1)
        what = f"without rotations, the position of joint {joint}"
        require_equal(what, positions[:, joint], expected)


@states(
    "own rotation",
    "a joint's own rotation moves its descendants, never the joint itself",
    sizes={"joints": (2, 3, 4, 6)},
    is_form=True,
)
def _own_rotation(function, case, parents, rotations, translations):
    before = function(parents, rotations, translations)
    rotations[:, -1] = rotations[:, -1] @ random_rotations(case, case.rng(), 1)
    after = function(parents, rotations, translations)
    require_equal("with its last joint rotated, a position", after, before)


_channels_as_matrix = same_as(rotation_from_channels, "the matrix's entry")
_one_channel = "a single channel rotates about its axis, by the right-hand rule"
_several_channels = "several channels are multiplied in the order of the file"

EXERCISES = (
    exercise(chain_to_root, _tree_arguments, TREE_SIZES, _chain_as_array, pure=False),
    exercise(
        rotation_from_channels,
        _channel_arguments,
        {"channels": (1, 2, 3)},
        states("one channel", _one_channel, sizes={"channels": (1,)})(_channels_as_matrix),
        states("order", _several_channels)(_channels_as_matrix),
        _is_rotation,
        pure=False,
    ),
    exercise(
        forward_kinematics,
        _motion_arguments,
        MOTION_SIZES,
        _rest_pose,
        _own_rotation,
        value="p_j = p_parent + G_parent t_j with G_j = G_parent R_j, joint by joint",
    ),
    exercise(
        speeds,
        _speed_arguments,
        {"frames": (2, 3, 5), "joints": (1, 2, 3)},
        value="the distance between a joint's positions in successive frames, times the rate",
        pure=False,
    ),
)
