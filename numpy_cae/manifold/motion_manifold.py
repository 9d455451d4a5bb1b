"""A trained network together with what it was taught to see: the motion manifold.

The network knows numbers near zero. What turns a body into those numbers and back (the mean
skeleton, the mean pose, a scale) belongs to it and is kept with it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from numpy_cae.manifold.blind import lost_share, project_shifted
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.features import RootTransform, positions_to_features
from numpy_cae.motion.lengths import bone_lengths, change_lengths


@dataclass
class MotionManifold:
    """The manifold and the way there from motions of the twenty joints.

    Parameters
    ----------
    network : ConvAutoencoder
    mean_pose : (63,) array of float64
        Subtracted from every frame of features (holden2015, section 4).
    scale : (63,) array of float64
        Multiplies what is left: one factor for all positions, one for the velocity, one for the
        turn.
    lengths : (20,) array of float64
        Bone lengths of the mean skeleton, metres.
    rate : float
        Frames a second.
    settings : dict
        How it was made, as far as JSON can say: data, schedule, seed, losses.
    """

    network: ConvAutoencoder
    mean_pose: np.ndarray
    scale: np.ndarray
    lengths: np.ndarray
    rate: float = 30.0
    settings: dict = field(default_factory=dict)

    def features(self, positions: np.ndarray) -> tuple[np.ndarray, RootTransform]:
        """Features on the mean skeleton, and where the motion starts.

        Parameters
        ----------
        positions : (F, 20, 3) array of float
            World positions in metres, on anyone's bones, at `rate`.

        Returns
        -------
        features : (F, 63) array of float64
        start : RootTransform
        """
        normalised = change_lengths(positions, bone_lengths(positions), self.lengths)
        return positions_to_features(normalised, self.rate)

    def normalise(self, features: np.ndarray) -> np.ndarray:
        """X: the mean pose subtracted, scaled, in the dtype of the network; any shape (…, 63)."""
        return ((features - self.mean_pose) * self.scale).astype(self.network.layers[0].w.dtype)

    def denormalise(self, x: np.ndarray) -> np.ndarray:
        """The features that `normalise` makes x of, float64."""
        return x.astype(np.float64) / self.scale + self.mean_pose

    @property
    def reach(self) -> int:
        """How many frames to either side of its own a unit of the top layer sees."""
        return sum(len(layer.w) // 2 * 2**k for k, layer in enumerate(self.network.layers))

    @property
    def rescales(self) -> bool:
        """Whether the network was trained on X_c / (1 - p): see `training.corruption`."""
        fine_tuning = self.settings.get("schedule", {}).get("fine_tuning", {})
        return bool(fine_tuning.get("rescaled", False))

    @property
    def shifts(self) -> int:
        """Places of the pooling grid that differ: the most that `project` can average over."""
        return self.network.frames_per_unit

    def encode(self, features: np.ndarray) -> np.ndarray:
        """Y = Φ(X) of a clip of any length, its ends continued.

        The zeros that a convolution sees beyond a clip are the mean pose, and near its ends they
        pull a motion there. So the clip is continued on both sides, its first and its last
        frame held as far as the network sees, and `decode` cuts that off again.

        Parameters
        ----------
        features : (F, 63) array of float

        Returns
        -------
        (units, 256) array within [-1, 1], in the dtype of the network
            (F + 2 · `reach`) / 8 units, rounded up.
        """
        return self.network.encode(self._continued(features))[0]

    def decode(self, y: np.ndarray, frames: int) -> np.ndarray:
        """Φ†(Y) of what `encode` made of a clip of so many frames, (frames, 63) of float64."""
        return self.denormalise(self.network.decode(y[None])[0])[self.reach : self.reach + frames]

    def project(self, features: np.ndarray, shifts: int = 1) -> np.ndarray:
        """Φ†(Φ(X)): the nearest motion that the network believes in, of any length.

        Parameters
        ----------
        features : (F, 63) array of float
        shifts : int
            How many shifts to average over: see `manifold.blind.project_shifted`.

        Returns
        -------
        (F, 63) array of float64
        """
        projected = project_shifted(self.network, self._continued(features), shifts)[0]
        return self.denormalise(projected)[self.reach : self.reach + len(features)]

    def project_windows(self, x: np.ndarray, shifts: int = 1) -> np.ndarray:
        """Φ†(Φ(X)) of windows as the network was trained on them, zeros around them.

        A network that was trained on X_c / (1 - p) is given that, with p̂ = `lost_share`: blind, for
        nothing but X_c is asked.

        Parameters
        ----------
        x : (N, T, 63) array of float32
            Normalised; T is a multiple of `network.frames_per_unit`.
        shifts : int
            How many shifts to average over: see `manifold.blind.project_shifted`.

        Returns
        -------
        (N, T, 63) array of float32
        """
        return project_shifted(self.network, self._rescaled(x), shifts)

    def _continued(self, features: np.ndarray) -> np.ndarray:
        """A clip as one window whose ends are held as far as the network sees."""
        more = -(len(features) + 2 * self.reach) % self.network.frames_per_unit
        ends = ((0, 0), (self.reach, self.reach + more), (0, 0))
        return np.pad(self._rescaled(self.normalise(features)[None]), ends, mode="edge")

    def _rescaled(self, x: np.ndarray) -> np.ndarray:
        return x / (1 - lost_share(x)) if self.rescales else x
