"""Planted damage of eight kinds in the rig of the file, repaired with the mask unknown, with the
mask given, and by simple methods. `python -m studies holes` has holes of several lengths, and
`python -m studies clean_motion` motions without damage.

    python -m studies damage --data bandai --test '*_005.bvh'

docs/lab_book/damage.md has the findings. Positions are those of forward kinematics in the file's
rig, in the frames of the file. An error is the mean distance of a joint from its true position over
the damaged joints and frames.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import butter, savgol_filter, sosfiltfilt

from numpy_cae.cleanup import Preset, repair_motion
from numpy_cae.cleanup.holes import Holes
from numpy_cae.cleanup.interpolation import interpolate_joints, mark_missing_joints
from numpy_cae.evaluation.baselines import fit_gaussian
from numpy_cae.evaluation.tables import clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import body_positions
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.mocap.retargeting.to_rig import retarget
from numpy_cae.motion import POSITIONS, Motion
from numpy_cae.motion.filters import filter_motion, filter_strongly
from numpy_cae.motion.hole_curves import ROTATION_CURVES, Curve
from studies.shared.charts import draw_damage_and_repair
from studies.shared.damages import DAMAGES, EASED, ONSETS, eased
from studies.shared.material import LabelledTake, Material, evenly
from studies.shared.result import Picture, Result, Table

TAKES = 10
"""Of each source at most this many takes are damaged."""
DAMAGED = "as damaged"
UNKNOWN = "repair, mask unknown"
GIVEN = "repair, mask given"
LINEAR = "Gaussian of 15 frames, mask given"
JITTER = "jitter"
CURVES = {f"{name} of rotations, mask given": curve for name, curve in ROTATION_CURVES.items()}
"""What an animator does: the damaged keys are deleted, and a curve runs through the rotations of
the rig on both sides. The curves are given the mask and the undamaged rotations."""
RECALL = "of the damage, found"
PRECISION = "of what is found, damaged"
GAUSSIAN_TAKES = 60
"""The Gaussian is fitted to at most this many takes."""
KINDS = tuple(DAMAGES)
ERROR = (
    "error, cm. Methods with the mask given know the damaged joints and frames; `repair` smooths "
    "where the damage is jitter"
)
ELSEWHERE = "change of everything else, cm"
BY_ONSET = "error, cm, by the frames at 30 a second over which damage begins and ends"
FINDINGS = "what repair finds, mask unknown, % of joints and frames"
TABLES: dict[str, Sequence[str]] = {
    ERROR: KINDS,
    ELSEWHERE: KINDS,
    BY_ONSET: [str(onset) for onset in ONSETS],
    FINDINGS: KINDS,
}
"""Caption to the columns."""
Values = dict[str, dict[str, list[float]]]
"""Row to column to one number for each take; where a method does not apply there is no column."""
Filling = Callable[[Motion, np.ndarray], Motion]
"""A motion with the joints of a mask (frames, 20) filled in."""
FILTERS: dict[str, Callable[[np.ndarray, float], np.ndarray]] = {
    "Savitzky-Golay, 0.3 s": lambda x, rate: savgol_filter(x, _window(0.3, rate), 2, axis=0),
    "Savitzky-Golay, 0.7 s": lambda x, rate: savgol_filter(x, _window(0.7, rate), 2, axis=0),
    # Of second order, applied forwards and backwards, so that it does not delay.
    "Butterworth, 3 Hz": lambda x, rate: sosfiltfilt(butter(2, 3, fs=rate, output="sos"), x, 0),
    "median, 0.2 s": lambda x, rate: median_filter(x, (_window(0.2, rate), 1), mode="nearest"),
    "median, 0.17 s, then Butterworth, 5 Hz": filter_strongly,
}
"""Name to a function of curves (F, C) and their frames a second."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Damage test takes of each source and repair them; `seed` draws the damage."""
    fillings: dict[str, Filling] = {
        GIVEN: lambda motion, mask: repair_motion(motion, manifold, mask).motion,
        **{name: partial(curve_filling, curve) for name, curve in CURVES.items()},
        LINEAR: gaussian_filling(manifold, material.training),
    }
    tables = list[Table]()
    figures = dict[str, Picture]()
    for source in dict.fromkeys(take.source for take in material.testing):
        testing = material.of(source).testing
        trial = _Trial(manifold, fillings, seed)
        takes = evenly(testing, TAKES)
        for number, take in enumerate(takes):
            trial.add(material.motion(take), number)
        tables_of_source = trial.tables(f"{source}, {len(takes)} takes")
        tables += tables_of_source
        errors = dict(zip(TABLES, tables_of_source, strict=True))[ERROR]
        draw = partial(draw_damage_and_repair, errors, DAMAGED, UNKNOWN, GIVEN)
        figures[f"damage_{source}"] = Picture(draw)
    learned = manifold.settings.get("takes")
    return Result(
        "Repair: damage in the file's own rig",
        tables,
        figures=figures,
        note=f"The network learned from {learned} takes. The Gaussian is fitted to training takes.",
    )


