"""`SequentialAutoencoder` at speed: its definition, step for step, over `SequenceWorker`s."""

import threading
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from numpy_cae import ops
from numpy_cae.fast.blas import one_blas_thread
from numpy_cae.fast.gru_matrices import GruMatrices
from numpy_cae.fast.sequence_worker import SequenceWorker
from numpy_cae.fast.thread_team import ThreadTeam, share, thread_team
from numpy_cae.models.sequential_autoencoder import (
    FRAMES,
    Losses,
    SequentialAutoencoder,
    Weights,
    require_clips,
    require_latent,
    require_sequence_arguments,
)

MAX_CLIPS = 128
"""Clips that one workspace holds when no gradient is computed; more go in parts."""

MIN_STATES_PER_THREAD = 2048
"""Numbers of a thread's states. With fewer, one thread alone is faster: the threads wait for the
interpreter lock, and a product of 8 columns takes as long as one of 16."""

MAX_WORKSPACES = 4
"""Workspaces that are kept."""


class SequenceWorkspace:
    """The matrices, and a team of threads with a part of the clips each."""

    def __init__(
        self,
        features: int,
        hidden: int,
        batch: int,
        frames: int,
        burn_in: int,
        dtype: np.dtype,
        training: bool,
        team: ThreadTeam,
    ):
        self.team = team
        self.encoder = GruMatrices("encoder", features, hidden, dtype)
        self.decoder = GruMatrices("decoder", features, hidden, dtype)
        gru, sizes = (self.encoder, self.decoder), (frames, burn_in)
        self.workers = [
            SequenceWorker(*gru, share(batch, number, team.size), *sizes, training)
            for number in range(team.size)
        ]

    def load(self, weights: Weights) -> None:
        """Copy the weights; two threads copy one GRU's each."""
        grus = self.encoder, self.decoder
        self.team.run(lambda n: [gru.load(weights) for gru in grus[n :: self.team.size]])

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

        def read(worker: SequenceWorker, x: np.ndarray) -> np.ndarray:
            return worker.read(x).T @ weights["latent_w"] + weights["latent_b"]

        return self._computed(x, x.shape[1], (self.latent,), read)

    def decode(self, z: np.ndarray, frames: int = FRAMES) -> np.ndarray:
        """Clips of z, as `SequentialAutoencoder.decode`."""
        weights = self.weights
        require_latent(z, frames, weights)

        def write(worker: SequenceWorker, z: np.ndarray) -> np.ndarray:
            first_states = z[worker.clips] @ weights["state_w"] + weights["state_b"]
            worker.write(first_states.T)
            return worker.written()

        return self._computed(z, frames, (frames, self.features), write)

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """The loss and its derivatives, as `SequentialAutoencoder.loss_and_gradients`."""
        weights = self.weights
        require_sequence_arguments(x, prior, weights)
        dtype = _dtype(weights, x, prior, directions)
        last_states, d_first_states = (np.empty((len(x), self.hidden), dtype) for _ in range(2))

        def read(worker: SequenceWorker) -> None:
            last_states[worker.clips] = worker.read(x).T

        with self._lock, one_blas_thread():
            workspace = self._workspace(len(x), x.shape[1], dtype, True)
            workspace.load(weights)
            workspace.run(read)
            z = last_states @ weights["latent_w"] + weights["latent_b"]
            first_states = z @ weights["state_w"] + weights["state_b"]
            distance, prior_pullback = ops.sliced_wasserstein(z, prior, directions)
            dz = prior_pullback(weight)

            def write_and_pull_back(worker: SequenceWorker) -> None:
                clips = worker.clips
                worker.write(first_states[clips].T)
                worker.loss = worker.compare(x.size)
                dh, decoder_gradients = worker.write_pullback()
                d_first_states[clips] = dh.T
                dz[clips] += d_first_states[clips] @ weights["state_w"].T
                encoder_gradients = worker.read_pullback(weights["latent_w"] @ dz[clips].T)
                worker.gradients = encoder_gradients | decoder_gradients

            workspace.run(write_and_pull_back)
            reconstruction = sum(worker.loss for worker in workspace.workers)
            sums = _sums([worker.gradients for worker in workspace.workers])
            sums |= {
                "latent_w": last_states.T @ dz,
                "latent_b": dz.sum(axis=0),
                "state_w": z.T @ d_first_states,
                "state_b": d_first_states.sum(axis=0),
            }
        discrepancy = float(distance)
        losses = Losses(reconstruction + weight * discrepancy, reconstruction, discrepancy)
        return losses, {name: sums[name] for name in weights}

    def _computed(
        self, x: np.ndarray, frames: int, shape: tuple[int, ...], compute: Callable
    ) -> np.ndarray:
        """compute(worker, part) of x, (B, *shape), in parts of a size that bounds the memory.

        It returns the result for the worker's clips.
        """
        out = np.empty((len(x), *shape), _dtype(self.weights, x))
        for start in range(0, len(x), MAX_CLIPS):
            given, taken = x[start : start + MAX_CLIPS], out[start : start + MAX_CLIPS]

            def work(worker: SequenceWorker, given=given, taken=taken) -> None:
                taken[worker.clips] = compute(worker, given)

            with self._lock, one_blas_thread():
                workspace = self._workspace(len(given), frames, out.dtype, False)
                workspace.load(self.weights)
                workspace.run(work)
        return out

    def _workspace(
        self, batch: int, frames: int, dtype: np.dtype, training: bool
    ) -> SequenceWorkspace:
        """The buffers for arguments of these sizes, from the last few that were used."""
        sizes = self.features, self.hidden, batch, frames, self.burn_in
        return self._make_workspace(*sizes, dtype, training, self._team(batch))

    def _team(self, batch: int) -> ThreadTeam:
        by_states = batch * self.hidden // MIN_STATES_PER_THREAD
        size = thread_team(self._threads).size
        return thread_team(max(1, min(size, by_states, batch)))


def _dtype(weights: Weights, *arrays: np.ndarray) -> np.dtype:
    return np.result_type(weights["state_w"], *arrays)


def _sums(parts: list[Weights]) -> Weights:
    """The workers' gradients added up in their order; the first worker's arrays hold the sums."""
    sums = dict(parts[0])
    for part in parts[1:]:
        for name, gradient in part.items():
            sums[name] += gradient
    return sums
