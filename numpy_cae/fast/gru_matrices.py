"""The weights of a GRU rearranged into one matrix per product, copied for every step of training.

The units are divided into parts, one for each thread; H is the number of those of one part, while h
has all. Biases become one more column, since states and frames have a row of ones; the gates change
their order (see `recurrence`), and those that go through σ are halved:

    a = inputs · (x, 1)              inputs   (3H, F + 1)     new, ½ update, ½ reset
    (s, y) = states · (h, 1)         states   (3H + F, H + 1) ½ update, ½ reset, new; frame

`y`, the frame that the decoder writes, is a map of the same state and so part of the same product;
the encoder has none. The pullbacks have no halves and no biases, and are sums over the parts:

    dx = Σ inputs_back · da          inputs_back  (F, 3H)
    dh = Σ states_back · (ds, dy)    states_back  (H, 3H + F) for the part itself, which includes
                                                  the frame, (H, 3H) for any other part
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from numpy_cae.models.sequential_autoencoder import Weights, gru_weights

INPUT_GATES = (2, 1, 0)
"""The order of the gates in a: new, update, reset, by their index in the weights."""

STATE_GATES = (1, 0, 2)
"""The order of the gates in s: update, reset, new."""

NEW = 2


class GruMatrices:
    """The matrices of one part of the "encoder" or the "decoder"; the latter's have a frame.

    `parts` are the units of every part, of which this is the one with index `part`.
    """

    def __init__(self, gru: str, features: int, parts: Sequence[slice], part: int, dtype: np.dtype):
        self.gru, self.parts, self.part = gru, parts, part
        self._hidden = parts[-1].stop
        gates = [3 * (each.stop - each.start) for each in parts]
        own, units = gates[part], gates[part] // 3
        written = features if gru == "decoder" else 0
        self.inputs = np.empty((own, features + 1), dtype)
        self.states = np.empty((own + written, self._hidden + 1), dtype)
        self.inputs_back = np.empty((features, own), dtype)
        self.states_back = [np.empty((units, each), dtype) for each in gates]
        self.states_back[part] = np.empty((units, own + written), dtype)

    def load(self, weights: Weights, back: bool) -> None:
        """Copy the weights; those of the pullbacks only if `back`."""
        w, u, b, c = gru_weights(weights, self.gru)
        units = self.parts[self.part]
        own = 3 * (units.stop - units.start)
        for matrix, weight, bias, order in (
            (self.inputs, w, b, INPUT_GATES),
            (self.states, u, c, STATE_GATES),
        ):
            for rows, columns, gate in self._gates(units, order):
                half = 1 if gate == NEW else 0.5
                _place_transposed(weight[:, columns], half, matrix[rows, :-1])
                np.multiply(bias[columns], half, out=matrix[rows, -1])
        if self.gru == "decoder":
            _place_transposed(weights["frame_w"], 1, self.states[own:, :-1])
            self.states[own:, -1] = weights["frame_b"]
        if not back:
            return
        for here, columns, _ in self._gates(units, INPUT_GATES):
            self.inputs_back[:, here] = w[:, columns]
        for matrix, part in zip(self.states_back, self.parts, strict=True):
            for here, columns, _ in self._gates(part, STATE_GATES):
                matrix[:, here] = u[units, columns]
        if self.gru == "decoder":
            self.states_back[self.part][:, own:] = weights["frame_w"][units]

    def gates_gradient(
        self, rows: np.ndarray, gradients: np.ndarray, order: tuple[int, ...], out: np.ndarray
    ) -> None:
        """This part's columns of dW with db as its last row, (in + 1, 3 · all units): a product a
        gate of `rows`, (in + 1, N) with a row of ones, and `gradients`, (3H, N) in `order`."""
        for here, columns, _ in self._gates(self.parts[self.part], order):
            np.matmul(rows, gradients[here].T, out=out[:, columns])

    def _gates(self, units: slice, order: tuple[int, ...]) -> Iterator[tuple[slice, slice, int]]:
        """For each gate: its rows among those of `units` alone, its columns in the weights, it."""
        count = units.stop - units.start
        for index, gate in enumerate(order):
            start = gate * self._hidden
            columns = slice(start + units.start, start + units.stop)
            yield slice(index * count, (index + 1) * count), columns, gate


def _place_transposed(matrix: np.ndarray, factor: float, out: np.ndarray) -> None:
    """out = factor · matrixᵀ, 16 rows at a time: all rows in one call take twice as long."""
    for start in range(0, len(matrix), 16):
        part = slice(start, start + 16)
        np.multiply(matrix[part].T, factor, out=out[:, part])
