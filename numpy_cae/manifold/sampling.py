"""New motions: Φ† of hidden units drawn from a prior (holden2015, section 3).

The paper: "the uniform distribution of values […] drawn from [-1, 1]^(i×k) represents a prior
probability distribution over the space of human motion which can be augmented with other beliefs".
`draw_uniform` is that prior. `NeighbourPrior` adds the belief that hidden units occur together as
in recorded motion; independent units are far from anything that Φ returns
(docs/lab_book/sampling.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.manifold.comparison import hidden_units
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.windows import cut_windows

NEIGHBOURS = 8
"""This many windows, the nearest ones, are mixed with the window drawn."""
_OVERLAP = 0.25
"""Share of a window over which it is blended into the next."""


def draw_uniform(hidden_frames: int, units: int, rng: np.random.Generator) -> np.ndarray:
    """Draw Y from the uniform prior of section 3.

    Parameters
    ----------
    hidden_frames, units : int
    rng : numpy.random.Generator

    Returns
    -------
    (hidden_frames, units) array of float32
        Hidden units in [-1, 1].

    Examples
    --------
    >>> y = draw_uniform(20, 256, np.random.default_rng(0))
    >>> y.shape, bool(np.abs(y).max() <= 1)
    ((20, 256), True)
    """
    return rng.uniform(-1.0, 1.0, (hidden_frames, units)).astype(np.float32)


def encode_windows(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> np.ndarray:
    """The `hidden_units` of all windows of takes (F, 63), which overlap by half.

    Returns (windows, window / stride, 256); ValueError if no take is as long as a window.
    """
    length = manifold.window
    windows: list[np.ndarray] = []
    for take in takes:
        if len(take) >= length:
            windows.extend(cut_windows(take, length, length // 2)[0])
    if not windows:
        raise ValueError(f"no take is as long as a window of {length} frames")
    return np.stack([hidden_units(manifold, window) for window in windows])


@dataclass(frozen=True, eq=False)
class NeighbourPrior:
    """A prior fitted to encoded motion: a random window mixed with its nearest neighbours.

        Y = Σ_i a_i Y_i,   a ~ Dirichlet(1, …, 1) over a window Y_0 and its nearest Y_1 … Y_n

    The prior is a mixture of small simplexes. Unlike a single Gaussian over all windows it puts no
    weight between motions that differ.

    Parameters
    ----------
    encoded : (windows, hidden frames, units) array
        As `encode_windows` returns it.

    Examples
    --------
    Each draw lies between encoded windows, so it keeps within their smallest and largest values:

    >>> encoded = np.linspace(0, 0.5, 60).reshape(5, 4, 3)
    >>> y = NeighbourPrior(encoded).draw(4, np.random.default_rng(0))
    >>> y.shape, bool(encoded.min() <= y.min() <= y.max() <= encoded.max())
    ((4, 3), True)
    """

    encoded: np.ndarray

    def draw(self, hidden_frames: int, rng: np.random.Generator) -> np.ndarray:
        """Draw Y, (hidden_frames, units) of float32; windows are joined and blended if needed."""
        y = self._window(rng)
        overlap = max(1, round(_OVERLAP * self.encoded.shape[1]))
        s = (np.arange(1, overlap + 1, dtype=y.dtype) / (overlap + 1))[:, None]
        while len(y) < hidden_frames:
            following = self._window(rng)
            blended = (1 - s) * y[-overlap:] + s * following[:overlap]
            y = np.concatenate([y[:-overlap], blended, following[overlap:]])
        return y[:hidden_frames]

    def _window(self, rng: np.random.Generator) -> np.ndarray:
        chosen = self.encoded[rng.integers(len(self.encoded))]
        distances = np.square(self.encoded - chosen).sum(axis=(1, 2))
        nearest = np.argsort(distances, kind="stable")[: NEIGHBOURS + 1]
        weights = rng.dirichlet(np.ones(len(nearest))).astype(np.float32)
        return np.tensordot(weights, self.encoded[nearest], axes=1)


def sample(
    manifold: MotionManifold,
    frames: int,
    rng: np.random.Generator,
    prior: NeighbourPrior | None = None,
) -> np.ndarray:
    """A new motion, decoded from a draw of a prior.

    Parameters
    ----------
    manifold : MotionManifold
    frames : int
        At thirty frames a second.
    rng : numpy.random.Generator
    prior : NeighbourPrior, optional
        The uniform prior where None.

    Returns
    -------
    (frames, 63) array of float64
        Features on the mean skeleton.

    Raises
    ------
    ValueError
        If `frames` is less than 1.

    Examples
    --------
    >>> from numpy_cae.manifold import sample, starter
    >>> sample(starter(), 90, np.random.default_rng(0)).shape
    (90, 63)
    """
    if frames < 1:
        raise ValueError(f"frames is {frames}, expected 1 or more")
    hidden_frames = -(-frames // manifold.stride)
    if prior is None:
        y = draw_uniform(hidden_frames, manifold.network.layers[-1].b.size, rng)
    else:
        y = prior.draw(hidden_frames, rng)
    # The inverse of `hidden_units`; the first and the last hidden frame are repeated as padding.
    more = -(-manifold.receptive_radius // manifold.stride)
    padded = np.pad(y, ((more, more), (0, 0)), mode="edge")
    decoded = manifold.denormalise(manifold.network.decode(padded[None])[0])
    return decoded[more * manifold.stride :][:frames]
