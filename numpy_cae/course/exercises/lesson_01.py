"""The exercises of lesson 01, a motion is an array."""

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
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.property import require_equal

TREE_SIZES = {"joints": (1, 2, 3, 4, 6, 8)}
MOTION_SIZES = {"frames": (1, 2, 3), **TREE_SIZES}


def drawn_tree(case: Case) -> tuple[int, ...]:
    """The parents of a tree that is drawn so that every parent stands before its children."""
    rng = np.random.default_rng([case.seed, 2])
    return (-1, *(int(rng.integers(0, joint)) for joint in range(1, case["joints"])))


def drawn_rotations(rng: np.random.Generator, count: int) -> np.ndarray:
    """Rotation matrices in any direction, (count, 3, 3)."""
    return Rotation.from_rotvec(spread(rng, (count, 3))).as_matrix()


def chain_to_root(parents: tuple[int, ...], joint: int) -> tuple[int, ...]:
    chain = [joint]
    while parents[chain[-1]] != -1:
        chain.append(parents[chain[-1]])
    return tuple(chain)


def _chain_arguments(case: Case) -> dict[str, object]:
    return {"parents": drawn_tree(case), "joint": case.seed % case["joints"]}


def _chain(function: Callable, case: Case) -> None:
    given = _chain_arguments(case)
    found = function(*given.values())
    require_same(np.asarray(found), np.asarray(chain_to_root(**given)), ("the chain",))


def rotation_from_channels(axes: tuple[int, ...], angles: tuple[float, ...]) -> np.ndarray:
    letters = "".join("XYZ"[axis] for axis in axes)
    return Rotation.from_euler(letters, angles, degrees=True).as_matrix()


def _channels(case: Case) -> dict[str, object]:
    rng = case.rng()
    axes = tuple(int(axis) for axis in rng.permutation(3)[: case["channels"]])
    angles = tuple(float(angle) for angle in 90 * spread(rng, (case["channels"],)))
    return {"axes": axes, "angles": angles}


def _one_channel(function: Callable, case: Case) -> None:
    same_as(rotation_from_channels, _channels, ("the matrix's entry",))(function, case)


def _keeps_lengths(function: Callable, case: Case) -> None:
    matrix = np.asarray(function(*_channels(case).values()))
    require_equal("the matrix times its transpose", matrix @ matrix.T, np.eye(3))
    require_equal("its determinant", np.linalg.det(matrix), 1.0)


def forward_kinematics(
    parents: tuple[int, ...], rotations: np.ndarray, translations: np.ndarray
) -> np.ndarray:
    """p_j = p_parent + G_parent t_j,  G_j = G_parent R_j, each frame and joint by itself."""
    frames, joints = rotations.shape[:2]
    positions = np.zeros((frames, joints, 3))
    for frame in range(frames):
        turned = np.zeros((joints, 3, 3))
        for joint, parent in enumerate(parents):
            if parent == -1:
                turned[joint] = rotations[frame, joint]
                positions[frame, joint] = translations[frame, joint]
            else:
                turned[joint] = turned[parent] @ rotations[frame, joint]
                reach = turned[parent] @ translations[frame, joint]
                positions[frame, joint] = positions[frame, parent] + reach
    return positions


def _motion(case: Case) -> dict[str, object]:
    rng = case.rng()
    frames, joints = case["frames"], case["joints"]
    return {
        "parents": drawn_tree(case),
        "rotations": drawn_rotations(rng, frames * joints).reshape(frames, joints, 3, 3),
        "translations": spread(rng, (frames, joints, 3)),
    }


def _rest_pose(function: Callable, case: Case) -> None:
    given = _motion(case)
    still = given | {"rotations": np.broadcast_to(np.eye(3), given["rotations"].shape)}
    positions = function(*copies(still))
    for joint in range(case["joints"]):
        chain = list(chain_to_root(given["parents"], joint))
        expected = given["translations"][:, chain].sum(axis=1)
        require_equal(
            f"without rotations, the place of joint {joint}", positions[:, joint], expected
        )


def _lengths(function: Callable, case: Case) -> None:
    given = _motion(case)
    positions = function(*copies(given))
    for joint, parent in enumerate(given["parents"]):
        if parent != -1:
            lengths = np.linalg.norm(positions[:, joint] - positions[:, parent], axis=-1)
            expected = np.linalg.norm(given["translations"][:, joint], axis=-1)
            require_equal(f"the length of the bone to joint {joint}", lengths, expected)


