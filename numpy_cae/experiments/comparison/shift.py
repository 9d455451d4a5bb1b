"""Is G "temporally invariant" (holden2015, section 7)? A window is compared with the same take some
frames later, and that distance is set beside its distances to other takes.

Both distances are taken as √G and as it is, so that both are lengths. What a shift of 40 frames
shows at the end of a window of 160 is new: no distance that sees motion at all can stay at zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from numpy_cae.experiments.comparison.distances import equation_4, euclidean, raw_extremes
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material, evenly
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.measures.retrieval import bootstrapped_difference
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, save_figure

ENOUGH = 80
"""Takes to shift, spread evenly over those that are long enough."""
SHIFTS = (1, 2, 5, 10, 15, 20, 30, 40)
_COLOURS = (PROJECTED, CORRUPTED, PLAIN)


@dataclass(frozen=True)
class Shift:
    """How far a shifted window is from itself.

    Parameters
    ----------
    moved : distance to (takes, shifts) array
        The distance to itself, shifted, as a share of its median distance to other takes.
    itself : distance to (takes, shifts) array of bool
        Whether it is nearer to itself, shifted, than to every other take.
    window : int
        Frames.
    seed : int
        Of the resampling.
    """

    moved: dict[str, np.ndarray]
    itself: dict[str, np.ndarray]
    window: int
    seed: int
    title: str = "Motion comparison: a clip shifted in time"

    @property
    def takes(self) -> int:
        """How many were long enough."""
        return len(next(iter(self.moved.values())))

    def text(self) -> str:
        """A row for every shift."""
        rows = [
            [str(shift), *[
                f"{moved[:, n].mean():.2f} ({self.itself[name][:, n].mean():.0%})"
                for name, moved in self.moved.items()
            ]]
            for n, shift in enumerate(SHIFTS)
        ]  # fmt: skip
        return (
            f"Windows of {self.window} frames of {self.takes} held-out takes: the distance to the "
            "same take so many frames later, as a share of the median distance to other takes "
            "(and in how many of the takes it is nearer than every other take):\n\n"
            f"{text_table(['frames later', *self.moved], rows)}"
        )

    def findings(self) -> list[Finding]:
        """Whether G moves less than the Euclidean distance does, and less than without network."""
        ours, *others = self.moved
        claims = {
            others[0]: "G is temporally invariant where Euclidean distance is not (holden2015, "
            "section 7): at every shift it moves less.",
            others[1]: "The learned manifold, not the pooling alone, makes G temporally invariant "
            "(implied by holden2015, section 7): at every shift it moves less than without one.",
        }
        return [self._moves_less(ours, other, claim) for other, claim in claims.items()]

    def _moves_less(self, ours: str, other: str, claim: str) -> Finding:
        gaps = [
            bootstrapped_difference(self.moved[ours][:, n], self.moved[other][:, n], self.seed)
            for n in range(len(SHIFTS))
        ]
        middle = SHIFTS.index(10)
        said = "; ".join(
            f"{SHIFTS[n]} frames later {self.moved[ours][:, n].mean():.2f} of the distance to "
            f"others against {self.moved[other][:, n].mean():.2f}, difference {gaps[n].text()}, "
            f"nearer than every other take in {self.itself[ours][:, n].mean():.0%} against "
            f"{self.itself[other][:, n].mean():.0%}"
            for n in (0, middle, len(SHIFTS) - 1)
        )
        return Finding(claim, all(gap.high < 0 for gap in gaps), said + ".")

    def save_picture(self, path: str | Path) -> None:
        """Lines over the shift, with the middle half of the takes about them, PNG."""
        figure = Figure(figsize=(8, 4.5), layout="constrained")
        axes = figure.add_subplot()
        for (name, moved), colour in zip(self.moved.items(), _COLOURS, strict=True):
            low, high = np.quantile(moved, [0.25, 0.75], axis=0)
            axes.fill_between(SHIFTS, low, high, color=colour, alpha=0.15, linewidth=0)
            axes.plot(SHIFTS, moved.mean(axis=0), color=colour, label=name, marker="o")
        axes.axhline(1, color=PLAIN, linewidth=0.8, linestyle=":")
        axes.annotate("another take", (SHIFTS[-1], 1), ha="right", va="bottom", fontsize=8)
        axes.set(xlabel="frames later", ylabel="distance to itself / to others", ylim=(0, 1.3))
        axes.legend(frameon=False, fontsize=9)
        axes.spines[["top", "right"]].set_visible(False)
        save_figure(figure, path)


def shift(manifold: MotionManifold, material: Material, seed: int = 0) -> Shift:
    """Shift the first window of every held-out take that is long enough.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
    seed : int
        Of the resampling.

    Raises
    ------
    ValueError
        If fewer than two held-out takes are long enough.
    """
    window = manifold.settings["window"]
    needed = window + SHIFTS[-1]
    takes = [take.positions for take in material.testing if len(take.positions) >= needed]
    if len(takes) < 2:
        raise ValueError(
            f"a shift needs two held-out takes of {needed} frames, there are {len(takes)}"
        )
    clips = [manifold.features(take)[0] for take in evenly(takes, ENOUGH)]
    first = [clip[:window] for clip in clips]
    moved, itself = {}, {}
    for way in (equation_4(manifold), euclidean(manifold), raw_extremes(manifold)):
        own = way.between(first)
        others = np.where(np.eye(len(own), dtype=bool), np.nan, own)
        later = np.array(
            [
                way.between([clip[:window]], [clip[n : n + window] for n in SHIFTS])[0]
                for clip in clips
            ]
        )
        moved[way.name] = later / np.nanmedian(others, axis=1, keepdims=True)
        itself[way.name] = later < np.nanmin(others, axis=1, keepdims=True)
    return Shift(moved, itself, window, seed)
