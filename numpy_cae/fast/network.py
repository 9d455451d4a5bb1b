"""Equation 3 at speed: `models.composed`, step for step, over a `Workspace`.

Each method describes what one member of the team does, and runs it on all of them.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Sequence

import numpy as np

from numpy_cae.fast.team import Team, team
from numpy_cae.fast.workspace import Member, Workspace
from numpy_cae.models.composed import Gradients, Objective
from numpy_cae.models.conv_layer import ConvLayer

FRAMES_AT_ONCE = 16 * 160
"""Frames that one workspace holds when no gradient is wanted; longer input goes in parts. (With
four times as many the buffers no longer fit the cache, and a window takes a fifth longer.)"""

WINDOWS_FOR_EACH = 2
"""Fewer windows are not shared out. (Threads that share the rows s of y = C ((A x) ∘ ŵ)
for one window, and add up their parts of y, took two thirds more of the processor's time.)"""

WORTH_SHARING = 10_000_000
"""Multiplications of a direct convolution below which threads cost more than they save."""


class FastNetwork:
    """Encodes, decodes and differentiates a stack of `ConvLayer`; owns buffers and nothing else.

    Parameters
    ----------
    threads : int, optional
        As many as BLAS would use where None.
    """

    KEPT = 4
    """Workspaces that are kept: training has two sizes of batch, since the last is smaller."""

    def __init__(self, threads: int | None = None):
        self._threads = threads
        self._workspaces: OrderedDict[tuple, Workspace] = OrderedDict()
        self._lock = threading.Lock()  # two callers of one model take turns with its buffers

    def __reduce__(self):
        return FastNetwork, (self._threads,)  # copies and pickles begin without buffers

    def encode(self, layers: Sequence[ConvLayer], x: np.ndarray) -> np.ndarray:
        """Φ: (B, T, C) to (B, T / 2^layers, D)."""
        batch, frames, _ = x.shape
        out = np.empty((batch, frames >> len(layers), layers[-1].b.size), _dtype(layers, x))

        def encode_part(workspace: Workspace, part: slice, again: bool) -> None:
            def work(member: Member) -> None:
                self._up(layers, member, x[part])
                _copy_windows(member.top, out[part][member.windows])

            workspace.run(layers, work, again)

        self._in_parts(layers, batch, frames, out.dtype, encode_part)
        return out

    def decode(self, layers: Sequence[ConvLayer], y: np.ndarray) -> np.ndarray:
        """Φ†, unpooling evenly: (B, t, D) to (B, t · 2^layers, C)."""
        batch, frames = len(y), y.shape[1] << len(layers)
        out = np.empty((batch, frames, layers[0].w.shape[1]), _dtype(layers, y))

        def decode_part(workspace: Workspace, part: slice, again: bool) -> None:
            def work(member: Member) -> None:
                _place_windows(y[part][member.windows], member.top)
                decoded = self._down(layers, member, [None] * len(layers))
                _copy_windows(decoded, out[part][member.windows])

            workspace.run(layers, work, again)

        self._in_parts(layers, batch, frames, out.dtype, decode_part)
        return out

    def latent_gradient(
        self, layers: Sequence[ConvLayer], y: np.ndarray, objective: Objective
    ) -> tuple[float, np.ndarray]:
        """L(Φ†(Y)) and dL/dY; the first member asks the objective for all of them."""
        batch, frames = len(y), y.shape[1] << len(layers)
        dtype = _dtype(layers, y)
        x_hat = np.empty((batch, frames, layers[0].w.shape[1]), dtype)
        dy = np.empty_like(y, dtype)
        answer = []

        def work(member: Member) -> None:
            _place_windows(y[member.windows], member.top)
            decoded = self._down(layers, member, [None] * len(layers))
            _copy_windows(decoded, x_hat[member.windows])
            workspace.team.wait(member.number)
            if member.number == 0:
                answer.extend(objective(x_hat))
            workspace.team.wait(member.number)
            _place_windows(answer[1][member.windows], member.layers[0].convolution.error)
            self._down_back(member)
            _copy_windows(member.d_top, dy[member.windows])

        with self._lock:
            halved = _halved(layers, None)
            workspace = self._workspace(layers, batch, frames, dtype, halved, False)
            workspace.run(layers, work)
        return answer[0], dy

    def loss_and_gradients(
        self,
        layers: Sequence[ConvLayer],
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float,
        first: Sequence[np.ndarray] | None,
    ) -> tuple[float, Gradients]:
        """Loss = mean((x - Φ†(Φ(x_c)))²) + α mean(|Φ(x_c)|) and its derivatives."""
        batch, frames, _ = x.shape
        dtype = _dtype(layers, x, corrupted)
        dws = [np.empty(layer.w.shape, dtype) for layer in layers]

        def work(member: Member) -> None:
            self._up(layers, member, corrupted)
            decoded = self._down(layers, member, _masks(member, first, len(layers)))
            member.loss = _error(member, decoded, x)
            self._down_back(member)
            member.loss += _activity(member, alpha, batch)
            self._up_back(member)
            workspace.filters_gradient(member, dws)

        with self._lock:
            workspace = self._workspace(layers, batch, frames, dtype, _halved(layers, first), True)
            workspace.run(layers, work)
            members = workspace.members
            dbs = [sum(member.db[k] for member in members) for k in range(len(layers))]
            loss = sum(float(member.loss) for member in members)
        return loss, list(zip(dws, dbs, strict=True))

    def _up(self, layers: Sequence[ConvLayer], member: Member, x: np.ndarray) -> None:
        _place_windows(x[member.windows], member.layers[0].convolution.x)
        for fast, layer in zip(member.layers, layers, strict=True):
            fast.up(layer.b)

    def _down(self, layers, member: Member, masks) -> np.ndarray:
        decoded = member.top
        for fast, layer, mask in reversed(list(zip(member.layers, layers, masks, strict=True))):
            decoded = fast.down(decoded, layer.b, mask)
        return decoded

    def _down_back(self, member: Member) -> None:
        """From dx̂ of the lowest layer to d_top; each layer's dy is the dx̂ of the one above."""
        places = [fast.convolution.error for fast in member.layers[1:]] + [member.d_top]
        for fast, db, place in zip(member.layers, member.db, places, strict=True):
            fast.down_back(db, place)

    def _up_back(self, member: Member) -> None:
        """From d_top downwards. The lowest layer's input is data: nobody asks for its gradient."""
        d = member.d_top
        for k in reversed(range(len(member.layers))):
            d = member.layers[k].up_back(d, member.db[k], wanted=k > 0)

    def _in_parts(self, layers, batch: int, frames: int, dtype, work) -> None:
        """Windows in parts that bound the memory, none where there is nothing in them."""
        at_once = max(1, FRAMES_AT_ONCE // max(frames, 1))
        halved = _halved(layers, None)
        last = None
        with self._lock:
            for start in range(0, batch if frames else 0, at_once):
                part = slice(start, min(start + at_once, batch))
                size = part.stop - start
                workspace = self._workspace(layers, size, frames, dtype, halved, False)
                work(workspace, part, again=workspace is last)
                last = workspace

    def _workspace(
        self,
        layers: Sequence[ConvLayer],
        batch: int,
        frames: int,
        dtype: np.dtype,
        halved: tuple[bool, ...],
        training: bool,
    ) -> Workspace:
        shapes = tuple((layer.w.shape, layer.bound) for layer in layers)
        members = self._team(layers, batch, frames)
        key = (shapes, batch, frames, dtype, halved, members.size, training)
        if key not in self._workspaces:
            if len(self._workspaces) == self.KEPT:
                self._workspaces.popitem(last=False)
            self._workspaces[key] = Workspace(
                layers, batch, frames, dtype, halved, members, training
            )
        self._workspaces.move_to_end(key)
        return self._workspaces[key]

    def _team(self, layers: Sequence[ConvLayer], batch: int, frames: int) -> Team:
        work = sum(batch * (frames >> k) * layer.w.size for k, layer in enumerate(layers))
        size = team(self._threads).size
        return team(max(1, min(size, batch // WINDOWS_FOR_EACH)) if work >= WORTH_SHARING else 1)


def _dtype(layers: Sequence[ConvLayer], *arrays: np.ndarray) -> np.dtype:
    return np.result_type(*arrays, *(layer.w for layer in layers))


def _halved(layers: Sequence[ConvLayer], first: Sequence | None) -> tuple[bool, ...]:
    """For each layer, whether it is unpooled evenly."""
    return tuple(mask is None for mask in (first or [None] * len(layers)))


def _windows(member: Member) -> int:
    return member.windows.stop - member.windows.start


def _place_windows(x: np.ndarray, rows: np.ndarray) -> None:
    """(B, T, C) into (T, B·C)."""
    batch, frames, channels = x.shape
    rows.reshape(frames, batch, channels)[...] = x.transpose(1, 0, 2)


def _copy_windows(rows: np.ndarray, x: np.ndarray) -> None:
    """(T, B·C) into (B, T, C)."""
    batch, frames, channels = x.shape
    x[...] = rows.reshape(frames, batch, channels).transpose(1, 0, 2)


def _masks(member: Member, first: Sequence[np.ndarray] | None, layers: int) -> list:
    """The member's part of each mask, as rows of frames."""
    if first is None:
        return [None] * layers
    own = [None if mask is None else mask[member.windows] for mask in first]
    return [
        None if mask is None else mask.transpose(1, 0, 2).reshape(mask.shape[1], -1) for mask in own
    ]


def _error(member: Member, decoded: np.ndarray, x: np.ndarray) -> float:
    """The member's part of the mean squared error; leaves dx̂ = 2 (x̂ - x) / N where it is used.

    `decoded` is overwritten.
    """
    error = member.layers[0].convolution.error
    batch, frames, channels = x[member.windows].shape
    shape = frames, batch, channels
    own = x[member.windows].transpose(1, 0, 2)
    np.subtract(decoded.reshape(shape), own, out=error.reshape(shape))
    loss = float(np.multiply(error, error, out=decoded).sum()) / x.size
    error *= 2 / x.size
    return loss


def _activity(member: Member, alpha: float, batch: int) -> float:
    """The member's part of α mean(|y|); adds its gradient, α sign(y) / N, to dy."""
    if alpha == 0:
        return 0.0
    y = member.top
    weight = alpha / (y.size // _windows(member) * batch)
    member.d_top += weight * np.sign(y)
    return weight * float(np.abs(y).sum())
