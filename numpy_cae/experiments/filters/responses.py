"""What a filter adds to a motion: the decoder's response to one hidden unit, of any layer.

A filter of the first layer can be drawn as it is, 15 frames of 63 features; a filter of an upper
layer cannot. So at one moment a unit is raised from its mean to its 99th percentile, and the layers
below decode the difference, with tanh⁻¹ and its bound.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.models import ConvLayer
from numpy_cae.motion import JOINTS, PARENTS, POSITIONS

_SILENT = 1e-8


@dataclass(frozen=True)
class Responses:
    """What each filter of a layer adds: `added` (filters, frames, 63), in normalised features."""

    added: np.ndarray

    @property
    def active(self) -> np.ndarray:
        """(filters,) bool: whether a filter adds anything. Other methods leave out those that
        do not."""
        return np.square(self.added).sum(axis=(1, 2)) > _SILENT

    def by_joint(self) -> np.ndarray:
        """The share of a filter's energy in each joint and in the path, (filters, 21)."""
        energy = np.square(self.added[self.active], dtype=np.float64).sum(axis=1)
        joints = energy[:, POSITIONS].reshape(len(energy), len(JOINTS), 3).sum(axis=-1)
        path = energy[:, POSITIONS.stop :].sum(axis=-1, keepdims=True)
        return np.concatenate([joints, path], axis=1) / energy.sum(axis=1, keepdims=True)

    def joints(self) -> np.ndarray:
        """The effective number of joints that a filter moves, (filters,)."""
        return _effective_number(self.by_joint()[:, : len(JOINTS)])

    def frames(self) -> np.ndarray:
        """The effective number of frames that a filter lasts, (filters,)."""
        return _effective_number(np.square(self.added[self.active], dtype=np.float64).sum(axis=2))

    def temporal(self) -> np.ndarray:
        """A filter's correlation, about zero, with itself a frame later, (filters,)."""
        added = self.added[self.active].astype(np.float64)
        now, later = added[:, :-1], added[:, 1:]
        together = np.square(now).sum(axis=(1, 2)) * np.square(later).sum(axis=(1, 2))
        return (now * later).sum(axis=(1, 2)) / np.sqrt(together)

    def between_joints(self) -> np.ndarray:
        """Mean absolute cosine of a joint's movement over time and its parent's, (filters,)."""
        added = self.added[self.active, :, POSITIONS].astype(np.float64)
        joints = added.reshape(*added.shape[:2], len(JOINTS), 3)
        unit = joints / np.linalg.norm(joints, axis=(1, 3), keepdims=True)
        cosines = (unit[:, :, 1:] * unit[:, :, list(PARENTS[1:])]).sum(axis=(1, 3))
        return np.abs(cosines).mean(axis=1)


def _effective_number(energy: np.ndarray) -> np.ndarray:
    """(Σ e)² / Σ e² along the second axis: n where n are equal and the others zero."""
    squares = np.square(energy).sum(axis=1)
    total = energy.sum(axis=1)
    return np.divide(total**2, squares, out=np.zeros_like(total), where=squares > 0)


def responses_of(layers: Sequence[ConvLayer], units: np.ndarray) -> Responses:
    """Raise each unit of the last of the layers (lowest first) and decode through all of them.

    `units` (N, k), its values in many frames, give the means and percentiles.
    """
    reach = sum(len(layer.w) // 2 * 2**n for n, layer in enumerate(layers))
    middle = -(-reach // 2 ** len(layers))
    mean, high = units.mean(axis=0), np.quantile(units, 0.99, axis=0)
    still = np.repeat(mean[None], 2 * middle + 1, axis=0)
    raised = np.repeat(still[None], units.shape[1], axis=0)
    filters = np.arange(units.shape[1])
    raised[filters, middle, filters] = high
    return Responses(decoded(layers, raised) - decoded(layers, still[None]))


def decoded(layers: Sequence[ConvLayer], units: np.ndarray) -> np.ndarray:
    """Down through the layers with even unpooling: (B, i, k) to (B, F, 63)."""
    dtype = layers[0].w.dtype
    for layer in reversed(layers):
        units, _ = layer.decode_with_pullback(units.astype(dtype))
    return units


def encoded(layers: Sequence[ConvLayer], x: np.ndarray) -> list[np.ndarray]:
    """The hidden units of every layer, (B, T, 63) to (B, T/2, k), …"""
    every = []
    for layer in layers:
        x, _ = layer.encode_with_pullback(x)
        every.append(x)
    return every
