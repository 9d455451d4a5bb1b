"""The clips of one thread through both GRUs and back, in buffers that no other thread uses."""

import numpy as np

from numpy_cae.fast.gru_matrices import GruMatrices, gru_gradients
from numpy_cae.fast.products import RowGroups, aligned_empty
from numpy_cae.fast.recurrence import Recurrence
from numpy_cae.models.sequential_autoencoder import Weights


class SequenceWorker:
    """The buffers for the `clips` of one thread: T frames each, after S frames of a burn-in.

    An array that enters a product over all steps and clips has the layout (rows, steps, B), so that
    it is a matrix with a column for each clip of each step. The numbers of one step are computed in
    a small contiguous array, which fits the cache, and then copied into that layout.

    Attributes
    ----------
    clip : (F + 1, T, B) array
        The source, in the order of time, with ones below.
    fed : (F + 1, S + T + 1, B) array
        The frames y_0 = 0, y_1, …, y_(S+T) in the order of writing, with ones below.
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
        self.steps = burn_in + frames
        hidden, features = encoder.hidden, len(encoder.inputs_back)
        self.hidden = hidden
        batch, dtype = clips.stop - clips.start, encoder.inputs.dtype
        self._h_and_x = aligned_empty((hidden + features + 2, frames, batch), dtype)
        self._h_and_y = aligned_empty((hidden + features + 2, self.steps + 1, batch), dtype)
        self._h_and_x[[hidden, -1]] = self._h_and_y[[hidden, -1]] = 1
        self.clip, self.fed = self._h_and_x[hidden + 1 :], self._h_and_y[hidden + 1 :]
        self.reader = Recurrence(hidden, frames, self._h_and_x[: hidden + 1], training)
        self.writer = Recurrence(hidden, self.steps, self._h_and_y[: hidden + 1], training)
        self.loss, self.gradients = 0.0, dict[str, np.ndarray]()
        a = aligned_empty((3 * hidden, batch), dtype)
        s_and_frame = aligned_empty((3 * hidden + features + 1, batch), dtype)
        s, self._frame = s_and_frame[: 3 * hidden], s_and_frame[3 * hidden :]
        self._frame[features] = 1
        gates_of_a, gates_of_s = a.reshape(3, hidden, batch), s.reshape(3, hidden, batch)
        self._gates = (gates_of_a[1:], gates_of_a[0]), (gates_of_s[:2], gates_of_s[2])
        self._read_state = RowGroups(encoder.states, s)
        self._read_frame = RowGroups(encoder.inputs, a)
        self._write_frame = RowGroups(decoder.states, s_and_frame[:-1])
        self._feed_frame = RowGroups(decoder.inputs, a)
        if training:
            # Of step k: da_n, da_r, da_z, ds_n, and dy_k, the gradient of the frame it is fed.
            # Index S + T holds the dy of the last frame alone.
            rows = 4 * hidden + features
            self._gradients = aligned_empty((rows, self.steps + 1, batch), dtype)
            self._gradients[:, -1] = 0
            self._step = aligned_empty((rows, batch), dtype)
            self._parts = self._step[: 4 * hidden].reshape(4, hidden, batch)
            self._dh, self._product = aligned_empty((2, hidden, batch), dtype)
            self._dx = aligned_empty((features, batch), dtype)
            self._read_back = RowGroups(encoder.states_back, self._product)
            self._write_back = RowGroups(decoder.states_back, self._product)
            self._feed_back = RowGroups(decoder.inputs_back, self._dx)

    def read(self, x: np.ndarray) -> np.ndarray:
        """h_T of the encoder, (H, B), for its part of (B, T, F) clips."""
        self.clip[:-1] = x[self.clips].transpose(2, 1, 0)
        self.reader.start(0)
        for k in range(self.frames):
            self._frame[:-1] = self.clip[:-1, k]
            self._read_frame(self._frame)
            self._read_state(self.reader.states[k % 2])
            self.reader.step(k, *self._gates)
        return self.reader.states[self.frames % 2, :-1]

    def write(self, h0: np.ndarray) -> None:
        """Put the frames y_1 to y_(S+T) into `fed`, from the decoder's first state (H, B)."""
        y = self._frame[:-1]
        self.writer.start(h0)
        for k in range(self.steps):
            self._write_frame(self.writer.states[k % 2])
            if k == 0:  # the first input is zero, not a frame of h_0
                y[...] = 0
            self.fed[:-1, k] = y
            self._feed_frame(self._frame)
            self.writer.step(k, *self._gates)
        last = self.writer.states[self.steps % 2]
        np.matmul(self.decoder.states[3 * self.hidden :], last, out=self.fed[:-1, -1])
        self._h_and_y[: len(last), -1] = last

    def written(self) -> np.ndarray:
        """The written clips in the order of time, its part of (B, T, F)."""
        return self.fed[:-1, : self.burn_in : -1].transpose(2, 1, 0)

    def compare(self, elements: int) -> float:
        """Its part of the mean squared error; stores dy = 2 (y - x) / N for `write_pullback`.

        The frame that is written last is the clip's first; those of the burn-in are not compared.
        """
        first = 1 + self.burn_in
        self._gradients[4 * self.hidden :, :first] = 0
        dy = self._gradients[4 * self.hidden :, first:]
        np.subtract(self.fed[:-1, first:], self.clip[:-1, ::-1], out=dy)
        loss = float(np.vdot(dy, dy)) / elements
        dy *= 2 / elements
        return loss

    def write_pullback(self) -> tuple[np.ndarray, Weights]:
        """dh_0 of the decoder, (H, B), and the gradients of its weights."""
        hidden, states_back = self.hidden, self.decoder.states_back
        gradients, step, dh, product = self._gradients, self._step, self._dh, self._product
        dys, dy = gradients[4 * hidden :], step[4 * hidden :]
        np.matmul(states_back[:, 3 * hidden :], dys[:, -1], out=dh)
        for k in reversed(range(self.steps)):
            self.writer.step_pullback(k, dh, self._parts)
            self._feed_back(step[: 3 * hidden])
            np.add(dys[:, k], self._dx, dy)
            if k == 0:  # y_0 is constant
                dy[...] = 0
            self._write_back(step[hidden:])
            np.add(dh, product, dh)
            gradients[:, k] = step

        d, h_and_y = _as_matrix(gradients), _as_matrix(self._h_and_y)
        dframe = h_and_y[: hidden + 1] @ d[4 * hidden :].T
        of_gru = _named("decoder", gru_gradients(d[: 4 * hidden], h_and_y))
        return dh, {**of_gru, "frame_w": dframe[:-1], "frame_b": dframe[-1]}

    def read_pullback(self, dh_last: np.ndarray) -> Weights:
        """The gradients of the encoder's weights from dh_T, (H, B)."""
        hidden, dh, product = self.hidden, self._dh, self._product
        step, gradients = self._step[: 4 * hidden], self._gradients[: 4 * hidden, : self.frames]
        dh[...] = dh_last
        for k in reversed(range(self.frames)):
            self.reader.step_pullback(k, dh, self._parts)
            gradients[:, k] = step
            if k > 0:  # h_0 is no parameter
                self._read_back(step[hidden:])
                np.add(dh, product, dh)

        d, h_and_x = _as_matrix(gradients), _as_matrix(self._h_and_x)
        return _named("encoder", gru_gradients(d, h_and_x))


def _as_matrix(array: np.ndarray) -> np.ndarray:
    """(rows, steps, B) as (rows, steps · B): a sum over steps and clips is one product."""
    return array.reshape(len(array), -1)


def _named(gru: str, gradients: list[np.ndarray]) -> Weights:
    return {f"{gru}_{letter}": each for letter, each in zip("wubc", gradients, strict=True)}
