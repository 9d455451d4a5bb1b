"""Damage of seven kinds in the rig of the file, repaired with the mask unknown, with the mask
given, and by simple methods; holes of several lengths; and what repair does to motions without
damage.

    python docs/damage.py --data bandai --test '*_005.bvh'

docs/lab_book/damage.md has the findings. Positions are those of forward kinematics in the file's
rig, in the frames of the file. An error is the mean distance of a joint from its true position over
the damaged joints and frames.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from experiment_script import main
from kinds_of_damage import DAMAGES
from scipy.ndimage import median_filter
from scipy.signal import butter, savgol_filter, sosfiltfilt

from numpy_cae.evaluation import PCA, foot_sliding
from numpy_cae.evaluation.linear_denoiser import TAPS, contexts
from numpy_cae.experiments.material import LabelledTake, Material, evenly, features_of
from numpy_cae.experiments.repair.damaged_motion import stretch
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold, Preset, project_motion, repair
from numpy_cae.manifold.evidence.jitter import filter_motion, strongly_filtered
from numpy_cae.manifold.holes import Holes
from numpy_cae.motion import JOINTS, POSITIONS, RATE, Motion, body_positions
from numpy_cae.motion.joints import LIMBS, joint_mask
from numpy_cae.motion.retarget.body import Body
from numpy_cae.motion.retarget.curves import on_curves
from numpy_cae.motion.retarget.key_curves import ROTATION_CURVES, Curve
from numpy_cae.motion.retarget.to_rig import retarget
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, bars_figure

TAKES = 10
"""Of each source at most this many takes are damaged."""
HOLE_TAKES = 16
"""Of each source at most this many takes get holes."""
HOLES = (10, 20, 45, 90)
"""Lengths of holes, in frames at 30 a second."""
HOLE_JOINTS = {
    "wrist": ("left_wrist",),
    "arm": LIMBS["left_arm"],
    "leg": LIMBS["left_leg"],
    "whole body": JOINTS,
}
MOST = {"wrist": 1.0, "arm": 0.95, "leg": 0.8, "whole body": 1.0}
"""Repair with the mask given may have at most this share of the error of the best rotation curve,
the geometric mean over the holes of one length."""
DAMAGED, UNKNOWN, GIVEN = "as damaged", "repair, mask unknown", "repair, mask given"
LINEAR, PROJECTION = "PCA, mask given", "plain projection"
CURVES = {f"{name} of rotations, mask given": curve for name, curve in ROTATION_CURVES.items()}
"""What an animator does: the damaged keys are deleted, and a curve runs through the rotations of
the rig on both sides. The curves are given the mask and the undamaged rotations."""
JITTER, BEST = "jitter", "best curve"
LEAST_ERROR = 0.02
"""LEAST_ERROR: in ratios, smaller errors (cm) count as this; joints at rest are filled exactly."""
REMAINS = {
    "frozen in channels": 13 / 19,
    "frozen in the world": 13 / 19,
    "spikes": 1 / 20,
    "twisted leg": 12 / 56,
}
"""Repair with the mask unknown may leave at most this share of the damage."""
CHANGE, TOUCHED = "change, cm", "touched, %"
BEFORE, AFTER = "sliding before, cm/s", "sliding after, cm/s"
CLEAN = (CHANGE, TOUCHED, BEFORE, AFTER, "known, %")
"""What repair does to takes without damage: mean change, share of joints and frames that it
touched, sliding of the standing foot, share of takes that are like what the model learned from."""
PCA_TAKES, EXPLAINED = 60, 0.95
"""PCA is fitted to every third frame of at most PCA_TAKES takes, with as many axes as explain the
share EXPLAINED of the variance."""
Values = dict[str, dict[str, list[float]]]
"""Row to column to one number for each take; where a method does not apply there is no column."""
Filling = Callable[[Body, np.ndarray], Motion]
"""The motion of a body with the joints of a mask (frames, 20) filled in."""
FILTERS: dict[str, Callable[[np.ndarray, float], np.ndarray]] = {
    "Savitzky-Golay, 0.3 s": lambda x, rate: savgol_filter(x, _window(0.3, rate), 2, axis=0),
    "Savitzky-Golay, 0.7 s": lambda x, rate: savgol_filter(x, _window(0.7, rate), 2, axis=0),
    # Of second order, applied forwards and backwards, so that it does not delay.
    "Butterworth, 3 Hz": lambda x, rate: sosfiltfilt(
        butter(2, 3.0, fs=rate, output="sos"), x, axis=0
    ),
    "median, 0.2 s": lambda x, rate: median_filter(x, (_window(0.2, rate), 1), mode="nearest"),
    "median, 0.17 s, then Butterworth, 5 Hz": strongly_filtered,
}
"""Name to a function of curves (F, C) and their frames a second."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Damage test takes of each source and repair them; `seed` draws the damage."""
    fillings: dict[str, Filling] = {
        name: partial(curve_filling, curve) for name, curve in CURVES.items()
    }
    fillings[LINEAR] = pca_filling(manifold, material.training)
    tables, claims, trials = [], [], {}
    for source in dict.fromkeys(take.source for take in material.testing):
        testing = material.of(source).testing
        trial = trials[source] = _Trial(manifold, fillings, seed)
        takes = evenly(testing, TAKES)
        for number, take in enumerate(takes):
            truth = material.motion(take)
            trial.add_clean(truth)
            for kind in DAMAGES:
                trial.add(truth, kind, number)
        for number, take in enumerate(evenly(testing, HOLE_TAKES)):
            trial.add_holes(material.motion(take), number)
        tables += trial.tables(f"{source}, {len(takes)} takes")
        claims += trial.claims(source)
    source, first = next(iter(trials.items()))
    return Result(
        "Repair: damage in the file's own rig",
        tables,
        claims,
        lambda: _figure(source, first.errors),
        note=f"The network learned from {manifold.settings.get('takes')} takes, PCA from "
        f"{len(material.training)}.",
    )


