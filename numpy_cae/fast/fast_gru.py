"""The steps of a GRU over one thread's clips, in place: `ops.gru` without temporary arrays.

A step keeps only the factors that its pullback multiplies by. With
a = W · x + b, s = U · h + c, d = h - n, and dh the gradient for the state after the step:

    kept:    p_n = (1 - z) ∘ (1 - n²),   p_z = d ∘ z ∘ (1 - z),   p_r = s_n ∘ r ∘ (1 - r),   r,   z

    da_n, da_z = (p_n, p_z) ∘ dh            one call
    da_r, ds_n = (p_r, r) ∘ da_n            likewise
    dh ← z ∘ dh + Uᵀ · (ds_r, ds_z, ds_n)

The gradients of a step are stored in the order da_n, da_r, da_z, ds_n. Since ds_r = da_r and
ds_z = da_z, the first three are da and the last three ds, each one factor of a matrix product.

An array that enters a product over all steps and clips has the layout (rows, steps, B), so that it
is a matrix with a column for each clip of each step. The numbers of one step are computed in small
contiguous arrays, which fit the cache, and then copied into that layout.

**The weights** are rearranged into one matrix per product. States and frames have a row of ones, so
biases are one more column:

    a = inputs · (x, 1)              inputs       (3H, F + 1)
    (s, y) = states · (h, 1)         states       (3H + F, H + 1)

`y`, the frame that the decoder writes, is a map of the same state and so part of the same product;
the encoder has none. The gradients of a step are in the order da_n, da_r, da_z, ds_n of
which the first three are da and the last three ds. The pullbacks are

    dx = inputs_back · da            inputs_back  (F, 3H)          new, reset, update
    dh = states_back · (ds, dy)      states_back  (H, 3H + F)
"""

from typing import NamedTuple

import numpy as np

from numpy_cae.fast.products import aligned_empty, multiply_rows
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


