"""Projection of a motion in which an unknown share of the values was lost (holden2015, section 7).

`zeroed_fraction` estimates that share from the motion. `project_shifted` averages projections over
all shifts of the pooling grid.
"""

import numpy as np

from numpy_cae.models import ConvAutoencoder

WINDOWS_AT_ONCE = 64
"""WINDOWS_AT_ONCE: at most this many windows are projected together, to bound memory."""


def zeroed_fraction(x: np.ndarray) -> np.ndarray:
    """p̂, the share of values that are exactly zero, of each window.

    A measured value is hardly ever equal to the mean pose to the last digit. Features that are zero
    in every frame are not counted: two always are (the hips' x and z in the body's frame), and a
    marker that is missing throughout a clip is another kind of damage.

    Normalised windows (B, T, C), in which zero is the mean pose, give an array (B, 1, 1) in [0, 1).
    """
    zero = x == 0
    counted = ~zero.all(axis=1, keepdims=True)
    share = (zero & counted).sum(axis=(1, 2)) / np.maximum(x.shape[1] * counted.sum(axis=(1, 2)), 1)
    return share[:, None, None].astype(x.dtype)


def project_shifted(
    network: ConvAutoencoder, x: np.ndarray, average_shifts: bool = False
) -> np.ndarray:
    """Φ†(Φ(X)) averaged over all shifts of the pooling grid.

        mean_s  S_s⁻¹ Φ†(Φ(S_s X)),   S_s: shift by s frames,   s = 0 … stride - 1

    Pooling pairs frames (0, 1), (2, 3), …, so the projection of a motion shifted by one frame
    differs a little. The errors of the different shifts partly cancel in their mean.

    S_s X has s frames of zeros before X and stride - s after it, as the convolution's own padding;
    S_0 X is X. A clip is first lengthened by repeating its ends (`MotionManifold.padded`), and then
    shifted as a whole.

    Normalised windows (B, T, C) give an array of that shape. Unless `average_shifts` it is the
    plain projection, s = 0.
    """
    shifts = network.stride if average_shifts else 1
    together = WINDOWS_AT_ONCE // shifts
    parts = [x[start : start + together] for start in range(0, len(x), together)]
    return np.concatenate([_mean_projection(network, part, shifts) for part in parts])


def _mean_projection(network: ConvAutoencoder, x: np.ndarray, shifts: int) -> np.ndarray:
    total = network.project(x)
    frames = x.shape[1]
    # Zeros, as the convolution's own padding, to a whole number of hidden frames.
    around = [((0, 0), (shift, network.stride - shift), (0, 0)) for shift in range(1, shifts)]
    if around:
        shifted = network.project(np.concatenate([np.pad(x, each) for each in around]))
        for shift, part in enumerate(np.split(shifted, shifts - 1), start=1):
            total += part[:, shift : shift + frames]
    return total / shifts
