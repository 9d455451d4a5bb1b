"""Repair of a motion (holden2015, section 7, "Fixing Corrupt Motion Data").

The paper projects the whole motion (`project_motion`), which also changes what was right.
`repair_motion` changes only what is damaged, and `fill_motion` only what the user says is missing.
A repair is

    find a T-pose at the start, and set it aside
    split the rest at cuts, where other clips begin; of each part (`repair_part`)
        find what the file itself shows: `find_segments`
        mend it, kind by kind, and what is found on the way: each of `STEPS`
        fill in what is missing for long, by the manifold
        leave what made the figures of the part worse
    join the parts, and put the T-pose back

Between the first and the last line, frames are counted from the end of the T-pose, in a part from
its start. The manifold
works at thirty frames a second, (F, …); masks and findings are in the frames of the file,
(frames, …).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.cuts import find_cuts
from numpy_cae.cleanup.displacements import find_displacements, mend_displacements
from numpy_cae.cleanup.feet import find_feet, mend_feet
from numpy_cae.cleanup.finding import (
    Finding,
    check_finding,
    findings_of_mask,
    findings_within,
    joint_names,
    shift_findings,
)
from numpy_cae.cleanup.freezes import find_freezes, find_t_pose, is_held
from numpy_cae.cleanup.holes import UNKNOWN_METRES, complete_holes, fill_holes
from numpy_cae.cleanup.interpolation import interpolate_channels, with_finite_values
from numpy_cae.cleanup.judging import (
    Tolerance,
    find_worse,
    has_worse_figures,
    measure_changes,
)
from numpy_cae.cleanup.jumps import find_jitter, find_jumps, mend_jumps, smooth_motion
from numpy_cae.cleanup.kinds import BODY, MARKED, REPEATED, T_POSE
from numpy_cae.cleanup.limb_turns import find_limb_turns, mend_limb_turns
from numpy_cae.cleanup.presets import Preset
from numpy_cae.cleanup.quick_turns import find_quick_turns, mend_quick_turns
from numpy_cae.cleanup.result import Repaired, compare_motions, join_motions, measure_distances
from numpy_cae.cleanup.spikes import find_spikes
from numpy_cae.cleanup.view import View
from numpy_cae.fast.thread_team import one_thread
from numpy_cae.manifold.filling import require_mask
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion.motion import Motion, require_finite

MOST_ROUNDS = 4
"""A step is taken at most this often, each time without the findings near which the motion became
worse."""
LONGEST_INTERPOLATED_SECONDS = 1.0
"""What the manifold does not fill in is interpolated for at most this time (s), unless the user
asks for more: a straight line of a second is not what people do."""
Verdicts = dict[tuple[str, tuple[int, int], str], str]
"""The status of findings that are not mended, by their joint, frames and kind."""
Progress = Callable[[float], None]
"""A function that takes the share of the time of a repair that has passed, roughly."""


def interpolate_damage(view: View, findings: list[Finding]) -> Motion:
    """The motion with the damaged channels of findings interpolated."""
    return interpolate_channels(view.motion, findings)


class Part(NamedTuple):
    """A part of a motion between two cuts, after its repair.

    Parameters
    ----------
    motion : Motion
    damage : list of Finding
        What was found, in frames of the part.
    residual : float
        As in `Repaired`.
    """

    motion: Motion
    damage: list[Finding]
    residual: float


class Step(NamedTuple):
    """A step of a repair, which mends the kinds of damage whose row names it (`Kind.step`).

    Parameters
    ----------
    name : str
    find : function (view, sensitivity), optional
        Finds the damage in the motion as the steps before have left it; None if `find_segments` has
        found it in the motion as it was.
    mend : function (view, findings)
        Returns the motion without the damage; the motion of the view itself where nothing was done.
    work : float
        The processor time of the step in comparison with others: between those measured as motion
        from video on five minutes of a dance from video and on three of damaged synthetic motion,
        whose limb turns took 0.39 and 0.69 of the time. It tells how much of a repair is done.
    tolerance : Tolerance, optional
        What the step may leave near a finding: what leaves more is undone. None for a step that
        judges its result itself.
    option : str
        The setting of a preset with which the step is taken; "" if it is always taken.
    needs_manifold : bool
        Whether `find` and `mend` take the manifold as their last argument; without a manifold the
        step is left out.
    """

    name: str
    find: Callable[..., list[Finding]] | None
    mend: Callable[..., Motion]
    work: float
    tolerance: Tolerance | None = Tolerance()
    option: str = ""
    needs_manifold: bool = False

    def is_chosen(self, preset: Preset) -> bool:
        """Whether the preset has the option of the step."""
        return bool(self.option) and bool(getattr(preset, self.option))


STEPS = (
    Step("freezes", None, interpolate_damage, 0.6),
    Step("displacements", None, mend_displacements, 0.2),
    Step("spikes", None, interpolate_damage, 0.1),
    # After the spikes, of which two look like both ends of a turn.
    Step("quick turns", find_quick_turns, mend_quick_turns, 3.0),
    Step("limb turns", find_limb_turns, mend_limb_turns, 10.0, needs_manifold=True),
    Step("jitter", find_jitter, smooth_motion, 2.5, Tolerance(sharp_jumps=0.5), option="smooth"),
    Step("jumps", find_jumps, mend_jumps, 0.2, Tolerance(jumps=0.65, sharp_jumps=0.0)),
    Step("feet", find_feet, mend_feet, 3.5, tolerance=None, option="feet"),
)
"""What is mended, in this order, before holes are filled in."""
WORK_AFTER_STEPS = 1.2
"""The processor time of filling in holes and of comparing the motion before and after, measured as
`Step.work`."""


@one_thread()
def repair_motion(
    motion: Motion,
    manifold: MotionManifold | None = None,
    damaged: np.ndarray | None = None,
    preset: Preset | None = None,
    findings: Sequence[Finding] | None = None,
    progress: Progress | None = None,
) -> Repaired:
    """Find what is damaged in a motion and mend it; the rest of the motion is unchanged.

    What the file itself shows is mended first, by `STEPS`, of which one asks the manifold too. The
    manifold then corrects what was interpolated for long. What is less certain is proposed. In a
    motion that is unlike what the manifold learned from (`Repaired.is_familiar` False) it corrects
    only what is marked.

    Parameters
    ----------
    motion : Motion
        A motion at any rate, on any rig in which the twenty joints can be found.
    manifold : MotionManifold or None
        With None the steps that need no model are taken.
    damaged : (frames, 20) array of bool, optional
        In the frames of the file: only this is repaired, and nothing is looked for.
    preset : Preset, optional
        Which steps are taken; `Preset()` by default.
    findings : sequence of Finding, optional
        Only these are mended, whatever their confidence, unless their status is "proposed" or
        "left"; nothing is looked for.
    progress : function (share), optional
        Called after each step with the share of the time that has passed, roughly.

    Returns
    -------
    Repaired

    Raises
    ------
    UnknownRigError, ValueError
        If joints of the rig are missing; if a finding is of a joint or of frames that the motion
        does not have.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> from numpy_cae.cleanup import repair_motion
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30:33, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> repaired = repair_motion(motion, starter())
    >>> repaired.findings[0].joint, repaired.findings[0].frames, repaired.findings[0].kind
    ('left_elbow', (30, 32), 'spike')
    """
    preset = preset or Preset()
    if damaged is not None:
        findings = findings_of_mask(damaged)
    if findings is not None:
        findings = [check_finding(motion, finding) for finding in findings]
    finite, broken = with_finite_values(motion)
    view = View(finite)
    if findings is None:
        t_pose = find_t_pose(finite, view)
    else:
        t_pose = [finding for finding in findings if finding.row is T_POSE]
    pose, moving = split_t_pose(finite, t_pose)
    start = len(pose)  # frames are counted from here
    named = None
    if findings is not None:
        rest = [finding for finding in findings if finding.row is not T_POSE]
        named = shift_findings(rest, -start)
    if start:
        view = View(moving)
    cuts = find_cuts(view)
    if named:
        cuts = [cut for cut in cuts if not _covers(named, cut)]
    parts = []
    for first, end in pairwise([0, *cuts, len(moving)]):
        part = View(moving.at(slice(first, end))) if cuts else view
        named_there = None if named is None else findings_within(named, first, end)
        broken_there = findings_within(shift_findings(broken, -start), first, end)
        parts.append(
            repair_part(
                part,
                named_there,
                broken_there,
                preset,
                manifold,
                _progress_of_part(progress, first / len(moving), end / len(moving)),
            )
        )
    mended, damage, residual = join_parts(parts)
    damage = [*t_pose, *shift_findings(damage, start)]
    repaired = compare_motions(finite, join_motions(pose, mended), damage, broken)
    is_familiar = residual <= UNKNOWN_METRES
    repaired = replace(
        repaired,
        original=motion,
        residual=residual,
        is_familiar=is_familiar,
        cuts=tuple(start + cut for cut in cuts),
    )
    return repaired.without_first(start) if preset.cut else repaired


def repair_part(
    view: View,
    findings: Sequence[Finding] | None,
    broken: list[Finding],
    preset: Preset,
    manifold: MotionManifold | None,
    progress: Progress | None = None,
) -> Part:
    """The repair of a motion without cuts and without a T-pose: of `findings`, or, with None, of
    what the file shows. The values of `broken` are interpolated.

    A finding whose repair would make a printed figure worse (`judging.has_worse_figures`) is left,
    unless the user asks for more than a plain repair. A finding that would be interpolated for
    longer than `LONGEST_INTERPOLATED_SECONDS` is proposed.
    """
    if findings is not None:
        mended, damage = mend_findings(view, findings, preset, manifold, progress)
        return _complete(mended, [*damage, *broken], manifold)
    verdicts: Verdicts = {}
    for _ in range(MOST_ROUNDS + 1):
        mended, damage = mend_view(view, preset, manifold, progress, verdicts)
        part = _complete(mended, [*damage, *broken], manifold)
        repaired = [finding for finding in damage if finding.is_repaired]
        objections = _find_objections(view, part, repaired, preset, manifold is not None)
        if not objections:
            break
        verdicts |= objections
    else:
        part = _complete(view.motion, [*_with_status(damage, []), *broken], manifold)
    return part


def _find_objections(
    before: View, part: Part, repaired: list[Finding], preset: Preset, has_manifold: bool
) -> Verdicts:
    """The findings whose repair is to be taken back, with their new status."""
    if not repaired:
        return {}
    if not has_manifold or part.residual > UNKNOWN_METRES:
        longest = LONGEST_INTERPOLATED_SECONDS * before.rate
        too_long = []
        for finding in repaired:
            first, last = finding.frames
            if finding.row.is_filled and last + 1 - first > longest:
                too_long.append(finding)
        if too_long:
            return {_key(finding): "proposed" for finding in too_long}
    if preset.smooth or preset.feet:
        return {}
    after = before.after(part.motion)
    if not has_worse_figures(before, after, repaired):
        return {}
    changes = measure_changes(before, after, repaired)
    worse = find_worse(repaired, changes, Tolerance(sharp_jumps=0.0))
    return {_key(finding): "left" for finding in worse or repaired}


def _key(finding: Finding) -> tuple[str, tuple[int, int], str]:
    """By which a finding is found again in another repair of the same motion."""
    return finding.joint, finding.frames, finding.kind


def _complete(motion: Motion, damage: list[Finding], manifold: MotionManifold | None) -> Part:
    """The part of a motion whose damage is mended, with holes filled in by the manifold."""
    if manifold is None:
        return Part(motion, damage, 0.0)
    motion, residual = complete_holes(motion, manifold, damage)
    return Part(motion, damage, residual)


def join_parts(parts: Sequence[Part]) -> Part:
    """The parts of a motion one after the other, with the largest of their residuals."""
    motion = parts[0].motion
    damage = list(parts[0].damage)
    for part in parts[1:]:
        damage += shift_findings(part.damage, len(motion))
        motion = join_motions(motion, part.motion)
    return Part(motion, damage, max(part.residual for part in parts))


def _covers(findings: Sequence[Finding], cut: int) -> bool:
    """Whether a finding of the user begins before a cut and ends after it: the user then says what
    is right on both sides."""
    return any(finding.frames[0] < cut <= finding.frames[1] for finding in findings)


def _progress_of_part(progress: Progress | None, first: float, end: float) -> Progress | None:
    """A function that takes the share of the time of a part that has passed, which is from the
    share `first` to `end` of all."""
    if progress is None:
        return None
    return lambda share: progress(first + share * (end - first))


def split_t_pose(motion: Motion, t_pose: list[Finding]) -> tuple[Motion, Motion]:
    """The frames of a T-pose at the start of a motion, and the rest; without a T-pose no frames and
    the motion itself."""
    start = max((finding.stretch.stop for finding in t_pose), default=0)
    pose = motion.at(slice(start))
    return pose, motion.at(slice(start, None)) if start else motion


def mend_damage(motion: Motion, preset: Preset | None = None) -> tuple[Motion, list[Finding]]:
    """Find the damage that the file itself shows, and mend it, without a manifold.

    Parameters
    ----------
    motion : Motion
    preset : Preset, optional
        Findings have a confidence of at least 1 - `preset.sensitivity`.

    Returns
    -------
    Motion, list of Finding

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30:32, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> [finding.kind for finding in mend_damage(motion)[1]]
    ['spike']
    """
    return mend_view(View(motion), preset or Preset())


def mend_view(
    view: View,
    preset: Preset,
    manifold: MotionManifold | None = None,
    progress: Progress | None = None,
    verdicts: Verdicts | None = None,
) -> tuple[Motion, list[Finding]]:
    """Find and mend the damage of a motion (`mend_damage`), with the steps that need the manifold
    if there is one, and without mending what `verdicts` say; `progress` is as in `repair_motion`.
    """
    verdicts = verdicts or {}
    segments = find_segments(view, preset.sensitivity)
    holds_poses = is_held(segments, len(view))
    damage: list[Finding] = []
    for step in steps_with(manifold):
        if step.option and not step.is_chosen(preset):
            continue
        if holds_poses and not step.option and step.name != REPEATED.step:
            continue
        if step.find:
            findings = step.find(view, preset.sensitivity)
        else:
            findings = [finding for finding in segments if finding.row.step == step.name]
            findings = drop_explained(findings, _explanations(damage, verdicts), view.motion)
        findings = [_with_verdict(finding, verdicts) for finding in findings]
        view, findings = take_step_if_better(step, view, findings)
        damage += findings
        if progress:
            progress(share_of_work(step, preset))
    return view.motion, damage


def _explanations(damage: list[Finding], verdicts: Verdicts) -> list[Finding]:
    """The findings of damage, those with a verdict as if they were mended: what is left alone still
    explains what is there."""
    explanations = []
    for finding in damage:
        if _key(finding) in verdicts:
            explanations.append(replace(finding, status="repaired"))
        else:
            explanations.append(finding)
    return explanations


def _with_verdict(finding: Finding, verdicts: Verdicts) -> Finding:
    """The finding with the status that a verdict gives it."""
    return replace(finding, status=verdicts.get(_key(finding), finding.status))


def mend_findings(
    view: View,
    findings: Sequence[Finding],
    preset: Preset,
    manifold: MotionManifold | None = None,
    progress: Progress | None = None,
) -> tuple[Motion, list[Finding]]:
    """Mend what the user names, whatever that does elsewhere, and look only for what an option of
    the preset asks for. Parameters and results are those of `mend_view`."""
    damage: list[Finding] = []
    for step in steps_with(manifold):
        if step.find and step.is_chosen(preset):
            of_step = step.find(view, preset.sensitivity)
        else:
            of_step = [finding for finding in findings if finding.row.step == step.name]
        view, of_step = take_step(step, view, of_step)
        damage += of_step
        if progress:
            progress(share_of_work(step, preset))
    return view.motion, damage + [finding for finding in findings if finding.row is MARKED]


def share_of_work(last: Step, preset: Preset) -> float:
    """The share of the work of a repair that is done after a step, roughly."""
    done = 0.0
    total = WORK_AFTER_STEPS
    is_done = True
    for step in STEPS:
        if step.option and not step.is_chosen(preset):
            continue
        total += step.work
        if is_done:
            done += step.work
        if step.name == last.name:
            is_done = False
    return done / total


def steps_with(manifold: MotionManifold | None) -> Iterator[Step]:
    """The steps that can be taken; those that need the manifold with it."""
    for step in STEPS:
        if not step.needs_manifold:
            yield step
        elif manifold is not None:
            mend = partial(step.mend, manifold=manifold)
            find = partial(step.find, manifold=manifold) if step.find else None
            yield step._replace(find=find, mend=mend)


def find_segments(view: View, sensitivity: float = 0.5) -> list[Finding]:
    """What stands still, is displaced or is a spike, in the motion as it is."""
    displacements = find_displacements(view, sensitivity)
    spikes = drop_explained(find_spikes(view, sensitivity), displacements, view.motion)
    return find_freezes(view, sensitivity) + displacements + spikes


def drop_explained(findings: list[Finding], mended: list[Finding], motion: Motion) -> list[Finding]:
    """The findings that do not touch what was mended of their joint or of the whole body: a
    rotation that is frozen jumps where it ends, and all joints jump where a pose is repeated.
    """
    names = [BODY, *joint_names(motion)]
    explained = np.zeros((len(motion) + 1, len(names)), bool)
    for finding in mended:
        if finding.is_repaired:
            explained[_touched_frames(finding, motion), names.index(finding.joint)] = True
    unexplained = []
    for finding in findings:
        columns = [0, names.index(finding.joint)]
        if not explained[_touched_frames(finding, motion)][:, columns].any():
            unexplained.append(finding)
    return unexplained


def _touched_frames(finding: Finding, motion: Motion) -> np.ndarray:
    """The frames of a finding and those beside them; of an offset only those around its ends: what
    is between them is right but for the offset."""
    frames = np.arange(finding.frames[0] - 1, finding.frames[1] + 2).clip(0, len(motion))
    return frames[[0, 1, -2, -1]] if finding.row.is_offset else frames


def take_step(step: Step, view: View, findings: list[Finding]) -> tuple[View, list[Finding]]:
    """The motion after a step, and the findings with what became of them."""
    mended = [finding for finding in findings if finding.is_repaired]
    after = _mend(step, view, mended)
    if after is view and step.option:
        mended = []
    return after, _with_status(findings, mended)


def take_step_if_better(
    step: Step, view: View, findings: list[Finding]
) -> tuple[View, list[Finding]]:
    """The motion after a step without the findings near which it would become worse, and the
    findings with what became of them."""
    if step.tolerance is None:
        return take_step(step, view, findings)
    mended = [finding for finding in findings if finding.is_repaired]
    for _ in range(MOST_ROUNDS):
        after = _mend(step, view, mended)
        if not mended:
            break
        worse = find_worse(mended, measure_changes(view, after, mended), step.tolerance)
        if not worse:
            break
        mended = [finding for finding in mended if finding not in worse]
    else:
        after = view
        mended = []
    if after is view and step.option:
        mended = []
    return after, _with_status(findings, mended)


def _mend(step: Step, view: View, findings: list[Finding]) -> View:
    """The view of the motion with findings mended; the same view where there are none."""
    return view.after(step.mend(view, findings)) if findings else view


def _with_status(findings: list[Finding], mended: list[Finding]) -> list[Finding]:
    """The findings that were mended, then those that were left, then those that are proposed."""
    unmended = []
    proposed = []
    for finding in findings:
        if not finding.is_repaired:
            proposed.append(finding)
        elif finding not in mended:
            unmended.append(replace(finding, status="left"))
    return mended + unmended + proposed


@one_thread()
def fill_motion(motion: Motion, manifold: MotionManifold, missing: np.ndarray) -> Repaired:
    """Fill in the joints of a motion that are missing; the values of the file are ignored there.

    All bone lengths are kept. A joint within a limb, such as an elbow whose wrist is given, can
    only be on a circle about the line between its neighbours and is moved to the point of it
    nearest to the filled position. Where the whole pose is missing, the root moves along a smooth
    curve, and rotations that positions do not determine (about a bone's axis, of fingers) are
    interpolated.

    Parameters
    ----------
    motion : Motion
        A motion at any rate, on any rig in which the twenty joints can be found.
    manifold : MotionManifold
    missing : (frames, 20) array of bool
        In the frames of the file; `keyframe_mask` makes that of keyframes.

    Returns
    -------
    Repaired

    Raises
    ------
    UnknownRigError, ValueError
        If joints of the rig are missing; if the mask has another shape; if values of the motion are
        not finite, which `repair` mends.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import keyframe_mask, starter
    >>> from numpy_cae.cleanup import fill_motion
    >>> motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> fill_motion(motion, starter(), keyframe_mask(30, 10))
    all joints: frames 1 to 9, 11 to 19: moved 3.8 cm, at most 26.1
    """
    require_finite(motion)
    missing = require_mask(missing, len(motion))
    body = Body(motion, manifold.lengths)
    filled = fill_holes(manifold, body, findings_of_mask(missing))
    return Repaired(filled, missing, measure_distances(motion, filled), original=motion)
