"""The solutions of lesson 01, a motion is an array."""

import numpy as np


def chain_to_root(parents, joint):
    """The joint, its parent, and so on, the root last."""
    chain = ()
    while joint != -1:
        chain += (joint,)
        joint = parents[joint]
    return chain


def rotation_from_channels(axes, angles):
    """The product of the rotations about each axis, the first one leftmost, (3, 3)."""
    matrix = np.eye(3)
    for axis, angle in zip(axes, np.radians(angles), strict=True):
        cos, sin = np.cos(angle), np.sin(angle)
        towards, away = (axis + 1) % 3, (axis + 2) % 3
        turn = np.eye(3)
        turn[towards, towards] = turn[away, away] = cos
        turn[away, towards], turn[towards, away] = sin, -sin
        matrix = matrix @ turn
    return matrix


def forward_kinematics(parents, rotations, translations):
    """p_j = p_parent + G_parent t_j with G_j = G_parent R_j, (F, J, 3)."""
    positions = np.empty(translations.shape)
    turned = np.empty(rotations.shape)
    for joint, parent in enumerate(parents):
        if parent == -1:
            turned[:, joint] = rotations[:, joint]
            positions[:, joint] = translations[:, joint]
        else:
            turned[:, joint] = turned[:, parent] @ rotations[:, joint]
            rotated_bone = turned[:, parent] @ translations[:, joint, :, None]
            positions[:, joint] = positions[:, parent] + rotated_bone[..., 0]
    return positions


def speeds(positions, rate):
    """The distance from each frame to the next times the frames a second, (F - 1, J)."""
    steps = positions[1:] - positions[:-1]
    return rate * np.sqrt((steps**2).sum(axis=-1))
