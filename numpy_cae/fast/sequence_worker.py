"""One thread's clips, or its units of all clips, through both GRUs and back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from numpy_cae.fast.gru_matrices import INPUT_GATES, STATE_GATES, GruMatrices
from numpy_cae.fast.recurrence import Recurrence
from numpy_cae.models.sequential_autoencoder import Weights

BIASES = {f"{gru}_{w}": f"{gru}_{b}" for gru in ("encoder", "decoder") for w, b in ("wb", "uc")}
BIASES["frame_w"] = "frame_b"
"""The bias beside each matrix that a product with states or frames ends in."""


class Sizes(NamedTuple):
    """Of a network and a batch; the decoder makes `burn_in` steps before the `frames` of a clip."""

    features: int
    hidden: int
    frames: int
    burn_in: int


class ClipBuffers:
    """What the workers on the same `clips` of a batch share: `read` and `written`, the states of
    both GRUs (see `Recurrence`); `rows`, those of either as (H + 1, (steps + 1) · B), so that a sum
    over steps and clips is one product; `sums`, the gradients of each matrix by name, with that of
    the bias beside it as the last row."""

    def __init__(self, sizes: Sizes, clips: slice, dtype: np.dtype, training: bool):
        self.sizes, self.clips, self.sums = sizes, clips, dict[str, np.ndarray]()
        self.workers: list[SequenceWorker] = []
        hidden, batch, steps = sizes.hidden, clips.stop - clips.start, sizes.frames + sizes.burn_in
        self.read = np.zeros((sizes.frames + 1, hidden + 1, batch), dtype)
        self.written = np.zeros((steps + 1, hidden + 1, batch), dtype)
        self.read[:, hidden] = self.written[:, hidden] = 1
        self.rows = np.empty((hidden + 1, (steps + 1) * batch if training else 0), dtype)

    def new_sums(self, weights: Weights) -> None:
        """Other arrays than those that the last caller got."""
        for name in BIASES:
            height, width = weights[name].shape
            self.sums[name] = np.empty((height + 1, width), self.rows.dtype)

    def gradients(self) -> Weights:
        """By the names of the weights."""
        biases = {BIASES[name]: each[-1] for name, each in self.sums.items()}
        return {name: each[:-1] for name, each in self.sums.items()} | biases


class SequenceWorker:
    """Computes the units `parts[part]` of the clips of `shared`; H is the number of these units.

    `wait` waits for the workers of the other parts. `clip` is the source in the order of time,
    (T, F + 1, B), `fed` are the frames y_0 = 0, y_1, … in the order of writing, (steps + 1, F + 1,
    B), each with a row of ones below.
    """

    def __init__(
        self,
        shared: ClipBuffers,
        parts: Sequence[slice],
        part: int,
        wait: Callable[[], None],
        training: bool,
    ):
        shared.workers.append(self)
        self.shared, self.sizes, self.clips, self.wait = shared, shared.sizes, shared.clips, wait
        (features, _, frames, burn_in), dtype = shared.sizes, shared.read.dtype
        self.part, self.units = part, parts[part]
        self.encoder = GruMatrices("encoder", features, parts, part, dtype)
        self.decoder = GruMatrices("decoder", features, parts, part, dtype)
        self.reader = Recurrence(shared.read, self.units, training)
        self.writer = Recurrence(shared.written, self.units, training)
        hidden, steps = self.units.stop - self.units.start, frames + burn_in
        batch = self.clips.stop - self.clips.start
        self.hidden, self.steps, self.loss = hidden, steps, 0.0
        self.clip = np.ones((frames, features + 1, batch), dtype)
        self.fed = np.ones((steps + 1, features + 1, batch), dtype)
        self.fed[0, :features] = 0
        self._products = np.empty((3 * hidden + features, batch), dtype)
        self._a = np.empty((3 * hidden, batch), dtype)
        self._tall = np.empty((frames, 3 * hidden, batch), dtype)
        if training:
            # Of step k: da_n, da_z, da_r, ds_n, and dy_k, the gradient of the frame it is fed.
            # The last index holds the dy of the last frame alone.
            self.gradients = np.zeros((steps + 1, 4 * hidden + features, batch), dtype)
            self._parts = [each[: 4 * hidden].reshape(4, hidden, batch) for each in self.gradients]
            self._rows = np.empty((4 * hidden + 2 * features + 1, (steps + 1) * batch), dtype)
            self._dh, self._product = np.empty((2, hidden, batch), dtype)
            self.dx = np.empty((steps, features, batch), dtype)

    def read(self, x: np.ndarray) -> np.ndarray:
        """h_T of the encoder, (all units, B), for its part of (B, T, F) clips."""
        self.clip[:, :-1] = x[self.clips].transpose(1, 2, 0)
        np.matmul(self.encoder.inputs, self.clip, out=self._tall)
        s = self._products[: 3 * self.hidden]
        for k in range(self.sizes.frames):
            np.matmul(self.encoder.states, self.shared.read[k], out=s)
            self.reader.step(k, self._split(self._tall[k], 1), self._split(s, 0))
            self.wait()
        return self.shared.read[-1, :-1]

    def write(self, h0: np.ndarray) -> None:
        """Compute the frames from the decoder's first state, (all units, B)."""
        states, gates = self.shared.written, 3 * self.hidden
        states[0, self.units] = h0[self.units]
        self.wait()
        s_and_y, a = self._products, self._a
        split_s, split_a = self._split(s_and_y[:gates], 0), self._split(a, 1)
        y = s_and_y[gates:]
        for k in range(self.steps):
            np.matmul(self.decoder.states, states[k], out=s_and_y)
            if k > 0:  # the first input is zero, not a frame of h_0
                self.fed[k, :-1] = y
            np.matmul(self.decoder.inputs, self.fed[k], out=a)
            self.writer.step(k, split_a, split_s)
            self.wait()
        np.matmul(self.decoder.states[gates:], states[-1], out=y)
        self.fed[-1, :-1] = y

    def copy_clips(self, out: np.ndarray) -> None:
        """Put the written clips, in the order of time, into its part of (B, T, F)."""
        out[self.clips] = self.fed[: self.sizes.burn_in : -1, :-1].transpose(2, 0, 1)

    def compare(self, elements: int) -> None:
        """Its part of the mean squared error; stores dy = 2 (y - x) / N for `write_pullback`.

        The frame that is written last is the clip's first; those of the burn-in are not compared.
        """
        first = 1 + self.sizes.burn_in
        dy = self.gradients[:, 4 * self.hidden :]
        dy[:first] = 0
        np.subtract(self.fed[first:, :-1], self.clip[::-1, :-1], out=dy[first:])
        self.loss = float(np.vdot(dy, dy)) / elements
        dy *= 2 / elements

    def write_pullback(self) -> np.ndarray:
        """dh_0 of the decoder, (H, B); computes the gradients of its weights."""
        hidden, own = self.hidden, self.decoder.states_back[self.part]
        np.matmul(own[:, 3 * hidden :], self.gradients[-1, 4 * hidden :], out=self._dh)
        for k in reversed(range(self.steps)):
            self.writer.step_pullback(k, self._dh, self._parts[k])
            step = self.gradients[k]
            np.matmul(self.decoder.inputs_back, step[: 3 * hidden], out=self.dx[k])
            self.wait()
            if k > 0:  # y_0 is constant
                for worker in self.shared.workers:
                    step[4 * hidden :] += worker.dx[k]
            self._through_states(self.decoder, k)

        d, y = self._in_rows(self.gradients, self.fed)
        h, rows = self._states_in_rows(self.shared.written)
        sums = self.shared.sums
        self.decoder.gates_gradient(y, d, INPUT_GATES, sums["decoder_w"])
        self.decoder.gates_gradient(h, d[hidden:], STATE_GATES, sums["decoder_u"])
        np.matmul(h[rows], d[4 * hidden :].T, out=sums["frame_w"][rows])
        return self._dh

    def read_pullback(self, dh_last: np.ndarray) -> None:
        """Compute the gradients of the encoder's weights from dh_T, (H, B)."""
        frames, hidden, sums = self.sizes.frames, self.hidden, self.shared.sums
        self._dh[...] = dh_last
        for k in reversed(range(frames)):
            self.reader.step_pullback(k, self._dh, self._parts[k])
            if k > 0:  # h_0 is no parameter
                self.wait()
                self._through_states(self.encoder, k)

        d, x = self._in_rows(self.gradients[:frames, : 4 * hidden], self.clip)
        h, _ = self._states_in_rows(self.shared.read[:frames])
        self.encoder.gates_gradient(x, d, INPUT_GATES, sums["encoder_w"])
        self.encoder.gates_gradient(h, d[hidden:], STATE_GATES, sums["encoder_u"])

    def _through_states(self, gru: GruMatrices, k: int) -> None:
        """Add to dh what reaches it through the products of step k with all parts' units."""
        for worker, matrix in zip(self.shared.workers, gru.states_back, strict=True):
            rows = slice(worker.hidden, worker.hidden + matrix.shape[1])
            np.matmul(matrix, worker.gradients[k, rows], out=self._product)
            np.add(self._dh, self._product, self._dh)

    def _split(self, gates: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray]:
        """(3H, B) as update and reset, (2, H, B), which start at gate `first`, and new, (H, B)."""
        parts = gates.reshape(3, self.hidden, -1)
        return parts[first : first + 2], parts[2 - 2 * first]

    def _states_in_rows(self, states: np.ndarray) -> tuple[np.ndarray, slice]:
        """The states of all units as (all units + 1, T · B), and which rows of it are this part's;
        the last part has the row of ones."""
        frames, height, batch = states.shape
        last = self.units.stop == height - 1
        own = slice(self.units.start, height if last else self.units.stop)
        rows = self.shared.rows[:, : frames * batch]
        rows[own].reshape(-1, frames, batch)[...] = states[:, own].transpose(1, 0, 2)
        self.wait()
        return rows, own

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
