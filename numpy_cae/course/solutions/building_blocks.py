"""The solutions of lessons 00 to 04: a first pullback, motions, features and operations."""

import numpy as np


def square(x):
    """y = x², elementwise.   dL/dx = 2 x · dL/dy"""
    y = x**2

    def pullback(dy):
        return 2 * x * dy

    return y, pullback


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


def heading_angle(across):
    """The angle of the forward direction about Y, without jumps by whole turns, (F,)."""
    forward = np.cross(across, np.array([0.0, 1.0, 0.0]))
    return np.unwrap(np.arctan2(forward[:, 0], forward[:, 2]))


def turn_about_y(vectors, angles):
    """R(angle of the frame) times each vector of the frame."""
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.stack([cos * x + sin * z, y, cos * z - sin * x], axis=-1)


def to_features(positions, theta):
    """Local positions, velocity on the ground and change of heading, (F, 63)."""
    floor = positions[:, :1].copy()
    floor[..., 1] = 0
    local = turn_about_y(positions - floor, -theta)
    steps = turn_about_y(floor[1:] - floor[:-1], -theta[:-1])
    features = np.empty((len(positions), 63))
    features[:, :60] = local.reshape(len(positions), 60)
    features[:-1, 60:62] = steps[:, 0, [0, 2]]
    features[:-1, 62] = theta[1:] - theta[:-1]
    features[-1, 60:] = features[-2, 60:]
    return features


def from_features(features, x, z, heading):
    """The positions of the features from a place and a heading on, (F, 20, 3)."""
    frames = len(features)
    theta = np.full(frames, heading, dtype=float)
    theta[1:] += np.cumsum(features[:-1, 62])
    steps = np.zeros((frames, 1, 3))
    steps[:, 0, 0], steps[:, 0, 2] = features[:, 60], features[:, 61]
    steps = turn_about_y(steps, theta)
    floor = np.zeros((frames, 1, 3))
    floor[1:] = np.cumsum(steps[:-1], axis=0)
    floor += np.array([x, 0.0, z])
    return floor + turn_about_y(features[:, :60].reshape(frames, 20, 3), theta)


def conv1d_by_loops(x, w, b):
    """y[t] = Σ_k x[t + k - K//2] w[k] + b, one number at a time."""
    (batch, frames, channels), (taps, _, filters) = x.shape, w.shape
    y = np.zeros((batch, frames, filters))
    for i in range(batch):
        for t in range(frames):
            for d in range(filters):
                y[i, t, d] = b[d]
                for k in range(taps):
                    there = t + k - taps // 2
                    if 0 <= there < frames:
                        for c in range(channels):
                            y[i, t, d] += x[i, there, c] * w[k, c, d]
    return y


def unfold(x, taps):
    """Row t holds the frames that a filter reads at t, (B, T, K * C)."""
    batch, frames, channels = x.shape
    padded = np.zeros((batch, frames + taps - 1, channels), dtype=x.dtype)
    padded[:, taps // 2 : taps // 2 + frames] = x
    return np.concatenate([padded[:, k : k + frames] for k in range(taps)], axis=-1)


def pooled_again(y, first):
    """max_pool(unpool_random(y, first)), without either of them."""
    return np.maximum(y, 0)
