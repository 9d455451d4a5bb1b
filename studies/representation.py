"""The representation of holden2015, sections 3 to 5, and what section 7 says that it cannot do.

    python -m studies representation --data bandai --test '*_005.bvh' -m best.npz

Sizes and bounds of the hidden units; the path that is integrated from the velocities; the bones and
the standing feet of a projection, which "cannot guarantee constraints such as ground contact and
joint lengths"; whether max pooling "provides a level of temporal invariance"; and the time of a
projection.
"""

from dataclasses import astuple
from timeit import repeat

import numpy as np

from numpy_cae import ops
from numpy_cae.manifold import MotionManifold, hidden_units
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.features import bone_lengths, change_lengths
from studies.shared.clips import testing_of
from studies.shared.material import Material, features_of
from studies.shared.result import Claim, Result, Table
from studies.shared.validity import Validity, ValidityMeasure

SIZES = [(80, 64), (40, 128), (20, 256)]
"""Frames and units of each layer for a window of 160 frames (section 5 and figure 3)."""
INTEGRATED = 0.01
"""INTEGRATED: a path is recovered if no joint is farther than this from its place (cm)."""
WINDOWS = 64
"""Windows that are projected together where a projection is timed."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure the test takes and their projections. The seed is not used."""
    network = manifold.network
    takes = features_of(manifold, material.testing)
    largest = max(float(np.abs(hidden_units(manifold, take)).max()) for take in takes)
    window = np.zeros((1, 160, 63), np.float32)
    sizes = [network.encode(window, layers=n + 1).shape[1:] for n in range(len(network.layers))]
    off = max(_integrated(manifold, take.positions) for take in material.testing)
    measure = ValidityMeasure(takes, manifold.lengths, manifold.rate)
    projected = Validity.mean([measure.of(manifold.project(take)) for take in takes])
    true = Validity.mean([measure.of(take) for take in takes])
    x = testing_of(manifold, material)[0].x[:WINDOWS]
    seconds = min(repeat(lambda: network.project(x), number=1, repeat=10)) / len(x)
    pooled, skipped = _changes(manifold, takes)
    rows = [["test takes", *astuple(true)], ["projected", *astuple(projected)]]
    return Result(
        "The representation and its limits",
        [Table("", ["motion", *Validity.HEADER], rows, Validity.FORMATS)],
        [
            Claim("units_bounded", largest <= 1, f"the largest of all is {largest:.3f}."),
            Claim("sizes", sizes == SIZES, f"{', '.join(f'{t} x {k}' for t, k in sizes)}."),
            Claim("path_integrated", off < INTEGRATED, f"at most {off:.1e} cm off."),
            Claim(
                "no_guarantee",
                projected.bone_length > true.bone_length
                and projected.foot_sliding > true.foot_sliding,
                f"{projected.against(true)} of the true motion.",
            ),
            Claim(
                "pooling_invariant",
                pooled < skipped,
                f"units of layer 1 change by {pooled:.3f} of their deviation;",
                opponent=f"without the maximum, every second frame: {skipped:.3f}.",
            ),
            Claim(
                "projected_fast",
                seconds < 1e-3,
                f"{1e3 * seconds:.2f} ms a window, {len(x)} together.",
            ),
        ],
    )


def _integrated(manifold: MotionManifold, positions: np.ndarray) -> float:
    """The largest distance between a motion and the one integrated from its features, cm."""
    body = change_lengths(positions, bone_lengths(positions), manifold.lengths)
    back = features_to_positions(*manifold.features(positions))
    return float(100 * np.linalg.norm(back - body, axis=-1).max())


def _changes(manifold: MotionManifold, takes: list[np.ndarray]) -> tuple[float, float]:
    """By how much a delay of one frame changes the units of layer 1, in deviations of the units:
    with max pooling, and with every second frame instead."""
    layer = manifold.network.layers[0]
    changes: list[list[float]] = [[], []]
    for take in takes:
        x = manifold.normalise(take[: len(take) // 2 * 2 - 1])[None]
        both = [np.pad(x, ((0, 0), ends, (0, 0)), mode="edge") for ends in ((0, 1), (1, 0))]
        maps = [ops.conv1d(each, layer.w, layer.b)[0] for each in both]
        for kind, pool in enumerate((lambda y: ops.max_pool(y)[0], lambda y: y[:, ::2])):
            here, delayed = (np.tanh(pool(each)) for each in maps)
            changes[kind].append(float(np.sqrt(np.mean((here - delayed) ** 2) / here.var())))
    return float(np.mean(changes[0])), float(np.mean(changes[1]))
