"""Whether a step of a repair has made the motion worse near a finding: what it changed is measured
first (`measure_changes`), and then judged (`find_worse`)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.finding import Finding
from numpy_cae.cleanup.kinds import LIMB_TURNED, LIMB_TURNED_QUICKLY, REPEATED, TURNED
from numpy_cae.cleanup.measures import is_larger, measure_view
from numpy_cae.cleanup.view import SHARP, View
from numpy_cae.motion.contacts import foot_speeds, lower_foot
from numpy_cae.motion.masks import widen_runs

NEAR_SECONDS = 0.25
"""Jumps and sliding feet are looked at within this time of the damage (s)."""
MORE_SLIDING_SHARE = 0.1
"""Feet slide more if their speed grows by more than this share of it, and by more than
`MORE_SLIDING_CENTIMETRES`."""
MORE_SLIDING_CENTIMETRES = 2.0
"""Feet slide more if their speed grows by more than this (cm/s)."""
JUMPY_SHARE = 0.05
"""A motion jumps all the time if joints jump sharply in more than this share of its frames. Then
its feet hardly stand, and much is won if some of the jumps near a finding are gone."""


class Tolerance(NamedTuple):
    """What a step of a repair may leave near a finding.

    Parameters
    ----------
    jumps : float
        At most this share of the jumps.
    sharp_jumps : float or None
        Feet must not slide more if at least this share of the sharp jumps near all findings is
        left; None if feet may slide more. A body that was still, or that jumped, did not slide.
    """

    jumps: float = 1.0
    sharp_jumps: float | None = None


class Change(NamedTuple):
    """Two values of a measure: before and after a step."""

    before: float
    after: float


class Changes(NamedTuple):
    """What a step has changed.

    Parameters
    ----------
    jumps : Change
        How many steps of joints jump near the findings.
    sharp_jumps : Change
        How many of these are sharp.
    is_jumpy : bool
        Whether joints jumped all the time before (`JUMPY_SHARE`).
    jumps_near : list of Change
        For each finding the jumps near it; those that are sharp count twice.
    sliding_near : list of Change
        For each finding how fast feet slide that stood near it, centimetres a second.
    """

    jumps: Change
    sharp_jumps: Change
    is_jumpy: bool
    jumps_near: list[Change]
    sliding_near: list[Change]


def measure_changes(before: View, after: View, findings: list[Finding]) -> Changes:
    """What a step that mended findings has changed near them."""
    margin = before.frames(NEAR_SECONDS)
    is_near = np.zeros((len(before), 1), bool)
    for finding in findings:
        is_near[finding.stretch] = True
    frames = np.flatnonzero(widen_runs(is_near, margin)[:-1])
    levels = before.jump_levels(frames)
    levels_after = after.jump_levels(frames)
    sliding, sliding_after = standing_speeds(before, after)
    jumps_near = []
    sliding_near = []
    for finding in findings:
        near = slice(max(finding.stretch.start - margin, 0), finding.stretch.stop + margin)
        jumps_near.append(Change(int(levels[near].sum()), int(levels_after[near].sum())))
        standing = max(np.count_nonzero(sliding[near]), 1)
        speed = float(sliding[near].sum() / standing)
        sliding_near.append(Change(speed, float(sliding_after[near].sum() / standing)))
    sharp_frames = np.count_nonzero((levels == SHARP).any(axis=1))
    return Changes(
        jumps=Change(_count(levels > 0), _count(levels_after > 0)),
        sharp_jumps=Change(_count(levels == SHARP), _count(levels_after == SHARP)),
        is_jumpy=bool(sharp_frames > JUMPY_SHARE * len(before)),
        jumps_near=jumps_near,
        sliding_near=sliding_near,
    )


def has_worse_figures(before: View, after: View, findings: Sequence[Finding]) -> bool:
    """Whether a figure of a whole motion (`measures.Measures`) is worse after findings are mended.

    Where feet slide more, the thresholds above decide, of feet that stood before: a leg that was
    turned stood nowhere, and a body whose pose was repeated did not slide. Neither they nor
    jitter count in a motion that jumps all the time, whose feet hardly stand, if it jumps less.
    """
    figures = measure_view(before)
    figures_after = measure_view(after)
    if is_larger(figures.jumps, figures_after.jumps):
        return True
    if figures.jumps > JUMPY_SHARE * len(before) and figures_after.jumps < figures.jumps:
        return False
    if is_larger(figures.jitter, figures_after.jitter):
        return True
    if not is_larger(figures.sliding, figures_after.sliding):
        return False
    sliding, sliding_after = standing_speeds(before, after)
    stood = np.ones(len(before), bool)
    for finding in findings:
        if finding.row in (REPEATED, LIMB_TURNED, LIMB_TURNED_QUICKLY, TURNED):
            # The frames beside an offset are interpolated with its ends.
            first = max(finding.stretch.start - 1, 0)
            stood[first : finding.stretch.stop + 1] = False
    sliding = sliding[stood]
    standing = max(np.count_nonzero(sliding), 1)
    speed = float(sliding.sum() / standing)
    speed_after = float(sliding_after[stood].sum() / standing)
    more = max(MORE_SLIDING_SHARE * speed, MORE_SLIDING_CENTIMETRES)
    return speed_after - speed > more


def _count(mask: np.ndarray) -> int:
    return int(np.count_nonzero(mask))


def standing_speeds(before: View, after: View) -> tuple[np.ndarray, np.ndarray]:
    """How fast feet that stand in a motion slide to the next frame before and after a step of a
    repair, 0 where none stands and in the last frame, (frames,) each in centimetres a second."""
    lower, is_on_floor = lower_foot(before.toes)
    stands = is_on_floor[:, None] & (lower[:, None] == [0, 1])
    speeds = np.where(stands, foot_speeds(before.toes, before.rate), 0.0).sum(axis=1)
    speeds_after = np.where(stands, foot_speeds(after.toes, after.rate), 0.0).sum(axis=1)
    return np.append(speeds, 0.0), np.append(speeds_after, 0.0)


def find_worse(findings: list[Finding], changes: Changes, tolerance: Tolerance) -> list[Finding]:
    """The findings near which a step has made the motion worse: too many of the jumps are left, or
    feet slide more. All findings if too many of the jumps near any of them are left.

    Where joints jump all the time, each finding is judged by its jumps alone: feet that jump hardly
    stand.
    """
    most_jumps = tolerance.jumps * changes.jumps.before
    if changes.jumps.after > most_jumps and not changes.is_jumpy:
        return findings
    feet_count = False
    if tolerance.sharp_jumps is not None and not changes.is_jumpy:
        sharp = changes.sharp_jumps
        feet_count = sharp.after >= tolerance.sharp_jumps * sharp.before
    worse = []
    for finding, jumps, sliding in zip(
        findings, changes.jumps_near, changes.sliding_near, strict=True
    ):
        more = max(MORE_SLIDING_SHARE * sliding.before, MORE_SLIDING_CENTIMETRES)
        slides_more = sliding.after - sliding.before > more
        if jumps.after > tolerance.jumps * jumps.before or (feet_count and slides_more):
            worse.append(finding)
    return worse