class _Trial:
    """What every method makes of the takes of one source."""

    def __init__(self, manifold: MotionManifold, fillings: dict[str, Filling], seed: int):
        self.manifold = manifold
        self.fillings = fillings
        self.seed = seed
        self.values: dict[str, Values] = {c: defaultdict(lambda: defaultdict(list)) for c in TABLES}

    def add(self, truth: Motion, number: int) -> None:
        """Damage a take in each way, and repair it by every method."""
        true = body_positions(truth)
        for kind, damage in DAMAGES.items():
            for onset in ONSETS if kind in EASED else ONSETS[:1]:
                damaged, mask = damage(truth, np.random.default_rng([self.seed, number, onset]))
                if onset:
                    damaged = eased(truth, damaged, mask, onset)
                self._compare(true, damaged, mask, kind, str(onset))

    def _compare(
        self, true: np.ndarray, damaged: Motion, mask: np.ndarray, kind: str, onset: str
    ) -> None:
        """Errors of all methods. Those of kinds with several onsets are means over them."""
        before = body_positions(damaged)
        for name, motion in self._repair_by_every_method(damaged, mask, kind).items():
            after = body_positions(motion)
            error = _distance(after, true)[mask].mean()
            self.values[ERROR][name][kind].append(error)
            if kind in EASED and name in (DAMAGED, UNKNOWN):
                self.values[BY_ONSET][f"{kind}: {name}"][onset].append(error)
            if not mask.all():
                moved = _distance(after, before)[~mask].mean()
                self.values[ELSEWHERE][name][kind].append(moved)

    def _repair_by_every_method(
        self, damaged: Motion, mask: np.ndarray, kind: str
    ) -> dict[str, Motion]:
        """The damaged take by every method. The joints and frames that repair marks as damaged are
        compared with the mask."""
        repaired = repair_motion(
            damaged, self.manifold, preset=Preset(smooth=kind.startswith(JITTER))
        )
        findings = [finding for finding in repaired.findings if finding.kind != JITTER]
        marked = mark_missing_joints(damaged, findings)
        self.values[FINDINGS][RECALL][kind].append(100 * marked[mask].mean())
        if marked.any():
            self.values[FINDINGS][PRECISION][kind].append(100 * mask[marked].mean())
        motions = {DAMAGED: damaged, UNKNOWN: repaired.motion}
        if not mask.all():
            for name, filling in self.fillings.items():
                motions[name] = filling(damaged, mask)
        for name in FILTERS:
            motions[name] = filter_curves(damaged, name)
        return motions

    def tables(self, source: str) -> list[Table]:
        """All of them."""
        return [
            Table(f"{source}: {caption}.", ["", *columns], self._rows(caption, columns))
            for caption, columns in TABLES.items()
        ]

    def _rows(self, caption: str, columns: Sequence[str]) -> list[list[object]]:
        rows = []
        for name, numbers in self.values[caption].items():
            row: list[object] = [name]
            for column in columns:
                row.append(np.mean(numbers[column]) if column in numbers else None)
            rows.append(row)
        return rows


def _distance(positions: np.ndarray, true_positions: np.ndarray) -> np.ndarray:
    """Centimetres."""
    return 100 * np.linalg.norm(positions - true_positions, axis=-1)


def _window(seconds: float, rate: float) -> int:
    return 2 * round(seconds * rate / 2) + 1


def filter_curves(motion: Motion, name: str) -> Motion:
    """The motion with its curves of translations and rotations (quaternions) filtered."""
    return filter_motion(motion, lambda curve: FILTERS[name](curve, motion.rate))


def curve_filling(curve: Curve, motion: Motion, mask: np.ndarray) -> Motion:
    """The unknown rotations on a curve, other joints back at their positions."""
    start = interpolate_joints(motion, mask, lambda *_: curve)
    positions = np.where(mask[..., None], body_positions(start), body_positions(motion))
    return retarget(motion, positions, mask, start.at(mask.any(axis=1)))


def gaussian_filling(manifold: MotionManifold, takes: list[LabelledTake]) -> Filling:
    """The missing values from the mean of a Gaussian of 15 frames, given the visible ones."""
    fitted = clips_of(manifold, [take.positions for take in evenly(takes, GAUSSIAN_TAKES)])
    gaussian = fit_gaussian(fitted.x, fitted.real, fitted.take)

    def fill_in(motion: Motion, mask: np.ndarray) -> Motion:
        holes = Holes(Body(motion, manifold.lengths), mask)
        is_visible = np.ones(holes.features.shape, bool)
        is_visible[:, POSITIONS] = ~np.repeat(holes.mask, 3, axis=1)
        x = gaussian.complete(manifold.normalise(holes.features)[None], is_visible[None])[0]
        return holes.move_to(np.where(is_visible, holes.features, manifold.denormalise(x)))

    return fill_in
