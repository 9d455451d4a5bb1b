"""jang2018's network at speed: `models.composed_sequence`, step for step, over `Member`s."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable

import numpy as np

from numpy_cae import ops
from numpy_cae.fast.sequence_matrices import Matrices
from numpy_cae.fast.sequence_member import Member
from numpy_cae.fast.team import Team, share, team
from numpy_cae.models.composed_sequence import Losses
from numpy_cae.models.sequence_weights import Weights

CLIPS_AT_ONCE = 128
"""Clips that one workspace holds when no gradient is wanted; more go in parts."""

UNITS_FOR_A_CLIP = 16
"""A member has at least one clip for so many hidden units. With fewer, a step of half the clips
takes far more than half the time, since all of the weights are read for it; they are then not
shared out, and BLAS shares the rows of a product among its own threads."""

NUMBERS_FOR_EACH = 1024
"""And its states have so many numbers: NumPy holds the interpreter for less than 500."""


class Workspace:
    """The matrices, and a team whose members have the clips among them."""

    def __init__(
        self, weights: Weights, batch: int, frames: int, dtype: np.dtype, kept: bool, members: Team
    ):
        features, hidden = len(weights["frame_b"]), len(weights["state_b"])
        self.team = members
        self.encoder = Matrices("encoder", features, hidden, dtype)
        self.decoder = Matrices("decoder", features, hidden, dtype)
        self.members = [
            Member(
                self.encoder,
                self.decoder,
                share(batch, number, members.size),
                frames,
                dtype,
                kept,
            )
            for number in range(members.size)
        ]

    def run(self, work: Callable[[int, Member], None]) -> None:
        """Every member does the work with its own buffers."""
        self.team.run(lambda number: work(number, self.members[number]))


class FastSequence:
    """Encodes, decodes and differentiates; owns buffers and nothing else.

    Parameters
    ----------
    threads : int, optional
        As many as BLAS would use where None.
    """

    KEPT = 4
    """Workspaces that are kept."""

    def __init__(self, threads: int | None = None):
        self._threads = threads
        self._workspaces: OrderedDict[tuple, Workspace] = OrderedDict()
        self._lock = threading.Lock()  # two callers of one model take turns with its buffers

    def __reduce__(self):
        return FastSequence, (self._threads,)  # copies and pickles begin without buffers

    def encode(self, weights: Weights, x: np.ndarray) -> np.ndarray:
        """(B, T, F) to z (B, Z)."""
        frames, dtype = x.shape[1], _dtype(weights, x)
        last = np.empty((len(x), len(weights["state_b"])), dtype)

        def encode_part(workspace: Workspace, part: slice) -> None:
            workspace.encoder.load(weights, back=False)

            def work(_: int, member: Member) -> None:
                last[part][member.clips] = member.read(x[part]).T

            workspace.run(work)

        self._in_parts(weights, len(x), frames, dtype, encode_part)
        return last @ weights["latent_w"] + weights["latent_b"]

    def decode(self, weights: Weights, z: np.ndarray, frames: int) -> np.ndarray:
        """z (B, Z) to (B, T, F)."""
        dtype = _dtype(weights, z)
        first = z @ weights["state_w"] + weights["state_b"]
        out = np.empty((len(z), frames, len(weights["frame_b"])), dtype)

        def decode_part(workspace: Workspace, part: slice) -> None:
            workspace.decoder.load(weights, back=False)

            def work(_: int, member: Member) -> None:
                member.write(first[part][member.clips].T)
                member.written(out[part])

            workspace.run(work)

        self._in_parts(weights, len(z), frames, dtype, decode_part)
        return out

    def loss_and_gradients(
        self,
        weights: Weights,
        x: np.ndarray,
        prior: np.ndarray,
        directions: np.ndarray,
        weight: float,
    ) -> tuple[Losses, Weights]:
        """mean((x̂ - x)²) + λ · sliced_wasserstein(z, prior) and its derivatives."""
        dtype = _dtype(weights, x, prior, directions)
        hidden = len(weights["state_b"])
        last, d_first = (np.empty((len(x), hidden), dtype) for _ in range(2))

        def read(_: int, member: Member) -> None:
            last[member.clips] = member.read(x).T

        with self._lock:
            workspace = self._workspace(weights, len(x), x.shape[1], dtype, True)
            workspace.encoder.load(weights, back=True)
            workspace.decoder.load(weights, back=True)
            workspace.run(read)
            z = last @ weights["latent_w"] + weights["latent_b"]
            first = z @ weights["state_w"] + weights["state_b"]
            discrepancy, prior_back = ops.sliced_wasserstein(z, prior, directions)
            dz = prior_back(weight)
            errors, parts = [0.0] * workspace.team.size, [{}] * workspace.team.size

            def write_and_go_back(number: int, member: Member) -> None:
                clips = member.clips
                member.write(first[clips].T)
                errors[number] = member.compare(x.size)
                dh, of_decoder = member.write_back()
                d_first[clips] = dh.T
                dz[clips] += d_first[clips] @ weights["state_w"].T
                of_encoder = member.read_back(weights["latent_w"] @ dz[clips].T)
                parts[number] = of_encoder | of_decoder

            workspace.run(write_and_go_back)
        sums = _sums(parts) | {
            "latent_w": last.T @ dz,
            "latent_b": dz.sum(axis=0),
            "state_w": z.T @ d_first,
            "state_b": d_first.sum(axis=0),
        }
        reconstruction, discrepancy = sum(errors), float(discrepancy)
        losses = Losses(reconstruction + weight * discrepancy, reconstruction, discrepancy)
        return losses, {name: sums[name] for name in weights}

    def _in_parts(self, weights, batch: int, frames: int, dtype, work) -> None:
        """Clips in parts that bound the memory."""
        for start in range(0, batch, CLIPS_AT_ONCE):
            part = slice(start, min(start + CLIPS_AT_ONCE, batch))
            with self._lock:
                work(self._workspace(weights, part.stop - start, frames, dtype, False), part)

    def _workspace(
        self, weights: Weights, batch: int, frames: int, dtype: np.dtype, kept: bool
    ) -> Workspace:
        members = self._team(weights, batch)
        key = (weights["frame_w"].shape, batch, frames, dtype, kept, members.size)
        if key not in self._workspaces:
            if len(self._workspaces) == self.KEPT:
                self._workspaces.popitem(last=False)
            self._workspaces[key] = Workspace(weights, batch, frames, dtype, kept, members)
        self._workspaces.move_to_end(key)
        return self._workspaces[key]

    def _team(self, weights: Weights, batch: int) -> Team:
        hidden = len(weights["state_b"])
        worth = min(batch * UNITS_FOR_A_CLIP // hidden, batch * hidden // NUMBERS_FOR_EACH)
        return team(max(1, min(team(self._threads).size, worth, batch)))


def _dtype(weights: Weights, *arrays: np.ndarray) -> np.dtype:
    return np.result_type(weights["state_w"], *arrays)


def _sums(parts: list[Weights]) -> Weights:
    """What the members found, added up in their order; the first one's arrays hold the sums."""
    sums = dict(parts[0])
    for part in parts[1:]:
        for name, gradient in part.items():
            sums[name] += gradient
    return sums
