"""The weights as the products of `member` take them, copied anew for every step of descent.

Biases become one more column, since states and frames carry a row of ones; the gates change their
order (see `recurrence`), and those that go through σ are halved:

    a = inputs · (x, 1)              inputs   (3H, F + 1)     new, ½ update, ½ reset
    (s, y) = states · (h, 1)         states   (3H + F, H + 1) ½ update, ½ reset, new; frame

`y`, the frame that the decoder writes, is a map of the same state, so it rides in the same product;
the encoder has none. On the way back there are no halves and no biases:

    dx = inputs_back · da            inputs_back  (F, 3H)
    dh = states_back · (ds, dy)      states_back  (H, 3H + F)
"""

from __future__ import annotations

import numpy as np

from numpy_cae.models.sequence_weights import Weights, gru_weights

OF_INPUTS = (2, 1, 0)
"""The gates of a, by their place in the weights: new, update, reset."""

OF_STATES = (1, 0, 2)
"""The gates of s: update, reset, new."""

NEW = 2


class Matrices:
    """Those of one GRU, with the map to a frame where it has one.

    Parameters
    ----------
    gru : "encoder" or "decoder"
    features, hidden : int
    dtype : float32 or float64
    """

    def __init__(self, gru: str, features: int, hidden: int, dtype: np.dtype):
        self.gru, self.hidden = gru, hidden
        written = features if gru == "decoder" else 0
        self.inputs = np.empty((3 * hidden, features + 1), dtype)
        self.states = np.empty((3 * hidden + written, hidden + 1), dtype)
        self.inputs_back = np.empty((features, 3 * hidden), dtype)
        self.states_back = np.empty((hidden, 3 * hidden + written), dtype)

    def load(self, weights: Weights, back: bool) -> None:
        """Copy the weights, those of the way back only where they are wanted."""
        w, u, b, c = gru_weights(weights, self.gru)
        hidden = self.hidden
        for matrix, over, bias, order in (
            (self.inputs, w, b, OF_INPUTS),
            (self.states, u, c, OF_STATES),
        ):
            for place, gate in enumerate(order):
                rows, columns = _gate(place, hidden), _gate(gate, hidden)
                half = 1 if gate == NEW else 0.5
                _place_turned(over[:, columns], half, matrix[rows, :-1])
                np.multiply(bias[columns], half, out=matrix[rows, -1])
        if self.gru == "decoder":
            _place_turned(weights["frame_w"], 1, self.states[3 * hidden :, :-1])
            self.states[3 * hidden :, -1] = weights["frame_b"]
        if not back:
            return
        for matrix, over, order in (
            (self.inputs_back, w, OF_INPUTS),
            (self.states_back, u, OF_STATES),
        ):
            for place, gate in enumerate(order):
                matrix[:, _gate(place, hidden)] = over[:, _gate(gate, hidden)]
        if self.gru == "decoder":
            self.states_back[:, 3 * hidden :] = weights["frame_w"]


def gates_gradient(rows: np.ndarray, gradients: np.ndarray, order: tuple[int, ...]) -> np.ndarray:
    """dW over db, (in + 1, 3H), as one product a gate over every step and clip.

    Parameters
    ----------
    rows : (in + 1, N) array
        What the gates were given, with its row of ones: that one's product is db.
    gradients : (3H, N) array
        Gates in `order`.
    """
    hidden = len(gradients) // 3
    out = np.empty((len(rows), 3 * hidden), rows.dtype)
    for place, gate in enumerate(order):
        np.matmul(rows, gradients[_gate(place, hidden)].T, out=out[:, _gate(gate, hidden)])
    return out


def _place_turned(matrix: np.ndarray, factor: float, place: np.ndarray, at_once: int = 16) -> None:
    """factor · matrixᵀ, a few rows at a time: all at once takes twice as long."""
    for start in range(0, len(matrix), at_once):
        part = slice(start, start + at_once)
        np.multiply(matrix[part].T, factor, out=place[:, part])


def _gate(place: int, hidden: int) -> slice:
    return slice(place * hidden, (place + 1) * hidden)
