"""Damage of seven kinds in the rig of the file, repaired blindly, told what is damaged, and by
simple methods; and what repair does to motions without damage.

Positions are those of forward kinematics in the file's rig, in the frames of the file. An error is
the mean distance of a joint from its true position over the damaged joints and frames.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from numpy_cae.experiments.material import LabelledTake, Material, evenly
from numpy_cae.experiments.repair import damage_methods as methods
from numpy_cae.experiments.repair.damaged_motion import DAMAGES, stretch
from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.manifold import MotionManifold, project_motion, repair
from numpy_cae.measures import foot_sliding
from numpy_cae.motion import PARENTS, Mappings, Motion, body_of, body_positions
from numpy_cae.motion.joints import LIMBS, joint_mask
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, TRUTH, Actor, bars_figure

TAKES, HOLE_TAKES = 10, 16
"""At most, of each source: damaged, and with holes."""
HOLES = (15, 45, 60, 90)
"""Frames at 30 a second."""
HOLE_JOINTS = {"wrist": ("left_wrist",), "leg": LIMBS["left_leg"], "arm": LIMBS["left_arm"]}
DAMAGED, BLIND, TOLD = "as damaged", "repair", "repair, told"
SPLINE, PCA, PLAIN_ROW = "spline, told", "PCA, told", "plain projection"
JITTER = "jitter"
REMAINS = {
    "frozen in channels": 13 / 19,
    "frozen in the world": 13 / 19,
    "spikes": 1 / 20,
    "twisted leg": 12 / 56,
}
"""Share of the damage that blind repair may leave."""
CAPTION = (
    "error over the damaged joints and frames, cm. Told methods are given these joints and frames. "
    "`repair` also smooths where the damage is jitter"
)
Errors = dict[str, dict[str, float]]
"""Method to kind of damage to cm; where a method does not apply there is no value."""


@dataclass(frozen=True)
class Clean:
    """What repair does to takes without damage: mean change of a joint in cm, share of the joints
    and frames that it touched, sliding of the standing foot before and after in cm/s, the change
    by plain projection in cm, and the share of takes that the model says it knows."""

    change: float
    touched: float
    sliding: float
    sliding_after: float
    plain: float
    known: float


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Damage test takes of each source and repair them; `seed` draws the damage."""
    pca = methods.pca(manifold, material.training)
    tables, claims, figures = [], [], []
    moving = None
    for source in dict.fromkeys(take.source for take in material.testing):
        takes = evenly(material.of(source).testing, TAKES)
        trials = _Trials(manifold, material.mapping, pca, seed)
        for number, take in enumerate(takes):
            truth = material.motion(take)
            for kind in DAMAGES:
                trials.add(truth, kind, number)
        errors, elsewhere = (_mean(each) for each in (trials.errors, trials.elsewhere))
        clean = _clean(manifold, material, takes)
        holes = _holes(manifold, material, source, seed)
        name = f"{source}, {len(takes)} takes"
        tables += _tables(name, errors, elsewhere, _mean(trials.found), clean, holes)
        claims += _claims(name, errors, elsewhere, clean, holes)
        figures.append((source, errors))
        moving = moving or trials.animation
    return Result(
        "Repair: damage in the file's own rig",
        tables,
        claims,
        lambda: _figure(*figures[0]),
        moving,
        f"The network learned from {manifold.settings.get('takes')} takes, PCA from "
        f"{len(material.training)}.",
    )