class _Trial:
    """What every method makes of the takes of one source."""

    def __init__(self, manifold: MotionManifold, fillings: dict[str, Filling], seed: int):
        self.manifold, self.fillings, self.seed = manifold, fillings, seed
        self.errors, self.elsewhere, self.touched, self.clean, self.holes = (
            defaultdict(lambda: defaultdict(list)) for _ in range(5)
        )

    def add(self, truth: Motion, kind: str, number: int) -> None:
        """Damage a take and repair it by every method."""
        rng = np.random.default_rng([self.seed, number])
        damaged, mask = DAMAGES[kind](truth, rng)
        repaired = repair(damaged, self.manifold, preset=Preset(smooth=kind == JITTER))
        made = {DAMAGED: damaged, UNKNOWN: repaired.motion}
        self.touched["of the damage"][kind].append(100 * repaired.touched[mask].mean())
        if not mask.all():
            self.touched["of the rest"][kind].append(100 * repaired.touched[~mask].mean())
            body = self.manifold.body(damaged)
            made[GIVEN] = repair(damaged, self.manifold, mask).motion
            made |= {name: filling(body, mask) for name, filling in self.fillings.items()}
        made |= {name: filtered(damaged, name) for name in FILTERS}
        made[PROJECTION] = project_motion(damaged, self.manifold)
        true, before = body_positions(truth), body_positions(damaged)
        for name, motion in made.items():
            after = body_positions(motion)
            self.errors[name][kind].append(_distance(after, true)[mask].mean())
            if not mask.all():
                self.elsewhere[name][kind].append(_distance(after, before)[~mask].mean())

    def add_clean(self, truth: Motion) -> None:
        """Repair a take without damage."""
        repaired = repair(truth, self.manifold)
        before, after = body_positions(truth), body_positions(repaired.motion)
        slides = [foot_sliding(positions, truth.rate) for positions in (before, after)]
        change, touched = _distance(after, before).mean(), 100 * repaired.touched.mean()
        values = (change, touched, *slides, 100.0 * repaired.known)
        for column, value in zip(CLEAN, values, strict=True):
            self.clean[UNKNOWN][column].append(value)
        projected = body_positions(project_motion(truth, self.manifold))
        self.clean[PROJECTION][CHANGE].append(_distance(projected, before).mean())

    def add_holes(self, motion: Motion, number: int) -> None:
        """Fill holes in a take without damage, mask given; where the take is too short, none."""
        true, body = body_positions(motion), self.manifold.body(motion)
        for frames in HOLES:
            if motion.seconds < frames / RATE + 1:
                continue
            rng = np.random.default_rng([self.seed, number, frames])
            hole = stretch(motion, frames / RATE, rng)
            for name, joints in HOLE_JOINTS.items():
                mask = joint_mask(len(motion), joints, hole)
                repaired = {name: self.fillings[name](body, mask) for name in CURVES}
                repaired[GIVEN] = repair(motion, self.manifold, mask).motion
                for method, made in repaired.items():
                    error = _distance(body_positions(made), true)[mask].mean()
                    self.holes[f"{name}, {frames} frames"][method].append(error)

    def ratios(self) -> dict[str, dict[str, float]]:
        """Error of repair by that of each rotation curve, mask given, for each kind of hole: the
        geometric mean over the holes; and the largest of the three, that of the best curve."""
        ratios = {}
        for hole, errors in self.holes.items():
            logs = {
                name: np.log(np.maximum(errors[name], LEAST_ERROR)) for name in (*CURVES, GIVEN)
            }
            means = {name: float(np.exp(np.mean(logs[GIVEN] - logs[name]))) for name in CURVES}
            ratios[hole] = means | {BEST: max(means.values())}
        return ratios

    def tables(self, name: str) -> list[Table]:
        """All of them."""
        errors = (
            f"{name}: error, cm. Methods with the mask given know the damaged joints and frames; "
            "`repair` smooths where the damage is jitter"
        )
        by_curve = {
            hole: {name: [ratio] for name, ratio in ratios.items()}
            for hole, ratios in self.ratios().items()
        }
        return [
            _table(errors, self.errors, DAMAGES, "low"),
            _table(f"{name}: change of everything else, cm", self.elsewhere, DAMAGES),
            _table(f"{name}: joints and frames that repair touches, %", self.touched, DAMAGES),
            _table(f"{name}: without damage", self.clean, CLEAN),
            _table(
                f"{name}: holes in takes without damage, cm",
                self.holes,
                (*CURVES, GIVEN),
                "low across",
            ),
            _table(
                f"{name}: the same holes, error of repair divided by that of each curve, geometric "
                "mean over the holes",
                by_curve,
                (*CURVES, BEST),
            ),
        ]

    def claims(self, source: str) -> list[Claim]:
        """The claims of the lab book on careful repair."""

        def error(method: str, kind: str) -> float:
            return float(np.mean(self.errors[method][kind]))

        change, touched, before, after = (np.mean(self.clean[UNKNOWN][c]) for c in CLEAN[:4])
        moved = max(np.mean(values) for values in self.elsewhere[UNKNOWN].values())
        damaged, smoothed = error(DAMAGED, JITTER), error(UNKNOWN, JITTER)
        best_filter = min(FILTERS, key=lambda name: error(name, JITTER))
        filtered = error(best_filter, JITTER)
        ratios = {hole: values[BEST] for hole, values in self.ratios().items()}
        measured = [
            (
                "Repair changes a clean file by at most 0.2 cm and touches at most 1% of it",
                change <= 0.2 and touched <= 1.0,
                f"{change:.3f} cm, {touched:.2f}%.",
            ),
            (
                "The standing foot of a clean file slides no more after repair, to 0.01 cm/s",
                after <= before + 0.01,
                f"{before:.3f} cm/s before, {after:.3f} after.",
            ),
            *(
                (
                    f"Without a mark of the damage, repair leaves at most {share:.0%} of its "
                    f"error: {kind}",
                    error(UNKNOWN, kind) <= share * error(DAMAGED, kind),
                    f"{error(DAMAGED, kind):.2f} cm before, {error(UNKNOWN, kind):.2f} after, "
                    f"{error(UNKNOWN, kind) / error(DAMAGED, kind):.0%}.",
                )
                for kind, share in REMAINS.items()
            ),
            (
                "Smoothing leaves no more jitter than the best filter",
                smoothed <= filtered,
                f"{damaged:.2f} cm before, {smoothed:.2f} after, {filtered:.2f} by {best_filter}.",
            ),
            *(
                (
                    f"Where a hole is marked, {part}, fill has at most {most:.0%} of the error of "
                    "the best curve of animation programs at every length of hole",
                    bool(of_part) and max(of_part.values()) <= most,
                    ", ".join(f"{hole} {ratio:.2f}" for hole, ratio in of_part.items()) + ".",
                )
                for part, most in MOST.items()
                for of_part in [{h: r for h, r in ratios.items() if h.startswith(part)}]
            ),
            *(
                (
                    "Where the damage is marked, repair has at most the error of the best curve of "
                    f"animation programs: {kind}",
                    error(GIVEN, kind) <= min(error(name, kind) for name in CURVES),
                    f"{error(GIVEN, kind):.2f} cm, the curves "
                    f"{', '.join(f'{error(name, kind):.2f}' for name in CURVES)}.",
                )
                for kind in self.errors[GIVEN]
            ),
            (
                "Without a mark of the damage, repair moves everything else by at most 0.2 cm",
                moved <= 0.2,
                f"at most {moved:.2f} cm in the mean of a kind of damage.",
            ),
        ]
        return [
            Claim(f"{sentence} ({source} takes; not in the paper).", bool(confirmed), figures)
            for sentence, confirmed, figures in measured
        ]


