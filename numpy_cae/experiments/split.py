"""Windows to fit baselines to, windows to choose their settings on, and windows to measure on.

A baseline deserves its best setting (how many axes, how long a filter), and the honest place to
find it is not the test takes: every fifth training take is held back from a first fit and
settings are chosen on it; then the baseline is fitted to all training takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.experiments.clips import Clips, clips_of
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.manifold import MotionManifold

EVERY = 5
"""One training take in so many is chosen on."""
TRAINING_WINDOWS, CHOOSING_WINDOWS, TESTING_WINDOWS = 600, 48, 120
"""At most, spread evenly over all: more changes no figure by much and takes minutes."""


@dataclass(frozen=True)
class Split:
    """`fitting` and `choosing` are parts of `training`, by take; `testing` is of other takes.

    Parameters
    ----------
    fitting, choosing, training, testing : Clips
    sample : str
        What is measured on, in a sentence.
    takes : int
        To train on.
    """

    fitting: Clips
    choosing: Clips
    training: Clips
    testing: Clips
    sample: str
    takes: int

    def text(self) -> str:
        """What was measured on what, for below a table."""
        return f"{self.sample} {self.fitted()}"

    def fitted(self) -> str:
        """What baselines had to learn from; and the network, if it is not the same."""
        learned = self.training.manifold.settings.get("takes", self.takes)
        return (
            f"Baselines are fitted to {len(self.training)} windows of {self.takes} training "
            f"takes; their settings are chosen on every fifth of these takes, held back."
            + (
                f" The network learned from {learned} takes: not from the same."
                if learned != self.takes
                else ""
            )
        )


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
    """The windows to measure on, and a sentence that says which they are."""
    testing = _cut(manifold, material.testing, TESTING_WINDOWS)
    # Not all takes may be among them.
    takes = len(np.unique(testing.take))
    return testing, (
        f"Measured on {len(testing)} windows of {takes} takes that nothing was trained on."
    )


def _cut(manifold: MotionManifold, takes: Sequence[LabelledTake], most: int) -> Clips:
    return clips_of(manifold, [take.positions for take in takes]).evenly(most)


def split_takes(
    takes: Sequence[LabelledTake],
) -> tuple[list[LabelledTake], list[LabelledTake]]:
    """All takes but every fifth, and every fifth; at least one of both."""
    if len(takes) < 2:
        raise ValueError(f"{len(takes)} takes to train on, expected 2 or more to choose settings")
    chosen = set(range(EVERY - 1, len(takes), EVERY)) or {len(takes) - 1}
    return (
        [take for number, take in enumerate(takes) if number not in chosen],
        [take for number, take in enumerate(takes) if number in chosen],
    )
