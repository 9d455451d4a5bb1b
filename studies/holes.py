"""Holes of several lengths in takes without damage, filled by `fill` and by the rotation curves of
animation programs.

    python -m studies holes --data bandai --test '*_003.bvh'
    python -m studies holes --data bandai --test '*_003.bvh' --takes 6 --parts wrist leg

Each take has one hole of each part and length; a take that is less than a second longer than the
hole is left out. `fill` and the curves are given the mask. `fill` has a regression on the visible
joints of the take (Gløersen and Federolf 2016; the equation is in numpy_cae/motion/regression.py),
weighed in trial holes. docs/lab_book/filling.md has the findings.

An error is the mean distance of the missing joints from their true positions, by forward kinematics
in the rig and the frames of the file. The ratio is the error of `fill` divided by that of a curve,
the geometric mean over the holes. The best curve is that with the largest ratio: the one with the
smallest error, as a geometric mean, in holes of this part and length.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from numpy_cae.cleanup import fill_motion
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import body_positions
from numpy_cae.motion import JOINTS, RATE, Motion
from numpy_cae.motion.joints import LIMBS, joint_mask
from studies.damage import CURVES, curve_filling
from studies.shared.charts import draw_ratios_by_length
from studies.shared.damages import stretch
from studies.shared.material import Material, evenly
from studies.shared.result import Claim, Picture, Result, Table

HOLES = (10, 20, 45, 90)
"""Lengths of holes, in frames at 30 a second."""
PARTS: dict[str, tuple[Sequence[str], float]] = {
    "wrist": (("left_wrist",), 1.0),
    "arm": (LIMBS["left_arm"], 0.95),
    "leg": (LIMBS["left_leg"], 0.8),
    "whole body": (JOINTS, 1.0),
}
"""Name of a part to its joints, which are missing in the holes, and the share of the error of the
best rotation curve that `fill` may have."""
LEAST_ERROR = 0.02
"""In ratios, smaller errors (cm) count as this; joints at rest are filled exactly."""
RATIO = "ratio"
FILL = "`fill`"
HEADER = ("", "holes", "`fill`, cm", "best curve, cm", RATIO, "best curve")
Errors = dict[str, dict[str, list[float]]]
"""Part and length to method to the error (cm) in each hole."""


def run(
    manifold: MotionManifold,
    material: Material,
    takes: int = 24,
    parts: tuple[str, ...] = tuple(PARTS),
    seed: int = 0,
) -> Result:
    """Fill holes in at most `takes` test takes of each source; `seed` draws their places."""
    if takes < 1:
        raise ValueError(f"--takes is {takes}, expected 1 or more")
    for part in parts:
        if part not in PARTS:
            raise ValueError(f"no part {part}: --parts has some of {', '.join(PARTS)}")
    parts_in_order = [part for part in PARTS if part in parts]
    tables = []
    claims = []
    figures = {}
    for source in dict.fromkeys(take.source for take in material.testing):
        chosen = evenly(material.of(source).testing, takes)
        motions = [material.motion(take) for take in chosen]
        errors = errors_in_holes(manifold, motions, parts_in_order, seed)
        if errors:
            caption = f"{source}, {len(motions)} takes: error of `fill` and of the best curve."
            table = Table(caption, HEADER, rows_of(errors))
            tables.append(table)
            claims += claims_of(table, source)
            draw = partial(draw_ratios_by_length, table, RATIO)
            figures[f"holes_{source}"] = Picture(draw)
    if not tables:
        raise ValueError(f"no test take is long enough for a hole of {min(HOLES)} frames")
    return Result("Holes filled by fill and by rotation curves", tables, claims, figures)


def errors_in_holes(
    manifold: MotionManifold, motions: Sequence[Motion], parts: Sequence[str], seed: int
) -> Errors:
    """The errors of `fill` and of each curve in one hole of each part and length in each motion."""
    errors: Errors = defaultdict(lambda: defaultdict(list))
    for part in parts:
        joints, _ = PARTS[part]
        for frames in HOLES:
            for number, motion in enumerate(motions):
                if motion.seconds < frames / RATE + 1:
                    continue
                rng = np.random.default_rng([seed, number, frames])
                hole = stretch(motion, frames / RATE, rng)
                mask = joint_mask(len(motion), joints, hole)
                of_hole = errors[f"{part}, {frames} frames"]
                filled = fill_motion(motion, manifold, mask).motion
                of_hole[FILL].append(error_of(filled, motion, mask))
                for name, curve in CURVES.items():
                    filled = curve_filling(curve, motion, mask)
                    of_hole[name].append(error_of(filled, motion, mask))
    return errors


def error_of(filled: Motion, truth: Motion, mask: np.ndarray) -> float:
    """The mean distance (cm) between both motions at the joints of a mask (frames, 20)."""
    off = body_positions(filled) - body_positions(truth)
    distances = np.linalg.norm(off, axis=-1)
    return float(100 * distances[mask].mean())


def geometric_mean(errors: Sequence[float]) -> float:
    """That of errors (cm), of which those below `LEAST_ERROR` count as this."""
    return float(np.exp(np.mean(np.log(np.maximum(errors, LEAST_ERROR)))))


def rows_of(errors: Errors) -> list[list[object]]:
    """A row for each part and length."""
    rows: list[list[object]] = []
    for hole, by_method in errors.items():
        best = min(CURVES, key=lambda name: geometric_mean(by_method[name]))
        filled = by_method[FILL]
        by_curve = by_method[best]
        ratio = geometric_mean(filled) / geometric_mean(by_curve)
        curve_name = best.split()[0]
        rows.append([hole, len(filled), np.mean(filled), np.mean(by_curve), ratio, curve_name])
    return rows


def claims_of(table: Table, source: str) -> Iterator[Claim]:
    """Whether `fill` has small enough a share of the error of the best curve, for each part."""
    column = HEADER.index(RATIO)
    for part, (_, most) in PARTS.items():
        ratios = {str(row[0]): row[column] for row in table.rows if str(row[0]).startswith(part)}
        if ratios:
            figures = ", ".join(f"{hole} {ratio:.2f}" for hole, ratio in ratios.items())
            is_fulfilled = all(ratio <= most for ratio in ratios.values())
            yield Claim("holes_filled", is_fulfilled, f"{figures}.", f"{source}, {part}")
