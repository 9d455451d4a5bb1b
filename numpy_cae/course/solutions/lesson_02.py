"""The solutions of lesson 02, what to learn from."""

import numpy as np


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
