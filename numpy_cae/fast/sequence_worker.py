"""One thread's clips through both GRUs and back, in buffers of its own."""

import numpy as np

from numpy_cae.fast.aligned import aligned_empty
from numpy_cae.fast.gru_matrices import GruMatrices, gru_gradients
from numpy_cae.fast.products import RowGroups
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
        training: bool,
    ):
        self.encoder, self.decoder = encoder, decoder
        self.clips, self.frames, self.burn_in = clips, frames, burn_in
        steps = burn_in + frames
        hidden, features = encoder.hidden, len(encoder.inputs_back)
        self.hidden, self.features = hidden, features
        batch, dtype = clips.stop - clips.start, encoder.inputs.dtype
        self.reader = Recurrence(hidden, batch, frames, dtype, training)
        self.writer = Recurrence(hidden, batch, steps, dtype, training)
        self.clip = aligned_empty((frames, features + 1, batch), dtype)
        self.fed = aligned_empty((steps + 1, features + 1, batch), dtype)
        self.fed[0] = 0
        self.clip[:, features] = self.fed[:, features] = 1
        self.loss, self.gradients = 0.0, dict[str, np.ndarray]()
        a = aligned_empty((3 * hidden, batch), dtype)
        s_and_y = aligned_empty((3 * hidden + features, batch), dtype)
        s, self._y = s_and_y[: 3 * hidden], s_and_y[3 * hidden :]
        gates_of_a, gates_of_s = a.reshape(3, hidden, batch), s.reshape(3, hidden, batch)
        self._gates = (gates_of_a[1:], gates_of_a[0]), (gates_of_s[:2], gates_of_s[2])
        self._read_state = RowGroups(encoder.states, s)
        self._read_frame = RowGroups(encoder.inputs, a)
        self._write_frame = RowGroups(decoder.states, s_and_y)
        self._feed_frame = RowGroups(decoder.inputs, a)
        if training:
            # Of step k: da_n, da_r, da_z, ds_n, and dy_k, the gradient of the frame it is fed.
            # Index S + T holds the dy of the last frame alone.
            self._gradients = aligned_empty((steps + 1, 4 * hidden + features, batch), dtype)
            self._gradients[-1] = 0
            self._parts = [each[: 4 * hidden].reshape(4, hidden, batch) for each in self._gradients]
            self._rows = aligned_empty((5 * hidden + 2 * features + 2, (steps + 1) * batch), dtype)
            self._dh, self._product = aligned_empty((2, hidden, batch), dtype)
            self._dx = aligned_empty((features, batch), dtype)
            self._read_back = RowGroups(encoder.states_back, self._product)
            self._write_back = RowGroups(decoder.states_back, self._product)
            self._feed_back = RowGroups(decoder.inputs_back, self._dx)

    def read(self, x: np.ndarray) -> np.ndarray:
        """h_T of the encoder, (H, B), for its part of (B, T, F) clips."""
        self.clip[:, : self.features] = x[self.clips].transpose(1, 2, 0)
        for k in range(self.frames):
            self._read_frame(self.clip[k])
            self._read_state(self.reader.states[k])
            self.reader.step(k, *self._gates)
        return self.reader.states[-1, : self.hidden]

    def write(self, h0: np.ndarray) -> None:
        """Put the frames y_1 to y_(S+T) into `fed`, from the decoder's first state (H, B)."""
        hidden, features = self.hidden, self.features
        self.writer.states[0, :hidden] = h0
        for k in range(len(self.fed) - 1):
            self._write_frame(self.writer.states[k])
            if k > 0:  # the first input is zero, not a frame of h_0
                self.fed[k, :features] = self._y
            self._feed_frame(self.fed[k])
            self.writer.step(k, *self._gates)
        np.matmul(self.decoder.states[3 * hidden :], self.writer.states[-1], out=self._y)
        self.fed[-1, :features] = self._y

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
                self._feed_back(step[: 3 * hidden])
                dy = step[4 * hidden :]
                np.add(dy, dx, dy)
                self._write_back(step[hidden:])
            else:
                np.matmul(states_back[:, : 3 * hidden], step[hidden : 4 * hidden], out=product)
            np.add(dh, product, dh)

        d, h_and_y = self._in_rows(gradients, self.writer.states, self.fed)
        dframe = h_and_y[: hidden + 1] @ d[4 * hidden :].T
        of_gru = _named("decoder", gru_gradients(d[: 4 * hidden], h_and_y))
        return dh, {**of_gru, "frame_w": dframe[:-1], "frame_b": dframe[-1]}

    def read_pullback(self, dh_last: np.ndarray) -> Weights:
        """The gradients of the encoder's weights from dh_T, (H, B)."""
        hidden, frames = self.hidden, self.frames
        dh, product = self._dh, self._product
        dh[...] = dh_last
        for k in reversed(range(frames)):
            self.reader.step_pullback(k, dh, self._parts[k])
            if k > 0:  # h_0 is no parameter
                self._read_back(self._gradients[k, hidden : 4 * hidden])
                np.add(dh, product, dh)

        gradients = self._gradients[:frames, : 4 * hidden]
        d, h_and_x = self._in_rows(gradients, self.reader.states[:frames], self.clip)
        return _named("encoder", gru_gradients(d, h_and_x))

    def _in_rows(self, gradients: np.ndarray, *factors: np.ndarray) -> tuple[np.ndarray, ...]:
        """The gradients, and the factors one below the other; each (T, rows, B) as (rows, T·B).

        So a sum over steps and clips is one product.
        """
        frames, stop, batch = gradients.shape
        start = 0
        for each in (gradients, *factors):
            rows = self._rows[start : start + each.shape[1], : frames * batch]
            rows.reshape(-1, frames, batch)[...] = each.transpose(1, 0, 2)
            start += each.shape[1]
        return self._rows[:stop, : frames * batch], self._rows[stop:start, : frames * batch]


def _named(gru: str, gradients: list[np.ndarray]) -> Weights:
    return {f"{gru}_{letter}": each for letter, each in zip("wubc", gradients, strict=True)}
