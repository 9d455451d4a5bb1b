"""One set of takes and one set of measures, for networks and for what is none.

reconstruction   of held-out windows as they are, cm
half zeroed      the same after each value was lost with probability 0.5, blind, cm
validity         of motions between two held-out ones: `measures.ValidityMeasure`
retrieval        mean average precision of held-out takes that look through the training takes,
                 for the same content and for the same style
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, dataclass, replace

import numpy as np

from numpy_cae.experiments.clips import Clips
from numpy_cae.experiments.comparison.comparison import CONTENT, STYLE, labels_of_pairs
from numpy_cae.experiments.comparison.distances import Distance, equation_4
from numpy_cae.experiments.interpolation.interpolation import PAIRS_OF, SHARES, clips_of_pair
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.split import split_of
from numpy_cae.manifold import MotionManifold, interpolate, learn_manifold
from numpy_cae.manifold.interpolate import TRANSITION, shares
from numpy_cae.measures import Validity, ValidityMeasure
from numpy_cae.measures.retrieval import average_precision
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import cut_windows
from numpy_cae.motion.windows import LENGTH
from numpy_cae.training import Schedule, Stage, zero_values

P = 0.5
ACTIVE = 0.1
"""A hidden value beyond this counts as active, of 1; a unit with a root mean square beyond it."""


@dataclass(frozen=True)
class Method:
    """What is measured: a network or what a sensible person would try instead.

    Parameters
    ----------
    project : (N, T, 63) -> (N, T, 63)
        Normalised windows to their repair.
    between : (F, 63), (F, 63), share -> (F, 63)
        From the features of two motions to those of one between them.
    distance : Distance or None
        Between takes.
    network : ConvAutoencoder or None
        Whose units are counted.
    """

    project: Callable[[np.ndarray], np.ndarray]
    between: Callable[[np.ndarray, np.ndarray, float | str], np.ndarray]
    distance: Distance | None = None
    network: ConvAutoencoder | None = None


@dataclass(frozen=True)
class Measured:
    """One method from one seed; not a number where there is nothing to measure.

    Parameters
    ----------
    units, at_once : float
        Units of the highest layer that are active, and the share of hidden values that are, %.
    reconstruction, half_zeroed : float
        cm.
    validity : the five numbers of `Validity`
    content, style : float
        Mean average precision.
    """

    units: float
    at_once: float
    reconstruction: float
    half_zeroed: float
    bone_length: float
    foot_sliding: float
    beyond_limits: float
    jitter: float
    nearest_pose: float
    content: float
    style: float

    HEADER = (
        "units active",
        "at once, %",
        "reconstruction, cm",
        "half zeroed, cm",
        *Validity.HEADER,
        "content, mAP",
        "style, mAP",
    )
    DIGITS = (0, 0, 2, 2, 2, 1, 1, 2, 2, 2, 2)


class Evaluation:
    """Takes, cut and labelled once, and every measure on them.

    Parameters
    ----------
    material : Material

    Raises
    ------
    ValueError
        If the takes are too few, nothing labelled is held out or no two held-out takes can be
        interpolated.
    """

    def __init__(self, material: Material):
        takes = [take.positions for take in material.training]
        nothing = Schedule(Stage(epochs=0), Stage(epochs=0))
        # The mean pose, the scale and the mean skeleton; its network is of no use.
        self.frame = learn_manifold(takes, nothing, filters=(1,), taps=1, show_progress=False)
        self.split = split_of(self.frame, material)
        self.training, self.gallery = self._features(material, "training")
        _, self.queries = self._features(material, "testing")
        self.windows = np.concatenate([self._windows(take) for take in self.training])
        self.validity = ValidityMeasure(self.training, self.frame.lengths, self.frame.rate)
        pairs = [pair for find in PAIRS_OF.values() for pair in find(material.testing)]
        if not pairs:
            raise ValueError("the test takes hold no two walks of two styles, nor press-ups")
        self.pairs = [clips_of_pair(self.frame, *pair) for pair in pairs]
        alike = labels_of_pairs(_labelled(material.testing), _labelled(material.training))
        self.alike = {label: alike[label][0] for label in (CONTENT, STYLE)}
        if not all(each.any() for each in self.alike.values()):
            raise ValueError("an ablation needs labelled takes, for training and for testing")

    @property
    def testing(self) -> Clips:
        """The windows that are repaired."""
        return self.split.testing

    def manifold(self, network: ConvAutoencoder, rescaled: bool) -> MotionManifold:
        """A network with the mean pose and the scale that all share."""
        settings = self.frame.settings | {"schedule": {"fine_tuning": {"rescaled": rescaled}}}
        return replace(self.frame, network=network, settings=settings)

    def of_network(self, network: ConvAutoencoder, rescaled: bool) -> Method:
        """Projection, interpolation along the manifold, equation 4."""
        manifold = self.manifold(network, rescaled)

        def between(one: np.ndarray, other: np.ndarray, share: float | str) -> np.ndarray:
            return interpolate(manifold, one, other, share)

        return Method(manifold.project_windows, between, equation_4(manifold), network)

    def of_projection(
        self, project: Callable[[np.ndarray], np.ndarray], distance: Distance | None = None
    ) -> Method:
        """Of two motions the projection of what lies linearly between them."""

        def between(one: np.ndarray, other: np.ndarray, share: float | str) -> np.ndarray:
            s = shares(share, len(one))
            window, _ = cut_windows((1 - s) * one + s * other, LENGTH, 0)
            projected = project(self.frame.normalise(window))
            return self.frame.denormalise(projected)[0, : len(one)]

        return Method(project, between, distance)

    def measure(self, method: Method, seed: int) -> Measured:
        """Every number of a row; the seed is that of the lost values."""
        truth = self.testing
        lost = zero_values(truth.x, P, np.random.default_rng(seed))
        made = [
            method.between(*pair, share) for pair in self.pairs for share in (*SHARES, TRANSITION)
        ]
        return Measured(
            *self._active(method.network),
            truth.error(method.project(truth.x)),
            truth.error(method.project(lost)),
            *astuple(Validity.mean([self.validity.of(clip) for clip in made])),
            *self._retrieval(method.distance),
        )

    def _active(self, network: ConvAutoencoder | None) -> tuple[float, float]:
        if network is None:
            return np.nan, np.nan
        y = network.encode(self.testing.x)
        size = np.sqrt(np.mean(y**2, axis=(0, 1)))
        return float(np.sum(size > ACTIVE)), float(100 * np.mean(np.abs(y) > ACTIVE))

    def _retrieval(self, distance: Distance | None) -> list[float]:
        if distance is None:
            return [np.nan] * len(self.alike)
        d = distance.between(self.queries, self.gallery)
        asked = [alike.any(axis=1) for alike in self.alike.values()]
        return [
            float(average_precision(d[rows], alike[rows]).mean())
            for rows, alike in zip(asked, self.alike.values(), strict=True)
        ]

    def _features(self, material: Material, half: str) -> tuple[list, list]:
        """Of all takes of a half, and of those that are labelled."""
        takes = getattr(material, half)
        every = [self.frame.features(take.positions)[0] for take in takes]
        return every, [x for x, take in zip(every, takes, strict=True) if take.content]

    def _windows(self, features: np.ndarray) -> np.ndarray:
        return self.frame.normalise(cut_windows(features)[0])


def _labelled(takes: list) -> list:
    return [take for take in takes if take.content]
