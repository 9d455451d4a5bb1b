"""Whether G is "temporally invariant" (holden2015, section 7): the distance of a window to the same
take some frames later, as a share of its distance to other takes.

A window of 160 frames, 40 frames later, ends with 40 new frames: no distance that sees motion can
stay at zero. √G is used, so that all distances are lengths.
"""

import numpy as np

from numpy_cae.evaluation.retrieval import bootstrapped_difference
from numpy_cae.experiments.comparison.distances import (
    EQUATION_4,
    EUCLIDEAN,
    RAW_EXTREMES,
    equation_4,
    euclidean,
    raw_extremes,
)
from numpy_cae.experiments.material import Material, evenly
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, Curve, curves_figure

TAKES = 80
"""At most, spread evenly over those that are long enough."""
SHIFTS = (1, 2, 5, 10, 15, 20, 30, 40)
CLAIMS = {
    EUCLIDEAN: "G is temporally invariant where Euclidean distance is not (holden2015, section 7): "
    "at every shift it changes less.",
    RAW_EXTREMES: "The learned manifold, not the pooling alone, makes G temporally invariant "
    "(implied by holden2015, section 7): at every shift it changes less than without a network.",
}
"""The distance that G is compared with, and the claim."""
_COLOURS = (PROJECTED, CORRUPTED, PLAIN)


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Shift the first window of every test take that is long enough; the seed is for resampling."""
    window = manifold.window
    needed = window + SHIFTS[-1]
    takes = [take.positions for take in material.testing if len(take.positions) >= needed]
    if len(takes) < 2:
        raise ValueError(
            f"a shift needs two held-out takes of {needed} frames, there are {len(takes)}"
        )
    clips = [manifold.features(take)[0] for take in evenly(takes, TAKES)]
    moved = shifted(manifold, clips, window)
    rows = [
        [str(shift), *(float(each[:, n].mean()) for each in moved.values())]
        for n, shift in enumerate(SHIFTS)
    ]
    caption = (
        f"Windows of {window} frames of {len(clips)} test takes: the distance to the same take so "
        "many frames later, as a share of the median distance to other takes:"
    )

    def figure():
        curves = [
            Curve(SHIFTS, each.mean(axis=0), name, colour, "o-")
            for (name, each), colour in zip(moved.items(), _COLOURS, strict=True)
        ]
        return curves_figure(curves, "frames later", "distance to itself / to others")

    return Result(
        "Motion comparison: a clip shifted in time",
        [Table(caption, ["frames later", *moved], rows)],
        [_claim(other, sentence, moved, seed) for other, sentence in CLAIMS.items()],
        figure,
    )


def shifted(
    manifold: MotionManifold, clips: list[np.ndarray], window: int
) -> dict[str, np.ndarray]:
    """For each distance, that of a clip to itself after each of `SHIFTS`, (clips, shifts), as a
    share of the median distance to other clips."""
    first = [clip[:window] for clip in clips]
    moved = {}
    for distance in (equation_4(manifold), euclidean(manifold), raw_extremes(manifold)):
        own = distance.between(first)
        others = np.where(np.eye(len(own), dtype=bool), np.nan, own)
        later = np.concatenate(
            [
                distance.between([clip[:window]], [clip[n : n + window] for n in SHIFTS])
                for clip in clips
            ]
        )
        moved[distance.name] = later / np.nanmedian(others, axis=1, keepdims=True)
    return moved


def _claim(other: str, sentence: str, moved: dict[str, np.ndarray], seed: int) -> Claim:
    """G, the first distance, against another."""
    gaps = [
        bootstrapped_difference(moved[EQUATION_4][:, n], moved[other][:, n], seed)
        for n in range(len(SHIFTS))
    ]
    figures = "; ".join(
        f"{SHIFTS[n]} frames later {moved[EQUATION_4][:, n].mean():.2f} of the distance to others "
        f"against {moved[other][:, n].mean():.2f}, difference {gaps[n].text()}"
        for n in (0, SHIFTS.index(10), len(SHIFTS) - 1)
    )
    return Claim(sentence, all(gap.high < 0 for gap in gaps), f"{figures}.")
