"""Motion files as people have them: what repair, its presets and a simple filter make of each.

Proposed: the preset that `repair` proposes, if any. Damaged: a frame jumps or a preset is proposed.
Helped: at most half of the jumps are left, or, without jumps, planted feet have at most three
quarters of their speed. Harmed: a jump is new, or a measure a tenth worse.

There is no truth. A frame has a jump if the step of one of the twenty joints differs from the
median of seven by more than 8 cm. Away from jumps, in joints and frames further than `NEAR` from
one, a method should change little. The simple filter is that of ten lines of code: a median of five
frames at 30 a second, then a Butterworth filter of 5 Hz, on the quaternions of all rotations.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.cleanup import PRESETS, Preset, Repaired, repair_motion
from numpy_cae.cleanup.presets import fitting_preset
from numpy_cae.cleanup.view import View
from numpy_cae.errors import NumpyCaeError
from numpy_cae.evaluation import jitter
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import body_positions, find_motion_files, load_motion
from numpy_cae.motion import Motion
from numpy_cae.motion.contacts import foot_sliding
from numpy_cae.motion.filters import filter_motion, filter_strongly
from numpy_cae.motion.masks import widen_runs
from studies.shared.result import Claim, Result, Table

BEFORE = "as it is"
REPAIR = "repair"
FILTER = "ten lines"
METHODS = {REPAIR: Preset()} | {f"--from {name}": preset for name, preset in PRESETS.items()}
JUMPS = "frames with a jump"
NEW = "new"
FEET = "planted feet, cm/s"
CHANGE = "change elsewhere, cm"
PATH = "change of the hips' path, cm"
HEADER = (JUMPS, NEW, "acceleration, m/s²", FEET, "bone lengths, cm", CHANGE, PATH)
"""New: frames with a jump further than `NEAR` from every jump of the file. Planted feet: the speed
of the lower foot on the floor. Bone lengths: the root mean square deviation of the rig's bones from
their median lengths. Change elsewhere: of joints from the hips, further than `NEAR` from jumps."""
HELPED = "helped"
HARMED = "harmed"
AS_BEFORE = "as before"
Measures = dict[str, float]
"""Column to measure."""
NEAR = 0.25
"""The time around a jump in which a repair may change the motion (s)."""


class MeasuredFile:
    """A motion file, what every method makes of it, and the rows of the table."""

    def __init__(self, name: str, motion: Motion, manifold: MotionManifold):
        self.name = name
        preset = fitting_preset(motion)
        self.proposed = f"--from {preset}" if preset else REPAIR
        filtered = filter_motion(motion, lambda curve: filter_strongly(curve, motion.rate))
        self.measures = {
            BEFORE: measures_of(motion, motion),
            FILTER: measures_of(motion, filtered),
        }
        self.remarks = {BEFORE: "", FILTER: ""}
        for method, settings in METHODS.items():
            repaired = repair_motion(motion, manifold, preset=settings)
            self.measures[method] = measures_of(motion, repaired.motion)
            self.remarks[method] = remark_on(repaired)
        self.verdict = verdict(self.measures[BEFORE], self.measures[self.proposed])
        self.remarks[self.proposed] += f"; proposed: {self.verdict}"

    @property
    def is_damaged(self) -> bool:
        """Whether a frame jumps or a preset is proposed."""
        return bool(self.measures[BEFORE][JUMPS]) or self.proposed != REPAIR

    def rows(self) -> list[list[object]]:
        """A row of the table for each method."""
        return [
            [f"{self.name}: {method}", *measures.values(), self.remarks[method]]
            for method, measures in self.measures.items()
        ]


def remark_on(repaired: Repaired) -> str:
    """The kinds of damage that a repair finds, and whether the motion is unlike the model's."""
    words = sorted({finding.kind for finding in repaired.findings}) or ["unchanged"]
    if not repaired.is_familiar:
        words.append("unlike")
    return ", ".join(words)


