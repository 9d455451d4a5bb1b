"""The weights of a GRU rearranged into one matrix per product, copied for every step of training.

Biases become one more column, since states and frames have a row of ones; the gates of the inputs
change their order (see `recurrence`), and those that go through σ are halved:

    a = inputs · (x, 1)              inputs   (3H, F + 1)     new, ½ reset, ½ update
    (s, y) = states · (h, 1)         states   (3H + F, H + 1) ½ reset, ½ update, new; frame

`y`, the frame that the decoder writes, is a map of the same state and so part of the same product;
the encoder has none. The pullbacks have no halves and no biases:

    dx = inputs_back · da            inputs_back  (F, 3H)
    dh = states_back · (ds, dy)      states_back  (H, 3H + F)
"""

import numpy as np

from numpy_cae.fast.products import aligned_empty
from numpy_cae.models.sequential_autoencoder import Weights, gru_weights


class GruMatrices:
    """The matrices of the "encoder" or the "decoder"; the latter's include the map to a frame."""

    def __init__(self, gru: str, features: int, hidden: int, dtype: np.dtype):
        self.gru, self.hidden = gru, hidden
        written = features if gru == "decoder" else 0
        self.inputs = aligned_empty((3 * hidden, features + 1), dtype)
        self.states = aligned_empty((3 * hidden + written, hidden + 1), dtype)
        self.inputs_back = aligned_empty((features, 3 * hidden), dtype)
        self.states_back = aligned_empty((hidden, 3 * hidden + written), dtype)

    def load(self, weights: Weights) -> None:
        """Copy the weights."""
        w, u, b, c = gru_weights(weights, self.gru)
        hidden, sigmoids = self.hidden, 2 * self.hidden
        _place(w[:, sigmoids:], b[sigmoids:], 1, self.inputs[:hidden])
        _place(w[:, :sigmoids], b[:sigmoids], 0.5, self.inputs[hidden:])
        _place(u[:, :sigmoids], c[:sigmoids], 0.5, self.states[:sigmoids])
        _place(u[:, sigmoids:], c[sigmoids:], 1, self.states[sigmoids : 3 * hidden])
        if self.gru == "decoder":
            _place(weights["frame_w"], weights["frame_b"], 1, self.states[3 * hidden :])
            self.states_back[:, 3 * hidden :] = weights["frame_w"]
        self.inputs_back[:, :hidden] = w[:, sigmoids:]
        self.inputs_back[:, hidden:] = w[:, :sigmoids]
        self.states_back[:, : 3 * hidden] = u


def gru_gradients(d: np.ndarray, h_and_x: np.ndarray) -> list[np.ndarray]:
    """dW, dU, db and dc: products whose sums go over every step and clip.

    Parameters
    ----------
    d : (4H, N) array
        da_n, da_r = ds_r, da_z = ds_z and ds_n.
    h_and_x : (H + 1 + F + 1, N) array
        States and inputs, each with a row of ones, whose products are dc and db.
    """
    hidden = len(d) // 4
    sums = np.empty((len(h_and_x), 3 * hidden), d.dtype)
    du, dw = sums[: hidden + 1], sums[hidden + 1 :]
    np.matmul(h_and_x, d[hidden : 3 * hidden].T, out=sums[:, : 2 * hidden])
    np.matmul(h_and_x[: len(du)], d[3 * hidden :].T, out=du[:, 2 * hidden :])
    np.matmul(h_and_x[len(du) :], d[:hidden].T, out=dw[:, 2 * hidden :])
    return [dw[:-1], du[:-1], dw[-1], du[-1]]


def _place(weight: np.ndarray, bias: np.ndarray, factor: float, out: np.ndarray) -> None:
    """out = factor · (weightᵀ, bias), 16 columns at a time: all in one call take twice as long."""
    for start in range(0, len(weight), 16):
        part = slice(start, start + 16)
        np.multiply(weight[part].T, factor, out=out[:, :-1][:, part])
    np.multiply(bias, factor, out=out[:, -1])
