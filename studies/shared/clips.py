"""The windows of a material: to fit baselines to, to choose settings on, to measure on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.evaluation.clips import Clips, clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.shifted_projection import project_shifted
from studies.shared.material import LabelledTake, Material

NETWORK, REPEATED = "the network", "the network, ends repeated"
AVERAGED = "the network, ends repeated, averaged over all shifts"
"""Names in tables: `project`, `project_repeated` once, and averaged over all shifts of the pooling
grid."""
CHOOSING_EVERY = 5
"""Of this many training takes, one is used to choose settings."""
TRAINING_WINDOWS, CHOOSING_WINDOWS, TESTING_WINDOWS = 600, 48, 120
"""Maximum numbers of windows, evenly spaced; more would take minutes and hardly change the
results."""


def project_repeated(
    manifold: MotionManifold, x: np.ndarray, average_shifts: bool = False
) -> np.ndarray:
    """Φ†(Φ(X)) of windows padded with their first and last frames, as `MotionManifold.project`
    pads a clip; with `average_shifts` averaged over all shifts of the pooling grid."""
    projected = project_shifted(manifold.network, manifold.padded(x), average_shifts)
    return manifold.unpadded(projected, x.shape[1])


@dataclass(frozen=True)
class Split:
    """Windows to fit baselines to, to choose their settings on, and to measure on.

    `fitting` and `choosing` have the windows of different takes of `training`; `testing` has the
    windows of other takes, which `sample` describes in a sentence. A baseline is fitted to
    `fitting`, and its setting (number of axes, length of a filter) is chosen on `choosing`. Then
    the baseline with this setting is fitted to `training`.
    """

    fitting: Clips
    choosing: Clips
    training: Clips
    testing: Clips
    sample: str

    def fitted(self) -> str:
        """Sentences that say on what the baselines were fitted and the network was trained."""
        takes = 1 + int(self.training.take.max())
        learned = self.training.manifold.settings.get("takes", takes)
        return (
            f"Baselines are fitted to {len(self.training)} windows of {takes} training takes; "
            "their settings are chosen on every fifth of these takes, held back. The network "
            f"learned from {learned} takes: if they are of another source, the baselines know this "
            "one better."
        )


def split_of(manifold: MotionManifold, material: Material) -> Split:
    """Cut the takes of a material into windows; ValueError if there are fewer than two to train on
    or none to test on."""
    fitting, choosing = split_takes(material.training)
    testing, sample = testing_of(manifold, material)
    return Split(
        _cut(manifold, fitting, TRAINING_WINDOWS),
        _cut(manifold, choosing, CHOOSING_WINDOWS),
        _cut(manifold, material.training, TRAINING_WINDOWS),
        testing,
        sample,
    )


def testing_of(manifold: MotionManifold, material: Material) -> tuple[Clips, str]:
    """The windows to measure on, and a sentence that describes them."""
    testing = _cut(manifold, material.testing, TESTING_WINDOWS)
    takes = len(np.unique(testing.take))
    return testing, f"Measured on {len(testing)} windows of {takes} takes not used in training."


def _cut(manifold: MotionManifold, takes: Sequence[LabelledTake], most: int) -> Clips:
    return clips_of(manifold, [take.positions for take in takes]).evenly(most)


def split_takes(takes: Sequence[LabelledTake]) -> tuple[list[LabelledTake], list[LabelledTake]]:
    """All takes but every fifth, and every fifth take; each list has at least one take."""
    if len(takes) < 2:
        raise ValueError(f"{len(takes)} takes to train on, expected 2 or more to choose settings")
    chosen = range(CHOOSING_EVERY - 1, len(takes), CHOOSING_EVERY) or [len(takes) - 1]
    fitting = [take for number, take in enumerate(takes) if number not in chosen]
    return fitting, [takes[number] for number in chosen]
