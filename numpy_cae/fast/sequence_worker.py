"""One thread's clips through both GRUs and back, in buffers of its own."""

from __future__ import annotations

import numpy as np

from numpy_cae.fast.gru_matrices import INPUT_GATES, STATE_GATES, GruMatrices, gates_gradient
from numpy_cae.fast.recurrence import Recurrence
from numpy_cae.models.sequential_autoencoder import Weights


class SequenceWorker:
    """Buffers for its `clips` of a batch, T frames each, which follow S frames of a burn-in.

    Attributes
    ----------
    clip : (T, F + 1, B) array
        The source, in the order of time, with a row of ones below.
    fed : (S + T + 1, F + 1, B) array
        The frames y_0 = 0, y_1, …, y_(S+T) in the order of writing, each with a one below.
    """

    def __init__(
        self,
        encoder: GruMatrices,
        decoder: GruMatrices,
        clips: slice,
        frames: int,
        burn_in: int,
        dtype: np.dtype,
        training: bool,
    ):
        self.encoder, self.decoder = encoder, decoder
        self.clips, self.frames, self.burn_in = clips, frames, burn_in
        steps = burn_in + frames
        hidden, features = encoder.hidden, len(encoder.inputs_back)
        self.hidden, self.features = hidden, features
        batch = clips.stop - clips.start
        self.reader = Recurrence(hidden, batch, frames, dtype, training)
        self.writer = Recurrence(hidden, batch, steps, dtype, training)
        self.clip = np.ones((frames, features + 1, batch), dtype)
        self.fed = np.ones((steps + 1, features + 1, batch), dtype)
        self.fed[0, :features] = 0
        self.loss, self.gradients = 0.0, dict[str, np.ndarray]()
        self._products = np.empty((3 * hidden + features, batch), dtype)
        self._a = np.empty((3 * hidden, batch), dtype)
        self._tall = np.empty((frames, 3 * hidden, batch), dtype)
        if training:
            # Of step k: da_n, da_z, da_r, ds_n, and dy_k, the gradient of the frame it is fed.
            # Index S + T holds the dy of the last frame alone.
            self._gradients = np.zeros((steps + 1, 4 * hidden + features, batch), dtype)
            self._parts = [each[: 4 * hidden].reshape(4, hidden, batch) for each in self._gradients]
            self._rows = np.empty((5 * hidden + 2 * features + 2, (steps + 1) * batch), dtype)
            self._dh, self._product = np.empty((2, hidden, batch), dtype)
            self._dx = np.empty((features, batch), dtype)

    def read(self, x: np.ndarray) -> np.ndarray:
        """h_T of the encoder, (H, B), for its part of (B, T, F) clips."""
        self.clip[:, : self.features] = x[self.clips].transpose(1, 2, 0)
        np.matmul(self.encoder.inputs, self.clip, out=self._tall)
        s = self._products[: 3 * self.hidden]
        split_s = self._split(s, 0)
        for k in range(self.frames):
            np.matmul(self.encoder.states, self.reader.states[k], out=s)
            self.reader.step(k, self._split(self._tall[k], 1), split_s)
        return self.reader.states[-1, : self.hidden]

    def write(self, h0: np.ndarray) -> np.ndarray:
        """The frames y_1 to y_(S+T), (S + T, F, B), from the decoder's first state (H, B)."""
        hidden, features = self.hidden, self.features
        self.writer.states[0, :hidden] = h0
        s_and_y, a = self._products, self._a
        split_s, split_a = self._split(s_and_y[: 3 * hidden], 0), self._split(a, 1)
        y = s_and_y[3 * hidden :]
        for k in range(len(self.fed) - 1):
            np.matmul(self.decoder.states, self.writer.states[k], out=s_and_y)
            if k > 0:  # the first input is zero, not a frame of h_0
                self.fed[k, :features] = y
            np.matmul(self.decoder.inputs, self.fed[k], out=a)
            self.writer.step(k, split_a, split_s)
        np.matmul(self.decoder.states[3 * hidden :], self.writer.states[-1], out=y)
        self.fed[-1, :features] = y
        return self.fed[1:, :features]

    def copy_clips(self, out: np.ndarray) -> None:
        """Put the written clips, in the order of time, into its part of (B, T, F)."""
        out[self.clips] = self.fed[: self.burn_in : -1, : self.features].transpose(2, 0, 1)

    def compare(self, elements: int) -> float:
        """Its part of the mean squared error; stores dy = 2 (y - x) / N for `write_pullback`.

        The frame that is written last is the clip's first; those of the burn-in are not compared.
        """
        first = 1 + self.burn_in
        self._gradients[:first, 4 * self.hidden :] = 0
        dy = self._gradients[first:, 4 * self.hidden :]
        np.subtract(self.fed[first:, : self.features], self.clip[::-1, : self.features], out=dy)
        loss = float(np.vdot(dy, dy)) / elements
        dy *= 2 / elements
        return loss

    def write_pullback(self) -> tuple[np.ndarray, Weights]:
        """dh_0 of the decoder, (H, B), and the gradients of its weights."""
        hidden, states_back = self.hidden, self.decoder.states_back
        gradients, dh, dx, product = self._gradients, self._dh, self._dx, self._product
        np.matmul(states_back[:, 3 * hidden :], gradients[-1, 4 * hidden :], out=dh)
        for k in reversed(range(len(self.fed) - 1)):
            self.writer.step_pullback(k, dh, self._parts[k])
            step = gradients[k]
            if k > 0:  # y_0 is constant
                np.matmul(self.decoder.inputs_back, step[: 3 * hidden], out=dx)
                dy = step[4 * hidden :]
                np.add(dy, dx, dy)
                np.matmul(states_back, step[hidden:], out=product)
            else:
                np.matmul(states_back[:, : 3 * hidden], step[hidden : 4 * hidden], out=product)
            np.add(dh, product, dh)

        d, h, y = self._in_rows(gradients, self.writer.states, self.fed)
        dw_db = gates_gradient(y, d[: 3 * hidden], INPUT_GATES)
        du_dc = gates_gradient(h, d[hidden : 4 * hidden], STATE_GATES)
        dframe = h @ d[4 * hidden :].T
        gradients_by_name = _named("decoder", dw_db, du_dc)
        return dh, {**gradients_by_name, "frame_w": dframe[:-1], "frame_b": dframe[-1]}

    def read_pullback(self, dh_last: np.ndarray) -> Weights:
        """The gradients of the encoder's weights from dh_T, (H, B)."""
        hidden, frames = self.hidden, self.frames
        dh, product = self._dh, self._product
        dh[...] = dh_last
        for k in reversed(range(frames)):
            self.reader.step_pullback(k, dh, self._parts[k])
            if k > 0:  # h_0 is no parameter
                ds = self._gradients[k, hidden : 4 * hidden]
                np.matmul(self.encoder.states_back, ds, out=product)
                np.add(dh, product, dh)

        d, h, x = self._in_rows(
            self._gradients[:frames, : 4 * hidden], self.reader.states[:frames], self.clip
        )
        dw_db = gates_gradient(x, d[: 3 * hidden], INPUT_GATES)
        du_dc = gates_gradient(h, d[hidden:], STATE_GATES)
        return _named("encoder", dw_db, du_dc)

    def _split(self, gates: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray]:
        """(3H, B) as update and reset, (2, H, B), which start at gate `first`, and new, (H, B)."""
        parts = gates.reshape(3, self.hidden, -1)
        return parts[first : first + 2], parts[2 - 2 * first]

    def _in_rows(self, *arrays: np.ndarray) -> list[np.ndarray]:
        """Each (T, rows, B) as (rows, T·B), so that a sum over steps and clips is one product."""
        frames, _, batch = arrays[0].shape
        out, start = [], 0
        for each in arrays:
            stop = start + each.shape[1]
            rows = self._rows[start:stop, : frames * batch]
            rows.reshape(-1, frames, batch)[...] = each.transpose(1, 0, 2)
            out.append(rows)
            start = stop
        return out


def _named(name: str, dw_db: np.ndarray, du_dc: np.ndarray) -> Weights:
    return {
        f"{name}_w": dw_db[:-1],
        f"{name}_u": du_dc[:-1],
        f"{name}_b": dw_db[-1],
        f"{name}_c": du_dc[-1],
    }
