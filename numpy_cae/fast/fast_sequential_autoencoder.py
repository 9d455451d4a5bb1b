"""`SequentialAutoencoder` at speed: its definition, step for step, over `SequenceWorker`s."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np

from numpy_cae import ops
from numpy_cae.fast.sequence_worker import ClipBuffers, SequenceWorker, Sizes
from numpy_cae.fast.thread_team import ThreadTeam, share, thread_team
from numpy_cae.models.arguments import require_clips, require_latent, require_sequence_arguments
from numpy_cae.models.sequential_autoencoder import (
    FRAMES,
    Losses,
    SequentialAutoencoder,
    Weights,
)

MAX_CLIPS = 128
"""Clips that one workspace holds when no gradient is computed; more go in parts."""

MIN_DIVIDED_UNITS = 256
"""With so many hidden units the threads divide the units, else the clips. A step of half the clips
takes more than half the time, since it reads all of the weights; but threads that divide the units
wait for each other at every step."""

MIN_STATES_PER_THREAD = 1024
"""Numbers of a thread's states: NumPy keeps the interpreter lock for less than 500."""

MAX_WORKSPACES = 4  # that are kept


class SequenceWorkspace:
    """A team of threads with buffers; each has some clips or, of a large network, some units."""

    def __init__(self, sizes: Sizes, batch: int, dtype: np.dtype, training: bool, team: ThreadTeam):
        self.team, together = team, thread_team(1)  # the threads that work on the same clips
        if sizes.hidden >= MIN_DIVIDED_UNITS:
            together = team
        parts = [share(sizes.hidden, number, together.size) for number in range(together.size)]
        groups = team.size // together.size
        self.buffers = [
            ClipBuffers(sizes, share(batch, group, groups), dtype, training)
            for group in range(groups)
        ]
        self.workers = [
            SequenceWorker(shared, parts, part, partial(together.wait, part), training)
            for shared in self.buffers
            for part in range(together.size)
        ]

    def run(self, work: Callable[[SequenceWorker], None]) -> None:
        """Call work(worker) for every worker."""
        self.team.run(lambda number: work(self.workers[number]))


