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

from numpy_cae.cleanup import PRESETS, Preset, repair_motion
from numpy_cae.cleanup.jumps import jump_levels
from numpy_cae.cleanup.presets import fitting_preset
from numpy_cae.errors import NumpyCaeError
from numpy_cae.evaluation import jitter
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import body_positions, find_motion_files, load_motion
from numpy_cae.motion import Motion
from numpy_cae.motion.contacts import foot_sliding
from numpy_cae.motion.filters import filter_motion, strongly_filtered
from numpy_cae.motion.masks import with_margin
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
Measures = dict[str, float]
"""Column to measure."""
NEAR = 0.25
"""NEAR: the time around a jump (s)."""


class _File:
    """A motion file, what every method makes of it, and the rows of the table."""

    def __init__(self, name: str, motion: Motion, manifold: MotionManifold):
        self.name = name
        preset = fitting_preset(motion)
        self.proposed = f"--from {preset}" if preset else REPAIR
        filtered = filter_motion(motion, lambda curve: strongly_filtered(curve, motion.rate))
        made = {BEFORE: motion, FILTER: filtered}
        said = {}
        for name, settings in METHODS.items():
            repaired = repair_motion(motion, manifold, preset=settings)
            made[name] = repaired.motion
            kinds = sorted({finding.kind for finding in repaired.findings}) or ["unchanged"]
            said[name] = ", ".join(kinds + ["unlike"] * (not repaired.known))
        self.measures = {name: measures_of(motion, after) for name, after in made.items()}
        self.verdict = verdict(self.measures[BEFORE], self.measures[self.proposed])
        said[self.proposed] += f"; proposed: {self.verdict}"
        self.rows = [
            [f"{self.name}: {name}", *each.values(), said.get(name, "")]
            for name, each in self.measures.items()
        ]


def measures_of(before: Motion, after: Motion) -> Measures:
    """The measures of a motion `after` a repair, which may have cut off its start."""
    before = before.at(slice(len(before) - len(after), None))
    near = with_margin(jump_levels(before) > 0, round(NEAR * before.rate))
    jumps = jump_levels(after) > 0
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
    worse = any(after[name] > 1.1 * before[name] + 0.01 for name in HEADER[:-2])
    what, share = (JUMPS, 0.5) if before[JUMPS] else (FEET, 0.75)
    helped = 0 < before[what] and after[what] <= share * before[what]
    return "harmed" if after[NEW] or worse else "helped" if helped else "as before"


def run(manifold: MotionManifold, folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Measure every motion file below the folders."""
    files = []
    refused = []
    for path in (path for folder in folders for path in find_motion_files(folder)):
        try:
            files.append(_File(path.name, load_motion(path), manifold))
        except (NumpyCaeError, ValueError) as problem:
            refused.append([path.name, *[None] * len(HEADER), f"refused: {problem}"])
    rows = [row for file in files for row in file.rows] + refused
    return Result(
        "Repair: real files",
        [Table("", ["file: method", *HEADER, "said"], rows)],
        _claims(files, len(refused)) if files else [],
    )


def _claims(files: Sequence[_File], refused: int) -> list[Claim]:
    claims = []
    for measure, key in ((JUMPS, "fewer_jumps"), (CHANGE, "less_changed")):
        pairs = {f: [f.measures[name][measure] for name in (f.proposed, FILTER)] for f in files}
        more = [file.name for file, (ours, theirs) in pairs.items() if ours > theirs]
        ours, theirs = np.nansum(list(pairs.values()), axis=0)
        figures = f"the sums are {ours:.4g} and {theirs:.4g}; not in {', '.join(more) or 'none'}."
        claims.append(Claim(key, not more, figures))
    damaged = [f for f in files if f.measures[BEFORE][JUMPS] or f.proposed != REPAIR]
    helped, harmed = (sum(f.verdict == word for f in damaged) for word in ("helped", "harmed"))
    touched = [f.name for f in files if f not in damaged and f.measures[REPAIR][CHANGE]]
    figures = (
        f"of {len(files) + refused} files {refused} refused and {len(damaged)} damaged, of these "
        f"{helped} helped, {harmed} harmed; changed without damage: {', '.join(touched) or 'none'}."
    )
    confirmed = helped >= 0.75 * len(damaged) and not harmed and not touched
    return [*claims, Claim("files_helped", confirmed, figures)]
