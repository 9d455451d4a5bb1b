"""Normalised windows of takes, and the errors of repaired windows against them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.evaluation import position_error
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.shifted_projection import WINDOWS_AT_ONCE, project_shifted
from numpy_cae.motion.windows import cut_windows

NETWORK, REPEATED = "the network", "the network, ends repeated"
AVERAGED = "the network, ends repeated, averaged over all shifts"
"""Names in tables: `project`, `project_repeated` once, and averaged over all shifts of the pooling
grid."""
CHOOSING_EVERY = 5
"""Of this many training takes, one is used to choose settings."""
TRAINING_WINDOWS, CHOOSING_WINDOWS, TESTING_WINDOWS = 600, 48, 120
"""Maximum numbers of windows, evenly spaced; more would take minutes and hardly change the
results."""


@dataclass(frozen=True)
class Clips:
    """The true windows with which repaired windows are compared."""

    manifold: MotionManifold  # gives the mean skeleton and the scale
    x: np.ndarray  # X: normalised windows (N, T, 63); zero is the mean pose
    real: np.ndarray  # (N, T) bool: frames that count, not those that pad a short take
    take: np.ndarray  # (N,) number of the take of each window

    def __len__(self) -> int:
        return len(self.x)

    def error(self, x: np.ndarray, joint: str | None = None) -> float:
        """The `position_error` of windows, cm, over all joints or one."""
        squares, frames = [], []
        for first in range(0, len(x), WINDOWS_AT_ONCE):
            part = slice(first, first + WINDOWS_AT_ONCE)
            gap = (x[part] - self.x[part]) / self.manifold.scale  # the mean pose cancels
            frames.append(np.count_nonzero(self.real[part]))
            if frames[-1]:
                error = position_error(gap, np.zeros(gap.shape[-1]), self.real[part], joint)
                squares.append(error**2 * frames[-1])
        return float(np.sqrt(sum(squares) / sum(frames)))

    def evenly(self, count: int) -> Clips:
        """At most `count` of the windows, evenly spaced."""
        chosen = np.linspace(0, len(self) - 1, min(count, len(self))).round().astype(int)
        return replace(self, x=self.x[chosen], real=self.real[chosen], take=self.take[chosen])


def clips_of(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> Clips:
    """Cut world positions (F, 20, 3) of takes into windows of the manifold's length.

    The windows overlap by half, whatever the overlap in training, so that two networks are measured
    on the same windows. ValueError if there are no takes.
    """
    if not takes:
        raise ValueError("there are no takes to cut into windows")
    length = manifold.window
    windows, reals = [], []
    for take in takes:
        cut, real = cut_windows(manifold.features(take)[0], length, length // 2)
        windows.append(manifold.normalise(cut))
        reals.append(real)
    numbers = np.repeat(np.arange(len(windows)), [len(each) for each in windows])
    return Clips(manifold, np.concatenate(windows), np.concatenate(reals), numbers)


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
