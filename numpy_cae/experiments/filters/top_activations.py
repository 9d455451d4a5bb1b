"""The test takes in which each unit of the deepest layer is largest: whether a filter corresponds
to a "natural … component of motion" (holden2015, section 6)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold, hidden_units
from numpy_cae.measures.retrieval import bootstrapped_difference
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, local_actors, strip_figure

TOP = 5
"""Takes with the largest values of a unit, whose labels are compared."""
UNITS, ROWS, FRAMES = 3, 3, 54
"""Units drawn, takes of each, frames around the largest value: half of what a unit sees."""
_COLOURS = (PROJECTED, CORRUPTED, TRUTH)


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Compare the labels of the takes in which a unit is largest.

    Labelled test takes are used where there are any. The seed is for the untrained network, for
    takes drawn at random and for the resampling. Raises ValueError for fewer than `TOP` takes.
    """
    takes = [take for take in material.testing if take.content] or material.testing
    if len(takes) < TOP:
        raise ValueError(f"top_activations needs {TOP} held-out takes, there are {len(takes)}")
    clips = [manifold.features(take.positions)[0] for take in takes]
    largest, moment = _largest(manifold, clips)
    before, _ = _largest(untrained(manifold, seed), clips)
    drawn = np.random.default_rng(seed).random(largest.shape)
    values = {"trained": largest, "untrained": before, "drawn at random": drawn}
    rows, claims = [[name] for name in values], []
    for label in ("content", "style"):
        labels = [getattr(take, label) for take in takes]
        shares = [label_agreement(each, labels) for each in values.values()]
        for row, share in zip(rows, shares, strict=True):
            row.append(share.mean())
        claims.append(_claim(label, *shares, seed))
    top = np.argsort(-largest, axis=0, kind="stable")[:ROWS].T
    chosen = np.argsort(-largest.std(axis=0), kind="stable")[:UNITS]  # those that vary most
    motions = {
        f"unit {unit + 1}, {rank}: {_name(takes[take])} ({largest[take, unit]:.2f})": (
            _around(clips[take], moment[take, unit]),
            colour,
        )
        for unit, colour in zip(chosen, _COLOURS, strict=False)
        for rank, take in enumerate(top[unit], 1)
    }
    caption = (
        f"Of the {TOP} takes, of {len(takes)} test takes, in which a unit is largest, the share "
        f"with their commonest label, mean over {largest.shape[1]} units:"
    )
    return Result(
        "Motions with the largest activations",
        [Table(caption, ["takes", "content", "style"], rows)],
        claims,
        lambda: strip_figure(local_actors(motions), manifold.rate, azimuth=55.0),
    )


def _claim(
    label: str, trained: np.ndarray, before: np.ndarray, drawn: np.ndarray, seed: int
) -> Claim:
    gap = bootstrapped_difference(trained, before, seed)
    return Claim(
        "Each filter corresponds to a natural component of motion (holden2015, section 6): the "
        f"motions in which a unit is largest agree in {label}, more than for an untrained one.",
        gap.low > 0,
        f"{trained.mean():.2f} of the top {TOP} have one label, {before.mean():.2f} untrained, "
        f"{drawn.mean():.2f} at random; difference {gap.text()}, resampling units.",
    )


def _largest(
    manifold: MotionManifold, clips: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """The largest value of each unit in each clip, and the middle of the frames that it pools."""
    units = [hidden_units(manifold, clip) for clip in clips]
    width = manifold.network.frames_per_unit
    place = np.array([each.argmax(axis=0) for each in units])
    return np.array([each.max(axis=0) for each in units]), place * width + width // 2


def label_agreement(largest: np.ndarray, labels: Sequence[str]) -> np.ndarray:
    """The share of the commonest label among the top takes of each unit; (takes, units) to
    (units,)."""
    tops = np.argsort(-largest, axis=0, kind="stable")[:TOP].T
    common = [Counter(labels[take] for take in top).most_common(1)[0][1] for top in tops]
    return np.array(common) / TOP


def _around(clip: np.ndarray, moment: int) -> np.ndarray:
    """`FRAMES` frames of a clip around a moment; a shorter clip is padded with its last pose."""
    start = int(np.clip(moment - FRAMES // 2, 0, max(len(clip) - FRAMES, 0)))
    return clip[np.minimum(np.arange(start, start + FRAMES), len(clip) - 1)]


def _name(take: LabelledTake) -> str:
    return f"{take.content}, {take.style}" if take.content else take.path.stem
