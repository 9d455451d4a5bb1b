"""Damage of seven kinds in the rig of the file, repaired blindly, told what is damaged, and by
simple methods; holes of several lengths; and what repair does to motions without damage.

Positions are those of forward kinematics in the file's rig, in the frames of the file. An error is
the mean distance of a joint from its true position over the damaged joints and frames.
"""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation import foot_sliding
from numpy_cae.experiments.material import LabelledTake, Material, evenly
from numpy_cae.experiments.repair import damage_methods as methods
from numpy_cae.experiments.repair.damaged_motion import DAMAGES, stretch
from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.manifold import MotionManifold, Repaired, project_motion, repair
from numpy_cae.motion import PARENTS, Motion, body_of, body_positions
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
CLEAN = ("change, cm", "touched, %", "sliding before, cm/s", "sliding after, cm/s", "known, %")
"""What repair does to takes without damage: mean change, share of joints and frames that it
touched, sliding of the standing foot, share of takes that the model says it knows."""
Values = dict[str, dict[str, list[float]]]
"""Row to column to one number for each take; where a method does not apply there is no column."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Damage test takes of each source and repair them; `seed` draws the damage."""
    fillings = {SPLINE: methods.spline(manifold), PCA: methods.pca(manifold, material.training)}
    tables, claims, shown, figures = [], [], [], []
    for source in dict.fromkeys(take.source for take in material.testing):
        testing = material.of(source).testing
        trial = _Trial(manifold, material, fillings, seed)
        takes = evenly(testing, TAKES)
        for number, take in enumerate(takes):
            truth = material.motion(take)
            trial.add_clean(truth)
            for kind in DAMAGES:
                shown.append(trial.add(truth, kind, number))
        for number, take in enumerate(evenly(testing, HOLE_TAKES)):
            trial.add_holes(take, number)
        tables += trial.tables(f"{source}, {len(takes)} takes")
        claims += trial.claims(source)
        figures.append((source, trial.errors))
    twisted = next(actors for actors in shown if actors)
    return Result(
        "Repair: damage in the file's own rig",
        tables,
        claims,
        lambda: _figure(*figures[0]),
        Animation(twisted, 30.0),
        f"The network learned from {manifold.settings.get('takes')} takes, PCA from "
        f"{len(material.training)}.",
    )