def _distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Centimetres."""
    return 100 * np.linalg.norm(one - other, axis=-1)


def _table(caption: str, values: Values, columns: Sequence[str], best: str = "") -> Table:
    rows = [
        [name, *(np.mean(numbers[column]) if column in numbers else None for column in columns)]
        for name, numbers in values.items()
    ]
    return Table(f"{caption}.", ["", *columns], rows, best=best)


def _figure(source: str, errors: Values):
    colours = {DAMAGED: CORRUPTED, UNKNOWN: PROJECTED, GIVEN: "#1d4e89", next(iter(CURVES)): PLAIN}
    colours[next(iter(FILTERS))] = "#4aa6a6"
    groups = [
        (name, [np.mean(errors[name].get(kind, 0.0)) for kind in DAMAGES], colour)
        for name, colour in colours.items()
    ]
    return bars_figure(list(DAMAGES), groups, f"error of {source} takes, cm")


def _window(seconds: float, rate: float) -> int:
    return 2 * round(seconds * rate / 2) + 1


def filtered(motion: Motion, name: str) -> Motion:
    """The motion with its curves of translations and rotations (quaternions) filtered."""
    return filter_motion(motion, lambda curve: FILTERS[name](curve, motion.rate))


def curve_filling(curve: Curve, body: Body, mask: np.ndarray) -> Motion:
    """The unknown rotations on a curve, other joints back at their positions."""
    start = on_curves(body.motion, mask, lambda *_: curve)
    positions = np.where(mask[..., None], body_positions(start), body_positions(body.motion))
    return retarget(body.motion, positions, mask, start.at(mask.any(axis=1)))


def pca_filling(manifold: MotionManifold, takes: list[LabelledTake]) -> Filling:
    """PCA of the 15 frames around each frame: the missing values are the most likely ones."""

    def rows(features: np.ndarray) -> np.ndarray:
        return contexts(manifold.normalise(features)[None], TAPS)[0]

    some = [rows(features)[::3] for features in features_of(manifold, evenly(takes, PCA_TAKES))]
    fitted = PCA.fit(np.concatenate(some).astype(np.float64))
    explained = np.cumsum(fitted.variances) / fitted.variances.sum()
    size = int(np.searchsorted(explained, EXPLAINED)) + 1

    def fill_in(body: Body, mask: np.ndarray) -> Motion:
        holes = Holes(body, mask)
        features, missing = holes.features, holes.mask
        known = np.ones(features.shape, bool)
        known[:, POSITIONS] = ~np.repeat(missing, 3, axis=1)
        frames = np.flatnonzero(missing.any(axis=1))
        sure = contexts(known[None], TAPS)[0][frames]
        found = fitted.fill(rows(features)[frames], sure, size)
        middle = np.split(found, TAPS, axis=1)[TAPS // 2]
        result = features.copy()
        result[frames] = manifold.denormalise(middle)
        return holes.filled(np.where(known, features, result))

    return fill_in


if __name__ == "__main__":
    main(run, __doc__ or "")
