"""New motion: hidden units drawn from a prior, and Φ† of them (holden2015, section 3).

The paper: "the uniform distribution of values […] drawn from [-1, 1]^(i×k) represents a prior
probability distribution over the space of human motion which can be augmented with other beliefs".
`draw_uniform` is that. `NeighbourPrior` adds the belief that hidden units occur together as they
did in real motion: what each drew alone is far from anything that Φ gives
(lessons/papers_to_code.md, "The prior").
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.manifold.compare import hidden_units
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.windows import LENGTH, cut_windows

NEIGHBOURS = 8
"""Windows that are mixed into a new one."""
_OVERLAP = 0.25  # share of a window in which one gives way to the next


def draw_uniform(units: int, channels: int, rng: np.random.Generator) -> np.ndarray:
    """Y from the prior of section 3: every hidden unit by itself, (units, channels)."""
    return rng.uniform(-1.0, 1.0, (units, channels)).astype(np.float32)


def encode_windows(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> np.ndarray:
    """Φ of every whole window of takes' features (F, 63), (windows, 20, 256).

    Windows overlap by half. Each one's ends are continued as `compare.hidden_units` does it, or
    what is drawn would begin and end in the mean pose.

    Raises
    ------
    ValueError
        If no take is as long as a window.
    """
    length = manifold.settings.get("window", LENGTH)
    cut = [cut_windows(take, length, length // 2)[0] for take in takes if len(take) >= length]
    if not cut:
        raise ValueError(f"no take is as long as a window of {length} frames")
    return np.stack([hidden_units(manifold, window) for window in np.concatenate(cut)])


@dataclass(frozen=True)
class NeighbourPrior:
    """A prior fitted to encoded motion: a window at random, mixed with the ones most like it.

        Y = Σ_i a_i Y_i,   a ~ Dirichlet(1, …, 1) over a window Y_0 and its nearest Y_1 … Y_n

    A mixture of small simplexes that together follow the encoded motion. It needs no clipping,
    since what lies between points of [-1, 1] lies there too. A single Gaussian over all windows
    fills the room between walking and pressing up, where nobody moves.

    Parameters
    ----------
    encoded : (windows, units, channels) array of float
        As `encode_windows` gives them.
    """

    encoded: np.ndarray

    def draw(self, units: int, rng: np.random.Generator) -> np.ndarray:
        """Y of so many units, (units, channels) of float32.

        Where that is more than a window, windows follow each other, and over a quarter of a
        window one gives way to the next: an interpolation along the manifold.
        """
        y = self._window(rng)
        while len(y) < units:
            y = _continued(y, self._window(rng), max(1, round(_OVERLAP * self.encoded.shape[1])))
        return y[:units]

    def _window(self, rng: np.random.Generator) -> np.ndarray:
        chosen = self.encoded[rng.integers(len(self.encoded))]
        apart = np.square(self.encoded - chosen).sum(axis=(1, 2))
        nearest = np.argsort(apart, kind="stable")[: NEIGHBOURS + 1]
        weights = rng.dirichlet(np.ones(len(nearest))).astype(np.float32)
        return np.tensordot(weights, self.encoded[nearest], axes=1)


def _continued(y: np.ndarray, then: np.ndarray, overlap: int) -> np.ndarray:
    s = (np.arange(1, overlap + 1, dtype=y.dtype) / (overlap + 1))[:, None]
    between = (1 - s) * y[-overlap:] + s * then[:overlap]
    return np.concatenate([y[:-overlap], between, then[overlap:]])


def sample(
    manifold: MotionManifold,
    frames: int,
    rng: np.random.Generator,
    prior: NeighbourPrior | None = None,
) -> np.ndarray:
    """A motion that nobody made, (frames, 63) features of float64.

    Parameters
    ----------
    manifold : MotionManifold
    frames : int
    rng : numpy.random.Generator
    prior : NeighbourPrior, optional
        The uniform one of section 3 where None.

    Raises
    ------
    ValueError
        If there are no frames.
    """
    if frames < 1:
        raise ValueError(f"frames is {frames}, expected 1 or more")
    network = manifold.network
    units = -(-frames // network.frames_per_unit)
    if prior is None:
        y = draw_uniform(units, network.layers[-1].b.size, rng)
    else:
        y = prior.draw(units, rng)
    return decode_units(manifold, y)[:frames]


def decode_units(manifold: MotionManifold, y: np.ndarray) -> np.ndarray:
    """Φ†(Y) of the hidden units of a clip's own frames, (8 · units, 63).

    The first and the last unit are held as far as the network sees, as `compare.hidden_units`
    holds frames: beyond them the convolutions would see zeros, the mean pose.
    """
    unit = manifold.network.frames_per_unit
    more = -(-manifold.reach // unit)
    whole = np.pad(y, ((more, more), (0, 0)), mode="edge")
    decoded = manifold.denormalise(manifold.network.decode(whole[None])[0])
    return decoded[more * unit : (more + len(y)) * unit]
