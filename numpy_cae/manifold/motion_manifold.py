"""A trained convolutional autoencoder with the normalisation of its input: the motion manifold."""

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.manifold.shifted_projection import project_shifted, zeroed_fraction
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.features import RootTransform, positions_to_features
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.body import Body
from numpy_cae.motion.windows import LENGTH

Network = TypeVar("Network")


def with_engine(network: Network, engine: str) -> Network:
    """The network: accelerated by `numpy_cae.fast` if `engine` is "fast", plain if it is "ops"."""
    if engine not in ("fast", "ops"):
        raise ValueError(f"engine is {engine!r}, expected 'fast' or 'ops'")
    return accelerate(network) if engine == "fast" else network


_PIECE = 120
"""Hidden frames that are projected at a time: a longer clip would need memory in proportion."""


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
        Multiplies the difference: one factor each for positions, velocity and turn. Not in the
        paper: without it turn and velocity would hardly be learned (learning.py).
    lengths : (20,) array of float64
        Bone lengths of the mean skeleton, metres.
    rate, window
        Frames a second, 30 as in `Body`, and frames of the windows that it was trained on.
    settings : dict
        Provenance (data, schedule, seed, losses) in JSON types; nothing is computed from it.
    rescales : bool
        Whether the network was trained on X_c / (1 - p): see `training.corruption`.
    """

    network: ConvAutoencoder
    mean_pose: np.ndarray
    scale: np.ndarray
    lengths: np.ndarray
    rate: float = 30.0
    settings: dict = field(default_factory=dict)
    rescales: bool = False
    window: int = LENGTH

    def body(self, motion: Motion) -> Body:
        """A motion of any rig with its features on this manifold's mean skeleton."""
        return Body(motion, self.lengths)

    def features(self, positions: np.ndarray) -> tuple[np.ndarray, RootTransform]:
        """Convert world positions (F, 20, 3), with any bone lengths, in metres and at `rate`, to
        features (F, 63) on the mean skeleton. Also return the first frame's root transform."""
        normalised = change_lengths(positions, bone_lengths(positions), self.lengths)
        return positions_to_features(normalised, self.rate)

    def normalise(self, features: np.ndarray) -> np.ndarray:
        """X of features (…, 63): the mean pose subtracted, scaled, in the dtype of the network."""
        return ((features - self.mean_pose) * self.scale).astype(self.network.layers[0].w.dtype)

    def denormalise(self, x: np.ndarray) -> np.ndarray:
        """The inverse of `normalise`. Returns float64."""
        return x.astype(np.float64) / self.scale + self.mean_pose

    @property
    def reach(self) -> int:
        """Frames on either side of its own that influence a hidden frame."""
        return sum(len(layer.w) // 2 * 2**k for k, layer in enumerate(self.network.layers))

    @property
    def shifts(self) -> int:
        """Positions of the pooling grid: the largest useful value of `shifts` in `project`."""
        return self.network.stride

    def encode(self, features: np.ndarray) -> np.ndarray:
        """Y = Φ(X) of a clip of any length, (F, 63) to (⌈(F + 2 · reach) / 8⌉, 256) in [-1, 1].

        The zeros with which a convolution pads a clip are the mean pose and would distort its ends.
        So the features of the first and last frame, velocity included, are repeated `reach` times;
        `decode` removes these frames. A window of 160 frames has 33 hidden frames here, and 20 in
        the paper and in `compare.hidden_units`.
        """
        return self.network.encode(self._padded(features))[0]

    def decode(self, y: np.ndarray, frames: int) -> np.ndarray:
        """Decode what `encode` returned for a clip of `frames` frames: (frames, 63), float64."""
        return self.denormalise(self.network.decode(y[None])[0])[self.reach : self.reach + frames]

    def project(self, features: np.ndarray, shifts: int = 1) -> np.ndarray:
        """Φ†(Φ(X)) of a clip of any length, (F, 63) to (F, 63) of float64: the mean of `shifts`
        projections, each of the clip shifted by one more frame (`shifted_projection`)."""
        x = self._padded(features)
        projected = np.empty_like(x[0])
        margin = (2 * self.reach // self.shifts + 2) * self.shifts
        for start in range(0, len(projected), _PIECE * self.shifts):
            # A long clip in pieces, with the frames around a piece that influence it.
            end, first = start + _PIECE * self.shifts, max(start - margin, 0)
            piece = project_shifted(self.network, x[:, first : end + margin], shifts)[0]
            projected[start:end] = piece[start - first :][: _PIECE * self.shifts]
        return self.denormalise(projected)[self.reach : self.reach + len(features)]

    def project_windows(self, x: np.ndarray, shifts: int = 1) -> np.ndarray:
        """Φ†(Φ(X)) of normalised windows (N, T, 63) as in training, with zeros around them."""
        return project_shifted(self.network, self._rescaled(x), shifts)

    def _padded(self, features: np.ndarray) -> np.ndarray:
        """A clip as one normalised window, its first and last frame repeated `reach` times."""
        more = -(len(features) + 2 * self.reach) % self.network.stride
        ends = ((0, 0), (self.reach, self.reach + more), (0, 0))
        return np.pad(self._rescaled(self.normalise(features)[None]), ends, mode="edge")

    def _rescaled(self, x: np.ndarray) -> np.ndarray:
        """X_c / (1 - p̂) if the network was trained on such input; p̂ is estimated from x."""
        return x / (1 - zeroed_fraction(x)) if self.rescales else x