class _Trials:
    """The errors of every method on damaged takes."""

    def __init__(self, manifold: MotionManifold, mapping: Mappings, pca, seed: int):
        self.manifold, self.mapping, self.pca, self.seed = manifold, mapping, pca, seed
        self.errors, self.elsewhere, self.found = (
            defaultdict(lambda: defaultdict(list)) for _ in range(3)
        )
        self.animation: Animation | None = None

    def add(self, truth: Motion, kind: str, number: int) -> None:
        """Damage a take and repair it by every method."""
        rng = np.random.default_rng([self.seed, number])
        damaged, mask = DAMAGES[kind](truth, self.mapping, rng)
        true, before = (body_positions(motion, self.mapping) for motion in (truth, damaged))
        repaired, touched = self._repaired(damaged, mask, kind)
        for name, motion in repaired.items():
            after = body_positions(motion, self.mapping)
            self.errors[name][kind].append(100 * _distance(after, true)[mask].mean())
            if not mask.all():
                self.elsewhere[name][kind].append(100 * _distance(after, before)[~mask].mean())
        self.found["of the damage"][kind].append(100 * touched[mask].mean())
        if not mask.all():
            self.found["of the rest"][kind].append(100 * touched[~mask].mean())
        if kind == "twisted leg" and self.animation is None:
            shown = (damaged, "damaged", CORRUPTED), (repaired[BLIND], "repaired", PROJECTED)
            actors = [
                Actor(body_of(motion, self.mapping), PARENTS, name, colour)
                for motion, name, colour in (*shown, (truth, "truth", TRUTH))
            ]
            self.animation = Animation(actors, 30.0)

    def _repaired(
        self, damaged: Motion, mask: np.ndarray, kind: str
    ) -> tuple[dict[str, Motion], np.ndarray]:
        """The motion by every method, and what blind repair touched."""
        manifold, mapping = self.manifold, self.mapping
        body = manifold.body(damaged, mapping)
        blind = repair(damaged, manifold, mapping, smooth=kind == JITTER)
        found = {DAMAGED: damaged, BLIND: blind.motion}
        if not mask.all():
            found[TOLD] = repair(damaged, manifold, mapping, mask, force=True).motion
            found[SPLINE] = methods.filled(body, mask, methods.spline(manifold))
            found[PCA] = methods.filled(body, mask, self.pca)
        found |= {name: methods.filtered(damaged, name) for name in methods.FILTERS}
        found[PLAIN_ROW] = project_motion(damaged, manifold, mapping)
        return found, blind.touched


def _clean(manifold: MotionManifold, material: Material, takes: list[LabelledTake]) -> Clean:
    each = []
    for take in takes:
        motion = material.motion(take)
        repaired = repair(motion, manifold, material.mapping)
        plain = project_motion(motion, manifold, material.mapping)
        before, after, projected = (
            body_positions(each, material.mapping) for each in (motion, repaired.motion, plain)
        )
        slides = [foot_sliding(positions, motion.rate) for positions in (before, after)]
        change = 100 * _distance(after, before).mean()
        shares = change, repaired.touched.mean(), *slides
        each.append((*shares, 100 * _distance(projected, before).mean(), repaired.known))
    return Clean(*map(float, np.mean(each, axis=0)))


def _holes(manifold: MotionManifold, material: Material, source: str, seed: int) -> Errors:
    """Method to hole ("wrist, 45 frames") to cm; holes in clean takes, told."""
    errors: dict = defaultdict(lambda: defaultdict(list))
    mapping, spline = material.mapping, methods.spline(manifold)
    for number, take in enumerate(evenly(material.of(source).testing, HOLE_TAKES)):
        motion = material.motion(take)
        true, body = body_positions(motion, mapping), manifold.body(motion, mapping)
        for frames in HOLES:
            if motion.seconds < frames / 30 + 1:
                continue
            hole = stretch(motion, frames / 30, np.random.default_rng([seed, number, frames]))
            for name, joints in HOLE_JOINTS.items():
                mask = joint_mask(len(motion), joints, hole)
                told = repair(motion, manifold, mapping, mask, force=True).motion
                filled = {SPLINE: methods.filled(body, mask, spline), TOLD: told}
                for method, made in filled.items():
                    off = _distance(body_positions(made, mapping), true)[mask].mean()
                    errors[method][f"{name}, {frames} frames"].append(100 * off)
    return _mean(errors)


def _distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.linalg.norm(one - other, axis=-1)


def _mean(lists: dict) -> Errors:
    return {
        row: {column: float(np.mean(values)) for column, values in columns.items()}
        for row, columns in lists.items()
    }