class FastGru:
    """The encoder or the decoder for B clips of T steps.

    Parameters
    ----------
    name : {"encoder", "decoder"}
    clips : slice
        Which of a batch.
    shape : three of int
        F, H and T, the numbers of features, of hidden units and of steps.
    dtype : dtype
    training : bool
        Whether the pullbacks will be called. They are valid until the next call.

    Attributes
    ----------
    matrices : GruMatrices
        The caller sets them.
    """

    matrices: GruMatrices

    def __init__(
        self, name: str, clips: slice, shape: tuple[int, int, int], dtype: np.dtype, training: bool
    ):
        features, hidden, steps = shape
        self.name = name
        self.clips = clips
        self.hidden = hidden
        self.steps = steps
        self.training = training
        batch = clips.stop - clips.start
        # h_k over the input of step k, each with a row of ones; the last column is the decoder's.
        self._recorded = aligned_empty((hidden + features + 2, steps + 1, batch), dtype)
        self._recorded[:, -1] = 0
        self._recorded[[hidden, -1]] = 1
        # h_k is states[k % 2], with ones below, so that U · h + c is one product.
        self._states = aligned_empty((2, hidden + 1, batch), dtype)
        self._states[:, hidden] = 1
        self._a = aligned_empty((3 * hidden, batch), dtype)
        self._s_and_frame = aligned_empty((3 * hidden + features + 1, batch), dtype)
        self._frame = self._s_and_frame[3 * hidden :]
        self._frame[features] = 1
        self._n = aligned_empty((hidden, batch), dtype)
        self._rest = aligned_empty((2, hidden, batch), dtype)
        kept = aligned_empty((steps if training else 1, 5, hidden, batch), dtype)
        self._kept = list(kept) if training else [kept[0]] * steps
        if training:
            # Of step k: da_n, da_r, da_z, ds_n, and dy of its input; the last column has dy alone.
            self._gradients = aligned_empty((4 * hidden + features, steps + 1, batch), dtype)
            self._gradients[:, -1] = 0
            self._gradient = aligned_empty((4 * hidden + features, batch), dtype)
            self._dh = aligned_empty((hidden, batch), dtype)
            self._product = aligned_empty((hidden, batch), dtype)

    def read(self, x: np.ndarray) -> np.ndarray:
        """h_T, (B, H), of clips (B, T, F)."""
        self._states[0, :-1] = 0
        for k in range(self.steps):
            self._frame[:-1] = x[:, k].T
            self._multiply_state(k)
            self._step(k)
        return self._states[self.steps % 2, :-1].T

    def read_pullback(self, dh: np.ndarray) -> Weights:
        """The gradients by name, from dh_T."""
        self._dh[...] = dh.T
        for k in reversed(range(self.steps)):
            self._pull_back_gates(k)
            self._pull_back_state(k)
        return self._weight_gradients()

    def write(self, h0: np.ndarray) -> np.ndarray:
        """The frames y_1, …, y_T, (T, B, F), from h_0, (B, H); the input of a step is a frame."""
        self._states[0, :-1] = h0.T
        for k in range(self.steps):
            self._multiply_state(k)
            if k == 0:  # the first input is zero, not a frame of h_0
                self._frame[:-1] = 0
            self._step(k)
        self._multiply_state(self.steps)
        self._record(self.steps)
        return self._recorded[self.hidden + 1 : -1, 1:].transpose(1, 2, 0)

    def write_pullback(self, dy: np.ndarray) -> tuple[np.ndarray, Weights]:
        """dh_0 and the gradients by name, from dy_1, …, dy_T."""
        gates = 4 * self.hidden
        self._gradients[gates:, 0] = 0
        self._gradients[gates:, 1:] = dy.transpose(2, 0, 1)
        frame_w = self.matrices.states_back[:, 3 * self.hidden :]
        np.matmul(frame_w, self._gradients[gates:, -1], out=self._dh)
        for k in reversed(range(self.steps)):
            self._pull_back_gates(k)
            if k == 0:  # y_0 is constant
                self._gradient[gates:] = 0
            else:
                da = self._gradient[: 3 * self.hidden]
                multiply_rows(self.matrices.inputs_back, da, self._gradient[gates:])
                self._gradient[gates:] += self._gradients[gates:, k]
            self._pull_back_state(k)
        return self._dh.T, self._weight_gradients()

    def _multiply_state(self, k: int) -> None:
        """s of h_k and, in the decoder, the frame that it writes."""
        states = self.matrices.states
        multiply_rows(states, self._states[k % 2], self._s_and_frame[: len(states)])

    def _step(self, k: int) -> None:
        """h_(k+1) from s of h_k and the frame."""
        self._record(k)
        multiply_rows(self.matrices.inputs, self._frame, self._a)
        p_n, p_z, p_r, r, z = self._kept[k]
        rz = self._kept[k][3:]
        a = self._a.reshape(3, self.hidden, -1)
        s = self._s_and_frame[: 3 * self.hidden].reshape(a.shape)
        n = self._n
        np.add(a[:2], s[:2], rz)  # σ(v) = (1 + tanh(v / 2)) / 2
        np.multiply(rz, 0.5, rz)
        np.tanh(rz, rz)
        np.multiply(rz, 0.5, rz)
        np.add(rz, 0.5, rz)
        np.multiply(r, s[2], p_r)
        np.add(p_r, a[2], n)
        np.tanh(n, n)
        np.subtract(self._states[k % 2, :-1], n, p_z)
        np.multiply(p_z, z, p_z)
        np.add(p_z, n, self._states[1 - k % 2, :-1])  # n + z ∘ (h - n) = (1 - z) ∘ n + z ∘ h
        if self.training:
            np.subtract(1, rz, self._rest)
            np.multiply(p_r, self._rest[0], p_r)
            np.multiply(p_z, self._rest[1], p_z)
            np.multiply(n, n, n)
            np.subtract(1, n, n)
            np.multiply(n, self._rest[1], p_n)

    def _record(self, k: int) -> None:
        """Copy h_k and the input of step k to where they enter products over all steps."""
        self._recorded[self.hidden + 1 : -1, k] = self._frame[:-1]
        if self.training:
            self._recorded[: self.hidden, k] = self._states[k % 2, :-1]

    def _pull_back_gates(self, k: int) -> None:
        """The gradients of the gates of step k, from dh_(k+1), which becomes z ∘ dh_(k+1)."""
        kept = self._kept[k]
        gates = self._gradient[: 4 * self.hidden].reshape(4, self.hidden, -1)
        np.multiply(kept[:2], self._dh, gates[::2])
        np.multiply(kept[2:4], gates[0], gates[1::2])
        np.multiply(kept[4], self._dh, self._dh)

    def _pull_back_state(self, k: int) -> None:
        """dh_k, through s and, in the decoder, through the frame that h_k writes."""
        back = self.matrices.states_back
        above = self._gradient[self.hidden : self.hidden + back.shape[1]]
        multiply_rows(back, above, self._product)
        np.add(self._dh, self._product, self._dh)
        self._gradients[:, k] = self._gradient

    def _weight_gradients(self) -> Weights:
        """dW, dU, db, dc and, of the decoder, those of the map to a frame, by name.

        They are products whose sums go over every step and clip; ones in `_recorded` make db and dc
        part of them.
        """
        hidden = self.hidden
        h_and_x = self._recorded.reshape(len(self._recorded), -1)
        d = self._gradients.reshape(len(self._gradients), -1)
        sums = np.empty((len(h_and_x), 3 * hidden), d.dtype)
        du = sums[: hidden + 1]
        dw = sums[hidden + 1 :]
        np.matmul(h_and_x, d[hidden : 3 * hidden].T, out=sums[:, : 2 * hidden])
        np.matmul(h_and_x[: len(du)], d[3 * hidden : 4 * hidden].T, out=du[:, 2 * hidden :])
        np.matmul(h_and_x[len(du) :], d[:hidden].T, out=dw[:, 2 * hidden :])
        gradients = {"w": dw[:-1], "u": du[:-1], "b": dw[-1], "c": du[-1]}
        of_gru = {f"{self.name}_{letter}": each for letter, each in gradients.items()}
        if self.name == "encoder":
            return of_gru
        dframe = h_and_x[: len(du)] @ d[4 * hidden :].T
        return of_gru | {"frame_w": dframe[:-1], "frame_b": dframe[-1]}
