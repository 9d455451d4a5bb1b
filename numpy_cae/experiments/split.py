"""Windows to fit baselines to, to choose their settings on, and to measure on.

Every fifth training take is held back from a first fit of a baseline; its setting (number of axes,
length of a filter) is chosen on these takes; then it is fitted to all training takes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from numpy_cae.baselines import Moments
from numpy_cae.experiments.clips import Clips, clips_of
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.manifold import MotionManifold

CHOOSING_EVERY = 5
"""One in so many training takes is used to choose settings."""
TRAINING_WINDOWS, CHOOSING_WINDOWS, TESTING_WINDOWS = 600, 48, 120
"""At most, spread evenly over all: more windows change no figure by much and take minutes."""


@dataclass(frozen=True)
class Split:
    """`fitting` and `choosing` are parts of `training`, by take; `testing` has other takes.

    `sample` describes the testing windows in a sentence; `takes` is the number of training takes.
    """

    fitting: Clips
    choosing: Clips
    training: Clips
    testing: Clips
    sample: str
    takes: int

    @cached_property
    def moments(self) -> Moments:
        """Of the training windows, for linear denoisers."""
        return Moments.of(self.training.x, self.training.real)

    def text(self) -> str:
        """What was measured on which windows, to stand below a table."""
        return f"{self.sample} {self.fitted()}"

    def fitted(self) -> str:
        """What the baselines were fitted to, and the network if that differs."""
        learned = self.training.manifold.settings.get("takes", self.takes)
        text = (
            f"Baselines are fitted to {len(self.training)} windows of {self.takes} training "
            f"takes; their settings are chosen on every fifth of these takes, held back."
        )
        if learned != self.takes:
            text += f" The network learned from {learned} takes, not the same ones."
        return text


def split_of(manifold: MotionManifold, material: Material) -> Split:
    """Cut the takes of a material into windows.

    Raises
    ------
    ValueError
        If there are fewer than two takes to train on or none to test on.
    """
    fitting, choosing = split_takes(material.training)
    testing, sample = testing_of(manifold, material)
    return Split(
        _cut(manifold, fitting, TRAINING_WINDOWS),
        _cut(manifold, choosing, CHOOSING_WINDOWS),
        _cut(manifold, material.training, TRAINING_WINDOWS),
        testing,
        sample,
        len(material.training),
    )


def testing_of(manifold: MotionManifold, material: Material) -> tuple[Clips, str]:
    """The windows to measure on, and a sentence that describes them."""
    testing = _cut(manifold, material.testing, TESTING_WINDOWS)
    takes = len(np.unique(testing.take))
    return testing, f"Measured on {len(testing)} windows of {takes} takes not used in training."


def _cut(manifold: MotionManifold, takes: Sequence[LabelledTake], most: int) -> Clips:
    return clips_of(manifold, [take.positions for take in takes]).evenly(most)


def split_takes(takes: Sequence[LabelledTake]) -> tuple[list[LabelledTake], list[LabelledTake]]:
    """All takes but every fifth, and every fifth; at least one of both."""
    if len(takes) < 2:
        raise ValueError(f"{len(takes)} takes to train on, expected 2 or more to choose settings")
    every = CHOOSING_EVERY
    chosen = set(range(every - 1, len(takes), every)) or {len(takes) - 1}
    return (
        [take for number, take in enumerate(takes) if number not in chosen],
        [take for number, take in enumerate(takes) if number in chosen],
    )