class FastSequentialAutoencoder(SequentialAutoencoder):
    """The methods of a `SequentialAutoencoder` on its own weights.

    `encode_with_pullback` and `decode_with_pullback` are those of the definition.

    See `accelerate` for the parameters. `weights` is the model's own dict.
    """

    def __init__(self, model: SequentialAutoencoder, threads: int | None = None):
        self.weights, self.burn_in = model.weights, model.burn_in
        self._model, self._threads = model, threads
        self._make_workspace = lru_cache(MAX_WORKSPACES)(SequenceWorkspace)
        self._lock = threading.Lock()  # several threads may call one model: one uses its buffers

    def __reduce__(self):
        return type(self), (self._model, self._threads)  # copies and pickles start without buffers

    def encode(self, x: np.ndarray) -> np.ndarray:
        """z of clips, as `SequentialAutoencoder.encode`."""
        weights = self.weights
        require_clips("x", x, weights)
        frames, dtype = x.shape[1], np.result_type(weights["state_w"], x)
        last_states = np.empty((len(x), self.hidden), dtype)

        def encode_part(workspace: SequenceWorkspace, part: slice) -> None:
            def work(worker: SequenceWorker) -> None:
                worker.encoder.load(weights, back=False)
                last_states[part][worker.clips] = worker.read(x[part]).T

            workspace.run(work)

        self._in_parts(len(x), frames, dtype, encode_part)
        return last_states @ weights["latent_w"] + weights["latent_b"]

    def decode(self, z: np.ndarray, frames: int = FRAMES) -> np.ndarray:
        """Clips of z, as `SequentialAutoencoder.decode`."""
        weights = self.weights
        require_latent(z, frames, weights)
        dtype = np.result_type(weights["state_w"], z)
        first_states = z @ weights["state_w"] + weights["state_b"]
        out = np.empty((len(z), frames, self.features), dtype)

        def decode_part(workspace: SequenceWorkspace, part: slice) -> None:
            def work(worker: SequenceWorker) -> None:
                worker.decoder.load(weights, back=False)
                worker.write(first_states[part][worker.clips].T)
                worker.copy_clips(out[part])

            workspace.run(work)

        self._in_parts(len(z), frames, dtype, decode_part)
        return out

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """The loss and its derivatives, as `SequentialAutoencoder.loss_and_gradients`."""
        weights = self.weights
        require_sequence_arguments(x, prior, weights)
        dtype = np.result_type(weights["state_w"], x, prior, directions)
        last_states, d_first_states = (np.empty((len(x), self.hidden), dtype) for _ in range(2))

        def read(worker: SequenceWorker) -> None:
            worker.encoder.load(weights, back=True)
            worker.decoder.load(weights, back=True)
            last_states[worker.clips] = worker.read(x).T

        with self._lock:
            workspace = self._workspace(len(x), x.shape[1], dtype, True)
            for buffers in workspace.buffers:
                buffers.new_sums(weights)
            workspace.run(read)
            z = last_states @ weights["latent_w"] + weights["latent_b"]
            first_states = z @ weights["state_w"] + weights["state_b"]
            distance, prior_pullback = ops.sliced_wasserstein(z, prior, directions)
            dz_prior = prior_pullback(weight)
            dz = np.empty_like(dz_prior)

            def write_and_pull_back(worker: SequenceWorker) -> None:
                clips, units = worker.clips, worker.units
                worker.write(first_states[clips].T)
                worker.compare(x.size)
                d_first_states[clips, units] = worker.write_pullback().T
                worker.wait()
                dz[clips] = dz_prior[clips] + d_first_states[clips] @ weights["state_w"].T
                worker.read_pullback(weights["latent_w"][units] @ dz[clips].T)

            workspace.run(write_and_pull_back)
            reconstruction = sum(buffers.workers[0].loss for buffers in workspace.buffers)
            sums = _sums([buffers.gradients() for buffers in workspace.buffers])
        sums |= {
            "latent_w": last_states.T @ dz,
            "latent_b": dz.sum(axis=0),
            "state_w": z.T @ d_first_states,
            "state_b": d_first_states.sum(axis=0),
        }
        losses = Losses(reconstruction + weight * float(distance), reconstruction, float(distance))
        return losses, {name: sums[name] for name in weights}

    def _in_parts(
        self,
        batch: int,
        frames: int,
        dtype: np.dtype,
        work: Callable[[SequenceWorkspace, slice], None],
    ) -> None:
        """Call `work` on parts of the clips that bound the memory."""
        for start in range(0, batch, MAX_CLIPS):
            part = slice(start, min(start + MAX_CLIPS, batch))
            with self._lock:
                work(self._workspace(part.stop - start, frames, dtype, False), part)

    def _workspace(
        self, batch: int, frames: int, dtype: np.dtype, training: bool
    ) -> SequenceWorkspace:
        """The buffers for arguments of these sizes, from the last few that were used."""
        sizes = Sizes(self.features, self.hidden, frames, self.burn_in)
        return self._make_workspace(sizes, batch, dtype, training, self._team(batch))

    def _team(self, batch: int) -> ThreadTeam:
        by_states = batch * self.hidden // MIN_STATES_PER_THREAD
        by_items = self.hidden if self.hidden >= MIN_DIVIDED_UNITS else batch
        return thread_team(max(1, min(thread_team(self._threads).size, by_states, by_items)))


def _sums(parts: list[Weights]) -> Weights:
    """The workers' gradients added up in their order; the first worker's arrays hold the sums."""
    sums = dict(parts[0])
    for part in parts[1:]:
        for name, gradient in part.items():
            sums[name] += gradient
    return sums
