"""A trained convolutional autoencoder with the normalisation of its input: the motion manifold."""

from dataclasses import dataclass, field, replace
from functools import partial
from hashlib import blake2b
from pathlib import Path
from typing import TypeVar, overload

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.manifold.mixture import Project, mixture
from numpy_cae.manifold.shifted_projection import project_shifted, zeroed_fraction
from numpy_cae.models import ConvAutoencoder
from numpy_cae.models.linear_denoiser import LinearDenoiser
from numpy_cae.motion.features import RootTransform, positions_to_features
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import RATE, Motion
from numpy_cae.motion.retarget.body import Body
from numpy_cae.motion.windows import LENGTH

Network = TypeVar("Network")


def with_engine(network: Network, engine: str) -> Network:
    """The network: accelerated by `numpy_cae.fast` if `engine` is "fast", plain if it is "ops"."""
    if engine not in ("fast", "ops"):
        raise ValueError(f"engine is {engine!r}, expected 'fast' or 'ops'")
    return accelerate(network) if engine == "fast" else network


MAX_HIDDEN_FRAMES = 120
"""MAX_HIDDEN_FRAMES: a longer clip is projected in pieces of this length, to bound memory."""
MAX_PIECES = 400
"""MAX_PIECES: the number of projected pieces that `remembering` keeps, 0.1 GB."""


