"""A trained convolutional autoencoder with the normalisation of its input: the motion manifold."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.manifold.blind import project_shifted, zeroed_fraction
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.body import Body
from numpy_cae.motion.features import RootTransform, positions_to_features
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.windows import LENGTH

Network = TypeVar("Network")


def with_engine(network: Network, engine: str) -> Network:
    """The network: accelerated by `numpy_cae.fast` if `engine` is "fast", plain if it is "ops"."""
    if engine not in ("fast", "ops"):
        raise ValueError(f"engine is {engine!r}, expected 'fast' or 'ops'")
    return accelerate(network) if engine == "fast" else network


@dataclass
class MotionManifold:
    """A network, and the conversion between features of motions and its normalised input.

    Parameters
    ----------
    network : ConvAutoencoder
        Plain or accelerated; everything is computed with it.
    mean_pose : (63,) array of float64
        Subtracted from every frame of features (holden2015, section 4).
    scale : (63,) array of float64
        Multiplies the difference: one factor each for positions, velocity and turn.
    lengths : (20,) array of float64
        Bone lengths of the mean skeleton, metres.
    rate : float
        Frames a second.
    settings : dict
        Provenance (data, schedule, seed, losses) in JSON types; nothing is computed from it.
    rescales : bool
        Whether the network was trained on X_c / (1 - p): see `training.corruption`.
    window : int
        Frames of the windows that the network was trained on.
    """

    network: ConvAutoencoder
    mean_pose: np.ndarray
    scale: np.ndarray
    lengths: np.ndarray
    rate: float = 30.0
    settings: dict = field(default_factory=dict)
    rescales: bool = False
    window: int = LENGTH

    def body(self, motion: Motion, mapping: dict[str, str] | None = None) -> Body:
        """A motion of any rig with its features on this manifold's mean skeleton."""
        return Body(motion, self.lengths, mapping)

    def features(self, positions: np.ndarray) -> tuple[np.ndarray, RootTransform]:
        """Features (F, 63) on the mean skeleton, and the root transform of the first frame, of
        world positions (F, 20, 3) in metres at `rate`, on bones of any lengths."""
        normalised = change_lengths(positions, bone_lengths(positions), self.lengths)
        return positions_to_features(normalised, self.rate)

    def normalise(self, features: np.ndarray) -> np.ndarray:
        """X of features (…, 63): the mean pose subtracted, scaled, in the dtype of the network."""
        return ((features - self.mean_pose) * self.scale).astype(self.network.layers[0].w.dtype)

    def denormalise(self, x: np.ndarray) -> np.ndarray:
        """The features of which `normalise` makes x, float64."""
        return x.astype(np.float64) / self.scale + self.mean_pose

    @property
    def reach(self) -> int:
        """Frames on either side of its own that influence a unit of the top layer."""
        return sum(len(layer.w) // 2 * 2**k for k, layer in enumerate(self.network.layers))

    @property
    def shifts(self) -> int:
        """Number of different positions of the pooling grid, the most that `project` averages."""
        return self.network.frames_per_unit

    def encode(self, features: np.ndarray) -> np.ndarray:
        """Y = Φ(X) of a clip of any length, (F, 63) to (⌈(F + 2 · reach) / 8⌉, 256) in [-1, 1].

        The zeros with which a convolution pads a clip are the mean pose and would distort its ends.
        So the first and last frame are held for `reach` frames; `decode` removes these again.
        """
        return self.network.encode(self._padded(features))[0]

    def decode(self, y: np.ndarray, frames: int) -> np.ndarray:
        """Φ†(Y), (frames, 63) of float64, of what `encode` returned for a clip of that length."""
        return self.denormalise(self.network.decode(y[None])[0])[self.reach : self.reach + frames]

    def project(self, features: np.ndarray, shifts: int = 1) -> np.ndarray:
        """Φ†(Φ(X)) of a clip of any length, (F, 63) to (F, 63) of float64, the mean over so many
        positions of the pooling grid (`manifold.blind.project_shifted`)."""
        projected = project_shifted(self.network, self._padded(features), shifts)[0]
        return self.denormalise(projected)[self.reach : self.reach + len(features)]

    def project_windows(self, x: np.ndarray, shifts: int = 1) -> np.ndarray:
        """Φ†(Φ(X)) of normalised windows (N, T, 63) as in training, with zeros around them."""
        return project_shifted(self.network, self._rescaled(x), shifts)

    def _padded(self, features: np.ndarray) -> np.ndarray:
        """A clip as one normalised window, its first and last frame held for `reach` frames."""
        more = -(len(features) + 2 * self.reach) % self.network.frames_per_unit
        ends = ((0, 0), (self.reach, self.reach + more), (0, 0))
        return np.pad(self._rescaled(self.normalise(features)[None]), ends, mode="edge")

    def _rescaled(self, x: np.ndarray) -> np.ndarray:
        """X_c / (1 - p̂) if the network was trained on such input; p̂ is estimated from x."""
        return x / (1 - zeroed_fraction(x)) if self.rescales else x
