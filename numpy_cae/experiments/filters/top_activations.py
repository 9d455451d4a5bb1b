"""The test takes in which each unit of the deepest layer is largest: whether a filter corresponds
to a "natural … component of motion" (holden2015, section 6)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.drawn_motions import strips
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold, hidden_units
from numpy_cae.measures.retrieval import bootstrapped_difference
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH

TOP = 5
"""Takes with the largest values of a unit, whose labels are compared."""
UNITS, ROWS, FRAMES = 3, 3, 54
"""Units drawn, takes of each, frames around the largest value: half of what a unit sees."""
_COLOURS = (PROJECTED, CORRUPTED, TRUTH)
TRAINED, UNTRAINED, RANDOM = "trained", "untrained", "drawn at random"


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
    values = {TRAINED: largest, UNTRAINED: before, RANDOM: drawn}
    agreement = {
        label: {
            name: label_agreement(each, [getattr(take, label) for take in takes])
            for name, each in values.items()
        }
        for label in ("content", "style")
    }
    top = np.argsort(-largest, axis=0, kind="stable")[:TOP].T
    chosen = _distinct_units(largest, top)
    unit_rows = [
        [f"unit {unit + 1}", *(
            f"{_name(takes[take])} ({largest[take, unit]:.2f})" for take in top[unit, :ROWS]
        )]
        for unit in chosen
    ]  # fmt: skip
    shares = [[name, *(each[name].mean() for each in agreement.values())] for name in values]
    motions = {
        f"unit {unit + 1}: {_name(takes[take])} ({rank})": (
            _around(clips[take], moment[take, unit]),
            colour,
        )
        for unit, colour in zip(chosen, _COLOURS, strict=False)
        for rank, take in enumerate(top[unit, :ROWS], 1)
    }
    ranks = [str(rank) for rank in range(1, ROWS + 1)]
    return Result(
        "Motions with the largest activations",
        [
            Table(
                f"Takes, of {len(takes)} test takes, in which a unit is largest:",
                ["unit", *ranks],
                unit_rows,
            ),
            Table(
                f"Of the {TOP} takes in which a unit is largest, the share with their commonest "
                f"label, mean over {largest.shape[1]} units:",
                ["takes", *agreement],
                shares,
            ),
        ],
        [_claim(label, each, seed) for label, each in agreement.items()],
        strips(motions, manifold.rate),
    )


def _claim(label: str, agreement: dict[str, np.ndarray], seed: int) -> Claim:
    trained, before, drawn = (agreement[name] for name in (TRAINED, UNTRAINED, RANDOM))
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


def _distinct_units(largest: np.ndarray, top: np.ndarray) -> list[int]:
    """The units whose values vary most, without a top take in common."""
    chosen: list[int] = []
    seen: set[int] = set()
    for unit in np.argsort(-largest.std(axis=0), kind="stable"):
        takes = set(top[unit, :ROWS].tolist())
        if not takes & seen:
            chosen.append(int(unit))
            seen |= takes
        if len(chosen) == UNITS:
            break
    return chosen


def _around(clip: np.ndarray, moment: int) -> np.ndarray:
    """`FRAMES` frames of a clip around a moment; a shorter clip is padded with its last pose."""
    start = int(np.clip(moment - FRAMES // 2, 0, max(len(clip) - FRAMES, 0)))
    return clip[np.minimum(np.arange(start, start + FRAMES), len(clip) - 1)]


def _name(take: LabelledTake) -> str:
    return f"{take.content}, {take.style}" if take.content else take.path.stem