def _tables(
    name: str, errors: Errors, elsewhere: Errors, found: Errors, clean: Clean, holes: Errors
) -> list[Table]:
    def table(caption: str, values: Errors, first: str) -> Table:
        rows = [[row, *(of.get(kind) for kind in DAMAGES)] for row, of in values.items()]
        return Table(f"{name}: {caption}.", [first, *DAMAGES], rows)

    kinds = list(dict.fromkeys([*holes.get(TOLD, {})]))
    rows = [[kind, holes[SPLINE][kind], holes[TOLD][kind]] for kind in kinds]
    rows = [[*row, row[2] / row[1]] for row in rows]
    moved = [["repair", clean.change, 100 * clean.touched, clean.sliding_after, 100 * clean.known]]
    moved += [["as it is", 0.0, 0.0, clean.sliding, None], [PLAIN_ROW, clean.plain] + 3 * [None]]
    header = ["clean takes", "change, cm", "touched, %", "sliding, cm/s", "known, %"]
    return [
        table(CAPTION, errors, "method"),
        table("change of the other joints and frames, cm", elsewhere, "method"),
        table("joints and frames that blind repair touches, %", found, "share"),
        Table(f"{name}: takes without damage.", header, moved),
        Table(f"{name}: holes, told, cm.", ["hole", SPLINE, TOLD, "ratio"], rows),
    ]


def _claims(
    name: str, errors: Errors, elsewhere: Errors, clean: Clean, holes: Errors
) -> list[Claim]:
    claims = [
        Claim(
            f"Repair changes a clean file by at most 0.2 cm and touches at most 1% of it ({name}; "
            "not in the paper).",
            clean.change <= 0.2 and clean.touched <= 0.01,
            f"{clean.change:.3f} cm, {100 * clean.touched:.2f}%.",
        ),
        Claim(
            f"The standing foot slides no more after it ({name}; not in the paper).",
            clean.sliding_after <= clean.sliding,
            f"{clean.sliding:.2f} cm/s before, {clean.sliding_after:.2f} after.",
        ),
    ]
    for kind, share in REMAINS.items():
        before, after = (errors[row][kind] for row in (DAMAGED, BLIND))
        claims.append(
            Claim(
                f"Blind repair leaves at most {share:.2f} of the damage {kind!r} ({name}; not in "
                "the paper).",
                after <= share * before,
                f"{before:.2f} cm before, {after:.2f} after, {after / before:.2f} of it.",
            )
        )
    smoothed, filtered = (
        errors[BLIND][JITTER],
        min(errors[name][JITTER] for name in methods.FILTERS if name.startswith("Savitzky")),
    )
    long = [kind for kind in holes.get(TOLD, {}) if not kind.endswith(f" {HOLES[0]} frames")]
    ratios = {kind: holes[TOLD][kind] / holes[SPLINE][kind] for kind in holes.get(TOLD, {})}
    most = max(ratios.values(), default=0.0)
    most_long = max((ratios[kind] for kind in long), default=0.0)
    moved = max(elsewhere[BLIND].values())
    return [
        *claims,
        Claim(
            f"It leaves no more jitter than a Savitzky-Golay filter ({name}; not in the paper).",
            smoothed <= filtered,
            f"{errors[DAMAGED][JITTER]:.2f} cm before, {smoothed:.2f} after, {filtered:.2f} by "
            "the filter.",
        ),
        Claim(
            f"Told holes have at most 0.75 of the spline's error from 45 frames on, and never "
            f"more than it ({name}; not in the paper).",
            bool(ratios) and most_long <= 0.75 and most <= 1.0,
            f"at most {most_long:.2f} of it from 45 frames on, {most:.2f} at any length.",
        ),
        Claim(
            f"Everything else moves by at most 0.2 cm ({name}; not in the paper).",
            moved <= 0.2,
            f"{moved:.2f} cm at most, in the mean of a kind of damage.",
        ),
    ]


def _figure(source: str, errors: Errors):
    colours = {DAMAGED: CORRUPTED, BLIND: PROJECTED, TOLD: "#1d4e89", SPLINE: PLAIN}
    colours[next(iter(methods.FILTERS))] = "#4aa6a6"
    groups = [
        (name, [errors[name].get(kind, 0.0) for kind in DAMAGES], colour)
        for name, colour in colours.items()
    ]
    return bars_figure(list(DAMAGES), groups, f"error of {source} takes, cm")
