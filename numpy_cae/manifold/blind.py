"""Projection of a motion that lost values nobody knows of (holden2015, section 7): what the motion
itself tells of p, and one network asked at every place of its pooling grid."""

from __future__ import annotations

import numpy as np

from numpy_cae.models import ConvAutoencoder

AT_ONCE = 64
"""Windows that are projected together, to spare memory."""


def lost_share(x: np.ndarray) -> np.ndarray:
    """p̂, the share of values that are exactly zero, of each window by itself.

    A value that was measured is hardly ever the mean pose to the last digit. A feature that is zero
    in every frame says nothing of p and is left out: two always are (the hips stand above their own
    place on the floor), and a marker that is absent for a whole clip is another kind of loss.

    Parameters
    ----------
    x : (B, T, C) array of float
        Normalised windows, zero the mean pose.

    Returns
    -------
    (B, 1, 1) array in the dtype of x
        At least 0, below 1; 0 where nothing is exactly zero, as in any recording that was not
        zeroed on purpose.
    """
    zero = x == 0
    counted = ~zero.all(axis=1, keepdims=True)
    share = (zero & counted).sum(axis=(1, 2)) / np.maximum(x.shape[1] * counted.sum(axis=(1, 2)), 1)
    return share[:, None, None].astype(x.dtype)


def project_shifted(network: ConvAutoencoder, x: np.ndarray, shifts: int = 1) -> np.ndarray:
    """Φ†(Φ(X)), the mean over `shifts` places of the pooling grid.

        mean_s  S_s⁻¹ Φ†(Φ(S_s X)),   S_s: s frames later,   s = 0 … shifts - 1

    Pooling pairs frames (0, 1), (2, 3), …, so a motion shifted by one frame is projected a little
    differently: the network commutes with shifts by `frames_per_unit` only. Each of the places is
    as good as any other and errs in its own way; in their mean a part of that cancels. It is a use
    of the one trained network, nothing is learned for it; it takes `shifts` times as long.

    Parameters
    ----------
    network : ConvAutoencoder
    x : (B, T, C) array of float
        Normalised windows.
    shifts : int
        1 is plain projection; `network.frames_per_unit` are all that differ.

    Returns
    -------
    (B, T, C) array
    """
    parts = [x[start : start + AT_ONCE] for start in range(0, len(x), AT_ONCE)]
    return np.concatenate([_mean_projection(network, part, shifts) for part in parts])


def _mean_projection(network: ConvAutoencoder, x: np.ndarray, shifts: int) -> np.ndarray:
    total, frames = network.project(x), x.shape[1]
    for shift in range(1, shifts):
        # A whole unit of zeros, which is what the convolution sees beyond a window anyway.
        around = ((0, 0), (shift, network.frames_per_unit - shift), (0, 0))
        total += network.project(np.pad(x, around))[:, shift : shift + frames]
    return total / shifts
