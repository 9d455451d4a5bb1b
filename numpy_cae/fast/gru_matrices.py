"""The weights of a GRU rearranged into one matrix per product.

States and frames have a row of ones, so biases are one more column:

    a = inputs · (x, 1)              inputs       (3H, F + 1)
    (s, y) = states · (h, 1)         states       (3H + F, H + 1)

`y`, the frame that the decoder writes, is a map of the same state and so part of the same product;
the encoder has none. The gradients of a step are in the order da_n, da_r, da_z, ds_n (see
`fast_gru`), of which the first three are da and the last three ds. The pullbacks are

    dx = inputs_back · da            inputs_back  (F, 3H)          new, reset, update
    dh = states_back · (ds, dy)      states_back  (H, 3H + F)
"""

from typing import NamedTuple

import numpy as np

from numpy_cae.fast.products import aligned_empty
from numpy_cae.models.sequential_autoencoder import Weights, gru_weights


class GruMatrices(NamedTuple):
    """The matrices of one GRU."""

    inputs: np.ndarray
    states: np.ndarray
    inputs_back: np.ndarray
    states_back: np.ndarray


def gru_matrices(weights: Weights, gru: str) -> GruMatrices:
    """The matrices of the "encoder" or the "decoder"; the latter's include the map to a frame."""
    w, u, b, c = gru_weights(weights, gru)
    sigmoids = 2 * len(u)
    inputs_back = np.hstack([w[:, sigmoids:], w[:, :sigmoids]])
    if gru == "decoder":
        u = np.hstack([u, weights["frame_w"]])
        c = np.hstack([c, weights["frame_b"]])
    return GruMatrices(_transposed(w, b), _transposed(u, c), inputs_back, u)


def _transposed(weight: np.ndarray, bias: np.ndarray) -> np.ndarray:
    """(weightᵀ, bias), 16 columns at a time: all in one call take twice as long."""
    out = aligned_empty((len(bias), len(weight) + 1), weight.dtype)
    for start in range(0, len(weight), 16):
        out[:, start : min(start + 16, len(weight))] = weight[start : start + 16].T
    out[:, -1] = bias
    return out