@dataclass(repr=False)
class MotionManifold:
    """A trained network, and the conversion between features of motions and its input.

    Arrays (F, …) are at `rate`, thirty frames a second.

    Parameters
    ----------
    network : ConvAutoencoder
        Plain or accelerated; everything is computed with it.
    mean_pose : (63,) array of float64
        Subtracted from every frame of features (holden2015, section 4).
    scale : (63,) array of float64
        normalised = (features - mean_pose) · scale; one factor each for positions, velocity and
        turn. Not in the paper: without it turn and velocity would hardly be learned (learning.py).
    lengths : (20,) array of float64
        Bone lengths of the mean skeleton, metres.
    rate, window
        Frames a second, 30 as in `Body`, and frames of the windows that it was trained on.
    settings : dict
        Provenance (data, schedule, seed, losses) in JSON types; nothing is computed from it.
    rescales : bool
        Whether the network was trained on X_c / (1 - p): see `training.corruption`.
    linear : LinearDenoiser, optional
        A linear map fitted to the same windows, of which `mixture` makes a mean with the network's
        projection where values were removed. Without it the network projects alone.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> manifold = starter()
    >>> features = manifold.body(make_take("walk", 0, seconds=2.0, rate=30.0).motion).features
    >>> manifold.encode(features).shape, manifold.project(features).shape
    ((20, 256), (60, 63))
    """

    network: ConvAutoencoder
    mean_pose: np.ndarray
    scale: np.ndarray
    lengths: np.ndarray
    rate: float = RATE
    settings: dict = field(default_factory=dict)
    rescales: bool = False
    window: int = LENGTH
    linear: LinearDenoiser | None = None
    _pieces: dict[bytes, np.ndarray] | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        filters = ", ".join(str(layer.b.size) for layer in self.network.layers)
        takes = self.settings.get("takes", "unknown")
        return f"manifold of layers with {filters} filters, learned from {takes} takes"

    def body(self, motion: Motion) -> Body:
        """A motion of any rig with its features on this manifold's mean skeleton."""
        return Body(motion, self.lengths)

    def features(self, positions: np.ndarray) -> tuple[np.ndarray, RootTransform]:
        """The features (F, 63) on the mean skeleton, and the first frame's root transform, of world
        positions (F, 20, 3) with any bone lengths, in metres."""
        normalised = change_lengths(positions, bone_lengths(positions), self.lengths)
        return positions_to_features(normalised, self.rate)

    def normalise(self, features: np.ndarray) -> np.ndarray:
        """X of features (…, 63): the mean pose subtracted, scaled, in the dtype of the network."""
        return ((features - self.mean_pose) * self.scale).astype(self.network.layers[0].w.dtype)

    def denormalise(self, x: np.ndarray) -> np.ndarray:
        """The inverse of `normalise`, in float64."""
        return x.astype(np.float64) / self.scale + self.mean_pose

    @property
    def stride(self) -> int:
        """Frames of motion for one hidden frame: 8 with three layers."""
        return self.network.stride

    @property
    def receptive_radius(self) -> int:
        """Half-width of the receptive field of a hidden frame, in frames of motion."""
        return sum(len(layer.w) // 2 * 2**k for k, layer in enumerate(self.network.layers))

    def padded(self, x: np.ndarray, before: int | None = None) -> np.ndarray:
        """Normalised windows (N, F, 63), the first and last frames repeated, velocity included, up
        to a whole number of hidden frames.

        The zeros with which a convolution pads a clip are the mean pose and would distort its ends.
        `before` frames are added at the beginning and as many or a few more at the end:
        `receptive_radius` where None. `unpadded` removes these.
        """
        before = self.receptive_radius if before is None else before
        after = before + -(x.shape[1] + 2 * before) % self.stride
        return np.pad(x, ((0, 0), (before, after), (0, 0)), mode="edge")

    def unpadded(self, x: np.ndarray, frames: int) -> np.ndarray:
        """Windows (N, …, 63) without what `padded` added; `frames` is their length before."""
        return x[:, self.receptive_radius : self.receptive_radius + frames]

    def encode(self, features: np.ndarray) -> np.ndarray:
        """Y = Φ(X) of a clip of any length, (F, 63) to (⌈(F + 2 · receptive_radius) / 8⌉, 256).

        The clip is `padded`, so a window of 160 frames has 33 hidden frames here, and 20 in the
        paper and in `compare.hidden_units`. Values are in [-1, 1].
        """
        return self.network.encode(self._padded(features))[0]

    def decode(self, y: np.ndarray, frames: int) -> np.ndarray:
        """Decode what `encode` returned for a clip of `frames` frames: (frames, 63), float64."""
        return self.denormalise(self.unpadded(self.network.decode(y[None]), frames)[0])

    @overload
    def project(self, motion: np.ndarray, average_shifts: bool = False) -> np.ndarray: ...

    @overload
    def project(self, motion: Motion, average_shifts: bool = False) -> Motion: ...

    def project(self, motion, average_shifts=False):
        """Φ†(Φ(X)), the projection of a clip or a motion of any length.

        Where values of the clip are zero, and the manifold has a linear map, it is the `mixture`.

        Parameters
        ----------
        motion : (F, 63) array of float, or Motion
            Features on the mean skeleton, or a motion of any rig and rate.
        average_shifts : bool
            Whether to average over all shifts of the pooling grid (`project_shifted`). A Motion is
            always projected like this.

        Returns
        -------
        (F, 63) array of float64, or Motion
            Features for features; a Motion, made by `project_motion`, for a Motion.
        """
        if isinstance(motion, Motion):
            from numpy_cae.manifold.project_motion import project_motion  # imports this module

            return project_motion(motion, self)
        project = partial(self._project_clip, average_shifts=average_shifts)
        return self.denormalise(self._repaired(self.normalise(motion)[None], project)[0])

    def project_windows(self, x: np.ndarray, average_shifts: bool = False) -> np.ndarray:
        """As `project`, of normalised windows (N, F, 63) as in training, with zeros around them."""
        return self._repaired(x, lambda x: project_shifted(self.network, x, average_shifts))

    def remembering(self) -> "MotionManifold":
        """The same manifold, for repeated projections of a motion that changes in few places: a
        piece that is equal to one projected before is not projected again. The weights must not
        change meanwhile."""
        return replace(self, _pieces={})

    def save(self, path: str | Path) -> None:
        """Write the manifold as `.npz`; `load_manifold` reads it."""
        from numpy_cae.manifold.model_file import save_manifold  # imports this module

        save_manifold(self, path)

    def _project_clip(self, clip: np.ndarray, average_shifts: bool) -> np.ndarray:
        """`project_shifted` of one normalised window (1, F, 63) that is `padded`, in pieces."""
        x = self.padded(clip)
        projected = np.empty_like(x)
        margin = (2 * self.receptive_radius // self.stride + 2) * self.stride
        piece = MAX_HIDDEN_FRAMES * self.stride
        for start in range(0, x.shape[1], piece):
            # Each piece is projected with the frames around it that influence it.
            first = max(start - margin, 0)
            near = self._project_once(x[:, first : start + piece + margin], average_shifts)
            projected[0, start : start + piece] = near[start - first :][:piece]
        return self.unpadded(projected, clip.shape[1])

    def _project_once(self, x: np.ndarray, average_shifts: bool) -> np.ndarray:
        """`project_shifted` of one window (1, T, 63), (T, 63); see `remembering`."""
        if self._pieces is None:
            return project_shifted(self.network, x, average_shifts)[0]
        digest = blake2b(x.tobytes(), salt=bytes([average_shifts])).digest()
        if digest not in self._pieces:
            if len(self._pieces) == MAX_PIECES:
                del self._pieces[next(iter(self._pieces))]
            self._pieces[digest] = project_shifted(self.network, x, average_shifts)[0]
        return self._pieces[digest]

    def _padded(self, features: np.ndarray) -> np.ndarray:
        """A clip of features (F, 63) as one normalised window, padded."""
        return self.padded(self._rescaled(self.normalise(features)[None]))

    def _repaired(self, x: np.ndarray, project: Project) -> np.ndarray:
        """The projection by a function, of windows (N, F, 63) of which values may be removed."""
        if self.rescales and self.linear is not None and np.any(p := zeroed_fraction(x)):
            return mixture(x, p, project, self.linear)
        return project(self._rescaled(x))

    def _rescaled(self, x: np.ndarray) -> np.ndarray:
        """X_c / (1 - p̂) if the network was trained on such input; p̂ is estimated from x."""
        return x / (1 - zeroed_fraction(x)) if self.rescales else x