class _Trial:
    """What every method makes of the takes of one source."""

    def __init__(self, manifold: MotionManifold, material: Material, fillings: dict, seed: int):
        self.manifold, self.material, self.fillings, self.seed = manifold, material, fillings, seed
        self.errors, self.elsewhere, self.found, self.clean, self.holes = (
            defaultdict(lambda: defaultdict(list)) for _ in range(5)
        )

    def _positions(self, motion: Motion) -> np.ndarray:
        return body_positions(motion)

    def _repair(self, motion: Motion, mask: np.ndarray | None = None, **how: bool) -> Repaired:
        return repair(motion, self.manifold, mask, **how)

    def add(self, truth: Motion, kind: str, number: int) -> list[Actor]:
        """Damage a take and repair it by every method; of a twisted leg what is to be drawn."""
        rng = np.random.default_rng([self.seed, number])
        damaged, mask = DAMAGES[kind](truth, rng)
        blind = self._repair(damaged, smooth=kind == JITTER)
        made = {DAMAGED: damaged, BLIND: blind.motion}
        if not mask.all():
            body = self.manifold.body(damaged)
            made[TOLD] = self._repair(damaged, mask, force=True).motion
            made |= {name: methods.filled(body, mask, x) for name, x in self.fillings.items()}
        made |= {name: methods.filtered(damaged, name) for name in methods.FILTERS}
        made[PLAIN_ROW] = project_motion(damaged, self.manifold)
        true, before = self._positions(truth), self._positions(damaged)
        for name, motion in made.items():
            after = self._positions(motion)
            self.errors[name][kind].append(_distance(after, true)[mask].mean())
            if not mask.all():
                self.elsewhere[name][kind].append(_distance(after, before)[~mask].mean())
        self.found["of the damage"][kind].append(100 * blind.touched[mask].mean())
        if not mask.all():
            self.found["of the rest"][kind].append(100 * blind.touched[~mask].mean())
        drawn = ("damaged", damaged, CORRUPTED), ("repaired", blind.motion, PROJECTED)
        return [
            Actor(body_of(motion), PARENTS, name, colour)
            for name, motion, colour in (*drawn, ("truth", truth, TRUTH))
            if kind == "twisted leg"
        ]

    def add_clean(self, truth: Motion) -> None:
        """Repair a take without damage."""
        repaired = self._repair(truth)
        before, after = self._positions(truth), self._positions(repaired.motion)
        slides = [foot_sliding(positions, truth.rate) for positions in (before, after)]
        change, touched = _distance(after, before).mean(), 100 * repaired.touched.mean()
        values = (change, touched, *slides, 100.0 * repaired.known)
        for column, value in zip(CLEAN, values, strict=True):
            self.clean[BLIND][column].append(value)
        plain = project_motion(truth, self.manifold)
        self.clean[PLAIN_ROW][CLEAN[0]].append(_distance(self._positions(plain), before).mean())

    def add_holes(self, take: LabelledTake, number: int) -> None:
        """Fill holes in a take without damage, told; where it is too short, none."""
        motion = self.material.motion(take)
        true, body = self._positions(motion), self.manifold.body(motion)
        for frames in HOLES:
            if motion.seconds < frames / 30 + 1:
                continue
            hole = stretch(motion, frames / 30, np.random.default_rng([self.seed, number, frames]))
            for name, joints in HOLE_JOINTS.items():
                mask = joint_mask(len(motion), joints, hole)
                spline = methods.filled(body, mask, self.fillings[SPLINE])
                told = self._repair(motion, mask, force=True).motion
                for method, made in ((SPLINE, spline), (TOLD, told)):
                    off = _distance(self._positions(made), true)[mask].mean()
                    self.holes[f"{name}, {frames} frames"][method].append(off)

    def ratios(self) -> dict[str, float]:
        """Error of told repair by that of the spline, for each kind of hole."""
        return {hole: np.mean(of[TOLD]) / np.mean(of[SPLINE]) for hole, of in self.holes.items()}

    def tables(self, name: str) -> list[Table]:
        """All of them."""
        errors = (
            f"{name}: error, cm. Told methods are given the damaged joints and frames; `repair` "
            "smooths where the damage is jitter"
        )
        holes = _table(f"{name}: holes in takes without damage, cm", self.holes, (SPLINE, TOLD))
        ratios = self.ratios()
        rows = [[*row, ratios[str(row[0])]] for row in holes.rows]
        return [
            _table(errors, self.errors, DAMAGES),
            _table(f"{name}: change of everything else, cm", self.elsewhere, DAMAGES),
            _table(f"{name}: joints and frames that repair touches, %", self.found, DAMAGES),
            _table(f"{name}: without damage", self.clean, CLEAN),
            Table(holes.caption, [*holes.header, "ratio"], rows),
        ]

    def claims(self, source: str) -> list[Claim]:
        """The claims of `docs/lab_book/damage.md` on careful repair."""

        def claim(sentence: str, confirmed: bool, figures: str) -> Claim:
            return Claim(
                f"{sentence} ({source} takes; not in the paper).", bool(confirmed), figures
            )

        def error(method: str, kind: str) -> float:
            return float(np.mean(self.errors[method][kind]))

        change, touched, before, after = (np.mean(self.clean[BLIND][c]) for c in CLEAN[:4])
        moved = max(np.mean(values) for values in self.elsewhere[BLIND].values())
        smoothed = error(BLIND, JITTER)
        filtered = min(error(name, JITTER) for name in methods.FILTERS if name[0] == "S")
        ratios = self.ratios()
        most = max(ratios.values(), default=np.inf)
        shortest = f" {HOLES[0]} frames"
        long = max((r for hole, r in ratios.items() if not hole.endswith(shortest)), default=most)
        remains = [
            claim(
                f"Blind repair leaves at most {share:.2f} of damage: {kind}",
                error(BLIND, kind) <= share * error(DAMAGED, kind),
                f"{error(DAMAGED, kind):.2f} cm before, {error(BLIND, kind):.2f} after.",
            )
            for kind, share in REMAINS.items()
        ]
        return [
            claim(
                "Repair changes a clean file by at most 0.2 cm and touches at most 1% of it",
                change <= 0.2 and touched <= 1.0,
                f"{change:.3f} cm, {touched:.2f}%.",
            ),
            claim(
                "The standing foot of a clean file slides no more after repair, to 0.01 cm/s",
                after <= before + 0.01,
                f"{before:.3f} cm/s before, {after:.3f} after.",
            ),
            *remains,
            claim(
                "Smoothing leaves no more jitter than the better Savitzky-Golay filter",
                smoothed <= filtered,
                f"{error(DAMAGED, JITTER):.2f} cm before, {smoothed:.2f} after, {filtered:.2f} by "
                "the filter.",
            ),
            claim(
                f"Told holes have at most 0.75 of the spline's error from {HOLES[1]} frames on, "
                "never more than it",
                long <= 0.75 and most <= 1.0,
                f"{long:.2f} of it at most from {HOLES[1]} frames on, {most:.2f} at any length.",
            ),
            claim(
                "Blind repair moves everything else by at most 0.2 cm",
                moved <= 0.2,
                f"at most {moved:.2f} cm in the mean of a kind of damage.",
            ),
        ]


def _distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Centimetres."""
    return 100 * np.linalg.norm(one - other, axis=-1)


def _table(caption: str, values: Values, columns: Sequence[str]) -> Table:
    rows = [
        [row, *(np.mean(of[column]) if column in of else None for column in columns)]
        for row, of in values.items()
    ]
    return Table(f"{caption}.", ["", *columns], rows)


def _figure(source: str, errors: Values):
    colours = {DAMAGED: CORRUPTED, BLIND: PROJECTED, TOLD: "#1d4e89", SPLINE: PLAIN}
    colours[next(iter(methods.FILTERS))] = "#4aa6a6"
    groups = [
        (name, [np.mean(errors[name].get(kind, 0.0)) for kind in DAMAGES], colour)
        for name, colour in colours.items()
    ]
    return bars_figure(list(DAMAGES), groups, f"error of {source} takes, cm")
