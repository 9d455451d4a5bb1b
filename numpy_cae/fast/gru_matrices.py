"""The weights of a GRU rearranged into one matrix per product, copied for every step of training.

Biases become one more column, since states and frames have a row of ones; the gates change their
order (see `recurrence`), and those that go through σ are halved:

    a = inputs · (x, 1)              inputs   (3H, F + 1)     new, ½ update, ½ reset
    (s, y) = states · (h, 1)         states   (3H + F, H + 1) ½ update, ½ reset, new; frame

`y`, the frame that the decoder writes, is a map of the same state and so part of the same product;
the encoder has none. The pullbacks have no halves and no biases:

    dx = inputs_back · da            inputs_back  (F, 3H)
    dh = states_back · (ds, dy)      states_back  (H, 3H + F)
"""

from __future__ import annotations

import numpy as np

from numpy_cae.models.sequential_autoencoder import Weights, gru_weights

INPUT_GATES = (2, 1, 0)
"""The order of the gates in a: new, update, reset, by their index in the weights."""

STATE_GATES = (1, 0, 2)
"""The order of the gates in s: update, reset, new."""

NEW = 2


class GruMatrices:
    """The matrices of the "encoder" or the "decoder"; the latter's include the map to a frame."""

    def __init__(self, gru: str, features: int, hidden: int, dtype: np.dtype):
        self.gru, self.hidden = gru, hidden
        written = features if gru == "decoder" else 0
        self.inputs = np.empty((3 * hidden, features + 1), dtype)
        self.states = np.empty((3 * hidden + written, hidden + 1), dtype)
        self.inputs_back = np.empty((features, 3 * hidden), dtype)
        self.states_back = np.empty((hidden, 3 * hidden + written), dtype)

    def load(self, weights: Weights, back: bool) -> None:
        """Copy the weights; those of the pullbacks only if `back`."""
        w, u, b, c = gru_weights(weights, self.gru)
        hidden = self.hidden
        for matrix, weight, bias, order in (
            (self.inputs, w, b, INPUT_GATES),
            (self.states, u, c, STATE_GATES),
        ):
            for index, gate in enumerate(order):
                rows, columns = _gate(index, hidden), _gate(gate, hidden)
                half = 1 if gate == NEW else 0.5
                _place_transposed(weight[:, columns], half, matrix[rows, :-1])
                np.multiply(bias[columns], half, out=matrix[rows, -1])
        if self.gru == "decoder":
            _place_transposed(weights["frame_w"], 1, self.states[3 * hidden :, :-1])
            self.states[3 * hidden :, -1] = weights["frame_b"]
        if not back:
            return
        for matrix, weight, order in (
            (self.inputs_back, w, INPUT_GATES),
            (self.states_back, u, STATE_GATES),
        ):
            for index, gate in enumerate(order):
                matrix[:, _gate(index, hidden)] = weight[:, _gate(gate, hidden)]
        if self.gru == "decoder":
            self.states_back[:, 3 * hidden :] = weights["frame_w"]


def gates_gradient(rows: np.ndarray, gradients: np.ndarray, order: tuple[int, ...]) -> np.ndarray:
    """dW with db as its last row, (in + 1, 3H): one product a gate over every step and clip.

    Parameters
    ----------
    rows : (in + 1, N) array
        The gates' inputs, with a row of ones, whose product is db.
    gradients : (3H, N) array
        Gates in `order`.
    """
    hidden = len(gradients) // 3
    out = np.empty((len(rows), 3 * hidden), rows.dtype)
    for index, gate in enumerate(order):
        np.matmul(rows, gradients[_gate(index, hidden)].T, out=out[:, _gate(gate, hidden)])
    return out


def _place_transposed(matrix: np.ndarray, factor: float, out: np.ndarray) -> None:
    """out = factor · matrixᵀ, 16 rows at a time: all rows in one call take twice as long."""
    for start in range(0, len(matrix), 16):
        part = slice(start, start + 16)
        np.multiply(matrix[part].T, factor, out=out[:, part])


def _gate(index: int, hidden: int) -> slice:
    return slice(index * hidden, (index + 1) * hidden)