def measures_of(before: Motion, after: Motion) -> Measures:
    """The measures of a motion `after` a repair, which may have cut off its start."""
    before = before.at(slice(len(before) - len(after), None))
    near = widen_runs(View(before).jumps > 0, round(NEAR * before.rate))
    jumps = View(after).jumps > 0
    positions = body_positions(after)
    lengths = np.linalg.norm(after.translations[:, 1:], axis=-1)
    moved = positions - body_positions(before)
    change = np.linalg.norm(moved - moved[:, :1], axis=-1)[~near]
    values = (
        int(jumps.any(axis=1).sum()),
        int((jumps & ~near).any(axis=1).sum()),
        jitter(positions, after.rate) if len(after) > 2 else np.nan,
        foot_sliding(positions, after.rate),
        100 * float(np.sqrt(np.mean((lengths - np.median(lengths, axis=0)) ** 2))),
        100 * float(change.mean()) if change.size else np.nan,
        100 * float(np.linalg.norm(moved[:, 0], axis=-1).mean()),
    )
    return dict(zip(HEADER, values, strict=True))


def verdict(before: Measures, after: Measures) -> str:
    """Whether a repaired file is helped, harmed, or as before, by the rule above."""
    # Of a measure near 0, a tenth is rounding.
    is_worse = any(after[name] > 1.1 * before[name] + 0.01 for name in HEADER[:-2])
    if after[NEW] or is_worse:
        return HARMED
    if before[JUMPS]:
        is_helped = after[JUMPS] <= 0.5 * before[JUMPS]
    else:
        is_helped = 0 < before[FEET] and after[FEET] <= 0.75 * before[FEET]
    return HELPED if is_helped else AS_BEFORE


def run(manifold: MotionManifold, folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Measure every motion file below the folders."""
    files = []
    refused_rows = []
    for folder in folders:
        for path in find_motion_files(folder):
            try:
                files.append(MeasuredFile(path.name, load_motion(path), manifold))
            except (NumpyCaeError, ValueError) as problem:
                blank = [None] * len(HEADER)
                refused_rows.append([path.name, *blank, f"refused: {problem}"])
    rows = []
    for file in files:
        rows += file.rows()
    claims = []
    if files:
        claims = [
            compare_with_filter(files, JUMPS, "fewer_jumps"),
            compare_with_filter(files, CHANGE, "less_changed"),
            claim_of_helped(files, len(refused_rows)),
        ]
    table = Table("", ["file: method", *HEADER, "said"], rows + refused_rows)
    return Result("Repair: real files", [table], claims)


def compare_with_filter(files: Sequence[MeasuredFile], measure: str, key: str) -> Claim:
    """Whether the proposed repair has less of a measure than the simple filter in every file."""
    of_repair = [file.measures[file.proposed][measure] for file in files]
    of_filter = [file.measures[FILTER][measure] for file in files]
    exceptions = []
    for file, repaired, filtered in zip(files, of_repair, of_filter, strict=True):
        if repaired > filtered:
            exceptions.append(file.name)
    sums = f"the sums are {np.nansum(of_repair):.4g} and {np.nansum(of_filter):.4g}"
    return Claim(key, not exceptions, f"{sums}; not in {', '.join(exceptions) or 'none'}.")


def claim_of_helped(files: Sequence[MeasuredFile], refused: int) -> Claim:
    """Whether repair helps three quarters of the damaged files and harms or changes no other."""
    damaged = [file for file in files if file.is_damaged]
    helped = sum(file.verdict == HELPED for file in damaged)
    harmed = sum(file.verdict == HARMED for file in damaged)
    changed = []
    for file in files:
        if not file.is_damaged and file.measures[REPAIR][CHANGE]:
            changed.append(file.name)
    figures = (
        f"of {len(files) + refused} files {refused} refused and {len(damaged)} damaged, of these "
        f"{helped} helped, {harmed} harmed; changed without damage: {', '.join(changed) or 'none'}."
    )
    is_confirmed = helped >= 0.75 * len(damaged) and not harmed and not changed
    return Claim("files_helped", is_confirmed, figures)