def _own_rotation(function: Callable, case: Case) -> None:
    given = _motion(case)
    leaf = case["joints"] - 1
    twisted = given | {"rotations": given["rotations"].copy()}
    twisted["rotations"][:, leaf] = twisted["rotations"][:, leaf] @ drawn_rotations(case.rng(), 1)
    require_equal(
        "with its last joint turned, a position",
        function(*copies(twisted)),
        function(*copies(given)),
    )


def _turned_root(function: Callable, case: Case) -> None:
    given = _motion(case)
    turn = drawn_rotations(np.random.default_rng([case.seed, 3]), 1)[0]
    whole = {name: a.copy() if isinstance(a, np.ndarray) else a for name, a in given.items()}
    whole["rotations"][:, 0] = turn @ whole["rotations"][:, 0]
    whole["translations"][:, 0] = whole["translations"][:, 0] @ turn.T
    expected = function(*copies(given)) @ turn.T
    require_equal("with the root turned, a position", function(*copies(whole)), expected)


def speeds(positions: np.ndarray, rate: float) -> np.ndarray:
    return np.linalg.norm(np.diff(positions, axis=0), axis=-1) * rate


def _moving(case: Case) -> dict[str, object]:
    positions = spread(case.rng(), (case["frames"], case["joints"], 3))
    return {"positions": positions, "rate": (30.0, 120.0)[case.seed % 2]}


def _steady(function: Callable, case: Case) -> None:
    rate = _moving(case)["rate"]
    time = np.arange(case["frames"]) / rate
    positions = time[:, None, None] * np.array([3.0, 0.0, 4.0]) * np.ones((case["joints"], 1))
    expected = np.full((case["frames"] - 1, case["joints"]), 5.0)
    require_equal("at a steady 5 m/s, the speed", function(positions, rate), expected)


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "chain_to_root",
        "start with the joint itself and ask for its parent, again and again, until it is -1",
        chain_to_root,
        _chain_arguments,
        TREE_SIZES,
        (Claim("chain", "the joint, its parent, and so on, the root last", _chain, 2),),
    ),
    exercise(
        "rotation_from_channels",
        "the channel that stands first is the leftmost factor; mind degrees, and that a turn "
        "about Y takes Z towards X",
        rotation_from_channels,
        _channels,
        {"channels": (1, 2, 3)},
        (
            Claim(
                "one channel",
                "a single channel turns about its axis, by the right-hand rule",
                _one_channel,
                1,
                "write the three matrices down; each leaves its own axis alone",
                {"channels": (1,)},
            ),
            Claim(
                "order",
                "several channels are multiplied in the order of the file",
                _one_channel,
                2,
                "matrices do not commute: which factor meets the vector first?",
            ),
            Claim("rotation", "the matrix keeps lengths and does not mirror", _keeps_lengths),
        ),
    ),
    exercise(
        "forward_kinematics",
        "go through the joints in their order: a parent's position and global rotation are known "
        "before its children ask for them",
        forward_kinematics,
        _motion,
        MOTION_SIZES,
        (
            Claim(
                "value",
                "p_j = p_parent + G_parent t_j with G_j = G_parent R_j, joint by joint",
                same_as(forward_kinematics, _motion, ("the position",)),
                3,
                "is G_parent the parent's global rotation or its local one? on which side is R_j?",
            ),
            Claim(
                "rest pose",
                "without rotations a joint sits at the sum of the translations on its chain",
                _rest_pose,
            ),
            Claim("bone lengths", "a bone is as long as its translation", _lengths),
            Claim(
                "own rotation",
                "a joint's own rotation moves what hangs from it, never the joint itself",
                _own_rotation,
                1,
                "t_j is given in the parent's frame, not in the joint's",
                {"joints": (2, 3, 4, 6)},
            ),
            Claim("turned root", "turning the root turns the whole body", _turned_root),
            unaltered(_motion),
        ),
    ),
    exercise(
        "speeds",
        "the distance to the next frame, times how many such steps fit into a second",
        speeds,
        _moving,
        {"frames": (2, 3, 5), "joints": (1, 2, 3)},
        (
            Claim(
                "value",
                "the distance between a joint's places in neighbouring frames, a second",
                same_as(speeds, _moving, ("the speed",)),
                2,
            ),
            Claim("steady", "at a steady 5 m/s it is 5 in every frame", _steady),
        ),
    ),
)
