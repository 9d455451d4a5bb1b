"""How far a hip or a shoulder is turned from what the other joints predict.

The positions of the joints outside the limb, in the body's frame, at the frames t - 4, t and t + 4
at thirty a second, predict the rotation vector of the joint (`cleanup.joint_regression`). The
regression is fitted to the take without the block of time that it predicts, and without a margin
around it, and is robust: frames are weighed by their residuals of the round before.
"""

import numpy as np

from numpy_cae.cleanup.joint_regression import mean_rotation, visible_positions
from numpy_cae.cleanup.view import View
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, RATE
from numpy_cae.motion.angles import unwrap
from numpy_cae.motion.quaternions import from_vector, inverse, product, to_vector
from numpy_cae.motion.regression import join_lags
from studies.explaining.planted import moved_joints

LAG_SECONDS = 4 / RATE
"""The time (s) between the frames whose positions predict a frame."""
BLOCK_SECONDS = 1.0
MARGIN_SECONDS = 0.3
"""Blocks that are predicted, and what is left out around them (s)."""
LEAST_FRAMES = 60
"""A regression is fitted to at least so many frames, a thirtieth of a second apart."""
RIDGE = 1e-3
"""The ridge, as a share of the trace of the moments."""
ROUNDS = 3
"""Rounds of weighing."""


def limb_residual(view: View, joint: str) -> tuple[np.ndarray, np.ndarray] | None:
    """The rotation vectors from the predicted rotation of a joint to that of the file, in its own
    frame and in its parent's, (frames, 3) in radians; None where the take is too short."""
    rate = view.rate
    step = max(1, round(rate / RATE))
    is_visible = np.ones(len(JOINTS), bool)
    is_visible[moved_joints(joint)] = False
    visible = visible_positions(view.body, is_visible, rate)
    if visible is None:
        return None
    q = view.motion.rotations[:, rig_of(view.motion).joints[JOINTS.index(joint)]][:, None]
    mean = mean_rotation(q)
    y = unwrap(to_vector(product(inverse(mean), q)))[:, 0]
    x = join_lags(visible, max(1, round(LAG_SECONDS * rate)))
    frames = np.arange(len(y))
    predicted = np.zeros(y.shape)
    weights = np.ones(len(y))
    block = round(BLOCK_SECONDS * rate)
    margin = round(MARGIN_SECONDS * rate)
    for _ in range(ROUNDS):
        for start in range(0, len(y), block):
            end = min(start + block, len(y))
            outside = (frames < start - margin) | (frames >= end + margin)
            training = np.flatnonzero(outside)[::step]
            if len(training) < LEAST_FRAMES:
                return None
            predicted[start:end] = _fit(x, y, weights, training, slice(start, end))
        size = np.linalg.norm(y - predicted, axis=1)
        weights = 1 / (1 + (size / (2 * np.median(size) + 1e-9)) ** 2)
    expected = product(mean, from_vector(predicted[:, None]))[:, 0]
    own = to_vector(product(inverse(expected), q[:, 0]))
    parent = to_vector(product(q[:, 0], inverse(expected)))
    return own, parent


def _fit(
    x: np.ndarray, y: np.ndarray, weights: np.ndarray, training: np.ndarray, block: slice
) -> np.ndarray:
    """The weighted ridge regression of y on x over some frames, in the frames of a block."""
    w = weights[training][:, None]
    x_mean = np.sum(w * x[training], axis=0) / w.sum()
    y_mean = np.sum(w * y[training], axis=0) / w.sum()
    centred = (x[training] - x_mean) * np.sqrt(w)
    values = (y[training] - y_mean) * np.sqrt(w)
    # With fewer frames than numbers the dual form is smaller: B = Xᵀ (X Xᵀ + λ I)⁻¹ Y.
    kernel = centred @ centred.T
    ridge = RIDGE * np.trace(kernel) + 1e-12
    weighed = np.linalg.solve(kernel + ridge * np.eye(len(kernel)), values)
    return y_mean + (x[block] - x_mean) @ (centred.T @ weighed)
