"""A trained convolutional autoencoder with the normalisation of its input: the motion manifold."""

import json
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from pathlib import Path

import numpy as np

from numpy_cae.array_file import save_arrays
from numpy_cae.manifold import completion
from numpy_cae.manifold.model_arrays import (
    MAX_FRAMES,
    MAX_LENGTH,
    SMALLEST,
    read_integer,
    read_numbers,
    require_loadable,
)
from numpy_cae.manifold.probabilistic_pca import (
    LEAST_NOISE,
    LEAST_VARIANCE,
    TAPS,
    ProbabilisticPCA,
)
from numpy_cae.manifold.weighted_completion import complete_weighted
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.motion import JOINTS, RATE, bone_lengths, change_lengths, positions_to_features
from numpy_cae.motion.features import FEATURES, RootTransform, problem_of_lengths
from numpy_cae.motion.windows import LENGTH
from numpy_cae.ops.shapes import require_shape

FORMAT = "numpy_cae convolutional manifold 3"
"""The only format that is read; a file of another version has to be made again."""
MAX_HIDDEN_FRAMES = 120
"""A longer clip is projected in pieces of this length, to bound memory."""
MAX_PIECES = 400
"""The number of projected pieces that `remember_projections` keeps, 0.1 GB."""


@dataclass(repr=False, eq=False)
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
    context : ProbabilisticPCA, optional
        Of fifteen successive frames of the training takes, for `complete`; None where no take had
        as many.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> from numpy_cae.mocap import body_of
    >>> manifold = starter()
    >>> walk = body_of(make_take("walk", 0, seconds=2.0, rate=30.0).motion)
    >>> features, _ = manifold.features(walk)
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
    context: ProbabilisticPCA | None = None
    _pieces: dict[bytes, np.ndarray] | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        filters = ", ".join(str(layer.b.size) for layer in self.network.layers)
        takes = self.settings.get("takes", "unknown")
        source = "1 take" if takes == 1 else f"{takes} takes"
        return f"manifold of layers with {filters} filters, learned from {source}"

    def features(self, positions: np.ndarray) -> tuple[np.ndarray, RootTransform]:
        """The features (F, 63) on the mean skeleton, and the first frame's root transform, of world
        positions (F, 20, 3) with any bone lengths, in metres."""
        positions = np.asarray(positions)
        require_shape("positions", positions, ("frames", len(JOINTS), 3))
        if not len(positions):
            raise ValueError("positions has no frames, expected at least one")
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

    def pad(self, x: np.ndarray, before: int | None = None) -> np.ndarray:
        """Lengthen normalised windows (N, F, 63) to a whole number of hidden frames, by repeating
        their first and last frames, velocity included.

        The zeros with which a convolution pads a clip are the mean pose and would distort its ends.
        `before` frames are added at the beginning and as many or a few more at the end:
        `receptive_radius` where None. `unpad` removes these.
        """
        before = self.receptive_radius if before is None else before
        after = before + -(x.shape[1] + 2 * before) % self.stride
        return np.pad(x, ((0, 0), (before, after), (0, 0)), mode="edge")

    def unpad(self, x: np.ndarray, frames: int) -> np.ndarray:
        """Remove from windows (N, …, 63) what `pad` added; `frames` is their length before."""
        return x[:, self.receptive_radius : self.receptive_radius + frames]

    def encode(self, features: np.ndarray) -> np.ndarray:
        """Y = Φ(X) of a clip of any length, (F, 63) to (⌈(F + 2 · receptive_radius) / 8⌉, 256).

        The clip is lengthened by `pad`, so a window of 160 frames has 33 hidden frames here, and 20
        in the paper and in `comparison.hidden_units`. Values are in [-1, 1].
        """
        x = self._rescale(self.normalise(features)[None])
        return self.network.encode(self.pad(x))[0]

    def decode(self, y: np.ndarray, frames: int) -> np.ndarray:
        """Decode what `encode` returned for a clip of `frames` frames: (frames, 63), float64."""
        return self.denormalise(self.unpad(self.network.decode(y[None]), frames)[0])

    def project(self, features: np.ndarray, average_shifts: bool = False) -> np.ndarray:
        """Φ†(Φ(X)), the projection of a clip of any length (holden2015, section 3).

        `numpy_cae.project` projects a whole motion in its own rig.

        Parameters
        ----------
        features : (F, 63) array of float
            On the mean skeleton.
        average_shifts : bool
            Whether to average over all shifts of the pooling grid (`project_shifted`).

        Returns
        -------
        (F, 63) array of float64
        """
        features = np.asarray(features)
        require_shape("features", features, ("frames", FEATURES))
        x = self._rescale(self.normalise(features)[None])
        return self.denormalise(self._project_clip(x, average_shifts)[0])

    def complete(self, features: np.ndarray, known: np.ndarray | None = None) -> np.ndarray:
        """Complete a clip of which some values are missing (`manifold.weighted_completion`).

        Normalised features are completed by six candidates: a Gaussian process over time of each
        feature by itself (`motion.gaussian_process`); the same, refined by a regression of the
        values of each frame on one another in this clip (`motion.frame_gaussian`); the estimate by
        principal components of fifteen frames of the training takes, with the curve of its errors
        at known values (`manifold.probabilistic_pca`), without and with a ridge for takes of
        another source; the estimate with the ridge, refined; and the network's completion by the
        iteration of `manifold.completion`, refined. They are weighed by their errors in about a
        tenth of the known values, left out up to four times, for each distance to the nearest known
        value. Time and memory are linear in the frames. Meanwhile BLAS has one thread in the whole
        process.

        Parameters
        ----------
        features : (F, 63) array of float
            On the mean skeleton, F at least 1. What is unknown is ignored.
        known : (F, 63) array of bool, optional
            By default every value that is not exactly that of the mean pose: holden2015 sets lost
            values to zero, which is the mean pose, and a measured value is hardly ever equal to it.
            Features whose mean is exactly zero are known in every frame: the hips' x and z in the
            body's frame are always zero.

        Returns
        -------
        (F, 63) array of float64
            Known values as they are given. In a feature without a known value the candidates are
            weighed by their errors in other features, left out as a whole.

        Raises
        ------
        ValueError
            If `known` has another shape.

        Examples
        --------
        Half of the values of a walk are lost. The mean error of a position, in centimetres:

        >>> from data_synth import make_take
        >>> from numpy_cae.manifold import starter
        >>> from numpy_cae.mocap import body_of
        >>> from numpy_cae.motion import POSITIONS
        >>> manifold = starter()
        >>> walk = body_of(make_take("walk", 0, seconds=4.0, rate=30.0).motion)
        >>> features, _ = manifold.features(walk)
        >>> known = np.random.default_rng(0).random(features.shape) < 0.5
        >>> off = manifold.complete(features, known) - features
        >>> print((100 * np.abs(off[:, POSITIONS]).mean()).round(2))
        0.04
        """
        if known is None:
            # The hips' place in the body's frame is always zero, and so is its mean.
            known = (features != self.mean_pose) | (self.mean_pose == 0)
        known = np.asarray(known, dtype=bool)
        if known.shape != np.shape(features):
            raise ValueError(f"known has shape {known.shape}, expected {np.shape(features)}")
        x = self.normalise(np.where(known, features, self.mean_pose)).astype(np.float64)

        def project(x: np.ndarray, averaged: bool) -> np.ndarray:
            x = x.astype(self.network.layers[0].w.dtype)
            return self._project_clip(self._rescale(x), averaged).astype(np.float64)

        completed = complete_weighted(x, known, project, self.context)
        return np.where(known, features, self.denormalise(completed))

    def complete_windows(self, x: np.ndarray, known: np.ndarray) -> np.ndarray:
        """As `complete`, of normalised windows (N, F, 63); as in training, with zeros around."""

        def project(window: np.ndarray, averaged: bool) -> np.ndarray:
            return self.project_windows(window.astype(x.dtype), averaged).astype(np.float64)

        completed = np.empty_like(x)
        for window, is_known, into in zip(x, known, completed, strict=True):
            into[...] = complete_weighted(window, is_known, project, self.context)
        return completed

    def project_windows(self, x: np.ndarray, average_shifts: bool = False) -> np.ndarray:
        """As `project`, of normalised windows (N, F, 63) as in training, with zeros around them."""
        return completion.project_shifted(self.network, self._rescale(x), average_shifts)

    def remember_projections(self) -> "MotionManifold":
        """The same manifold, for repeated projections of a motion that changes in few places: a
        piece that is equal to one projected before is not projected again. The weights must not
        change meanwhile."""
        return replace(self, _pieces={})

    def save(self, path: str | Path, half: bool = False) -> None:
        """Write the manifold, completely or not at all; `load_manifold` reads it.

        Parameters
        ----------
        path : path
            The file to write, .npz.
        half : bool
            Whether to write the weights of the network, and the axes of `context`, as float16.

        Raises
        ------
        FileError
            If the file cannot be written.
        ModelFileError
            If it could not be loaded, since numbers are too large: the training diverged.

        Examples
        --------
        >>> from numpy_cae.manifold import load_manifold, starter
        >>> starter().save("model.npz", half=True)
        >>> load_manifold("model.npz").stride
        8
        """
        dtype = np.float16 if half else None
        weights = {name: np.asarray(w, dtype) for name, w in self.network.parameters.items()}
        arrays = {
            "format": np.array(FORMAT),
            "mean_pose": self.mean_pose,
            "scale": self.scale,
            "rate": np.array(self.rate),
            "joints": np.array(JOINTS),
            "lengths": self.lengths,
            "bound": np.array(self.network.layers[0].bound),
            "rescales": np.array(int(self.rescales)),
            "window": np.array(self.window),
            "settings": np.array(json.dumps(self.settings)),
        }
        if self.context is not None:
            arrays["context_mean"] = self.context.mean
            arrays["context_axes"] = self.context.axes.astype(np.float16 if half else np.float32)
            arrays["context_noise"] = np.array(self.context.noise)
        require_loadable(MotionManifold.from_arrays, arrays | weights, path)
        save_arrays(arrays | weights, path)

    @staticmethod
    def from_arrays(arrays: dict[str, np.ndarray]) -> "MotionManifold":
        """The manifold of a model file's arrays; ValueError or KeyError where they do not fit."""
        if not np.array_equal(arrays["joints"], JOINTS):
            raise ValueError("its twenty joints are not those of this version")
        lengths = read_numbers(arrays, "lengths", (len(JOINTS),), 0.0, MAX_LENGTH)
        if problem := problem_of_lengths(lengths):
            raise ValueError(f"lengths: {problem}")
        bound = float(read_numbers(arrays, "bound", (), SMALLEST, 1 - SMALLEST))
        network = ConvAutoencoder(filters=(), bound=bound)
        # Filters w and biases b of each layer; where one array is missing, this raises KeyError.
        count = -(-sum(name[0] in "wb" and name[1:].isdigit() for name in arrays) // 2)
        taps = len(arrays["w1"])
        channels = FEATURES
        # The weights of the starter model are float16, to save space.
        dtype = np.promote_types(arrays["w1"].dtype, np.float32)
        for layer in range(1, count + 1):
            w = read_numbers(arrays, f"w{layer}", (taps, channels, arrays[f"b{layer}"].size))
            channels = w.shape[2]
            b = read_numbers(arrays, f"b{layer}", (channels,))
            network.layers.append(ConvLayer(w.astype(dtype), b.astype(dtype), bound))
        return MotionManifold(
            network,
            read_numbers(arrays, "mean_pose", (FEATURES,)),
            read_numbers(arrays, "scale", (FEATURES,), SMALLEST),
            lengths,
            rescales=bool(read_integer(arrays, "rescales", 0, 1)),
            window=read_integer(arrays, "window", 1, MAX_FRAMES),
            context=_read_context(arrays),
        )

    def _project_clip(self, clip: np.ndarray, average_shifts: bool) -> np.ndarray:
        """`project_shifted` of one normalised window (1, F, 63), lengthened by `pad`, in pieces."""
        x = self.pad(clip)
        projected = np.empty_like(x)
        margin = (2 * self.receptive_radius // self.stride + 2) * self.stride
        piece = MAX_HIDDEN_FRAMES * self.stride
        for start in range(0, x.shape[1], piece):
            # Each piece is projected with the frames around it that influence it.
            first = max(start - margin, 0)
            near = self._project_once(x[:, first : start + piece + margin], average_shifts)
            projected[0, start : start + piece] = near[start - first :][:piece]
        return self.unpad(projected, clip.shape[1])

    def _project_once(self, x: np.ndarray, average_shifts: bool) -> np.ndarray:
        """`project_shifted` of one window (1, T, 63), (T, 63); see `remember_projections`."""
        if self._pieces is None:
            return completion.project_shifted(self.network, x, average_shifts)[0]
        digest = blake2b(x.tobytes(), salt=bytes([average_shifts])).digest()
        if digest not in self._pieces:
            if len(self._pieces) == MAX_PIECES:
                del self._pieces[next(iter(self._pieces))]
            self._pieces[digest] = completion.project_shifted(self.network, x, average_shifts)[0]
        return self._pieces[digest]

    def _rescale(self, x: np.ndarray) -> np.ndarray:
        """X_c / (1 - p̂) if the network was trained on such input; p̂ is estimated from x."""
        if not self.rescales:
            return x
        return x / (1 - completion.zeroed_fraction(x))


def _read_context(arrays: dict[str, np.ndarray]) -> ProbabilisticPCA | None:
    """`MotionManifold.context` of a model file's arrays."""
    if not any(name.startswith("context_") for name in arrays):
        return None
    size = TAPS * FEATURES
    axes = arrays["context_axes"]
    count = min(len(axes), size) if axes.ndim else 0
    mean = read_numbers(arrays, "context_mean", (size,))
    axes = read_numbers(arrays, "context_axes", (count, size))
    noise = float(read_numbers(arrays, "context_noise", (), LEAST_VARIANCE))
    # Half of what is learned, since the axes may have been rounded to float16.
    if noise < LEAST_NOISE / 2 * float(np.sum(np.square(axes, dtype=np.float64))) / size:
        raise ValueError("context_noise is too small for context_axes")
    return ProbabilisticPCA(mean, axes, noise)
