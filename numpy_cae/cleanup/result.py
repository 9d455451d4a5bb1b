"""What a repair changed: the motion, the joints that moved and how far, the findings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.cleanup.channels import LEAST_LEVER_METRES
from numpy_cae.cleanup.events import Event, list_events
from numpy_cae.cleanup.finding import Finding, is_path
from numpy_cae.cleanup.interpolation import mark_missing_joints
from numpy_cae.cleanup.kinds import JITTER, MARKED, NOT_FINITE, T_POSE
from numpy_cae.cleanup.words import (
    NOTHING_FOUND,
    count,
    cuts_in_words,
    first_lines,
    joints_by_frames,
    joints_in_words,
)
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, PARENTS, Motion
from numpy_cae.motion.masks import fade_in_and_out, runs
from numpy_cae.motion.motion import blocks
from numpy_cae.motion.quaternions import rotate, slerp

MOVED_METRES = 1e-6
"""A joint is touched if it moves by more than this (m)."""


@dataclass(frozen=True, repr=False, eq=False)
class Repaired:
    """A motion after a repair, and what was changed: its repr lists joints, frames and centimetres.

    Parameters
    ----------
    motion : Motion
        With the skeleton, rate and unit of the original motion, and its length unless a pose of
        reference was cut off.
    touched : (frames, 20) array of bool
        The joints that were changed, in the frames of `motion`.
    moved : (frames, 20) array of float64
        How far each joint, or a joint that follows it such as a finger, moved, metres.
    residual : float
        Median distance of a joint from its projection, metres; 0 where it was not measured.
    is_familiar : bool
        Whether the motion is like what the manifold was learned from.
    findings : tuple of Finding
        What was found to be damaged, and mended, in the frames of the file.
    proposed : tuple of Finding
        What was not changed: it is less certain, was left alone, or is right (`Finding.status`).
    original : Motion, optional
        The motion before the repair.
    cuts : tuple of int
        The frames of the file at which other clips begin (`cuts.find_cuts`).

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> touched = np.zeros((30, 20), bool)
    >>> touched[[3, 4, 5, 9], 0] = True
    >>> Repaired(motion, touched, 0.02 * touched)
    hips: frames 3 to 5, 9: moved 2.0 cm, at most 2.0
    """

    motion: Motion
    touched: np.ndarray
    moved: np.ndarray
    residual: float = 0.0
    is_familiar: bool = True
    findings: tuple[Finding, ...] = ()
    proposed: tuple[Finding, ...] = ()
    original: Motion | None = None
    cuts: tuple[int, ...] = ()

    def __repr__(self) -> str:
        """A line for joints that were changed in the same frames: names, frames, centimetres; then
        what was found, by kind, and what is proposed."""
        lines = []
        if self.cuts:
            lines.append(cuts_in_words(self.cuts))
        for frames, joints in joints_by_frames(self.touched).items():
            moved = 100 * self.moved[:, joints][self.touched[:, joints]]
            change = f"moved {moved.mean():.1f} cm, at most {moved.max():.1f}"
            lines.append(f"{joints_in_words(joints)}: {frames}: {change}")
        if any(finding.row is not MARKED for finding in self.findings):
            lines.append(f"{count(len(self.findings), 'finding')}:")
            numbered = enumerate(self.listed()[: len(self.findings)], start=1)
            lines += first_lines([f"  {number}. {finding}" for number, finding in numbered])
        if self.proposed:
            lines.append(f"{count(len(self.proposed), 'proposal')}, not changed:")
            numbered = enumerate(self.listed()[len(self.findings) :], start=1 + len(self.findings))
            lines += first_lines([f"  {number}. {finding}" for number, finding in numbered])
        if not self.is_familiar:
            lines.append(
                f"unlike what the model knows: joints are typically {100 * self.residual:.1f} cm "
                "from their projection, so only smoothing and filters were used, no prediction"
            )
        return "\n".join(lines) or NOTHING_FOUND

    def without_first(self, frames: int) -> "Repaired":
        """The repair without its first frames, which are a pose of reference; findings are in the
        frames of the file."""
        rest = slice(frames, None)
        cut = [finding for finding in self.proposed if frames and finding.row is T_POSE]
        return replace(
            self,
            motion=self.motion.at(rest),
            touched=self.touched[rest],
            moved=self.moved[rest],
            findings=(*[replace(finding, status="repaired") for finding in cut], *self.findings),
            proposed=tuple(finding for finding in self.proposed if finding not in cut),
        )

    def events(self) -> list[Event]:
        """The events, the largest first; then those of what was not changed."""
        return list_events([*self.findings, *self.proposed])

    def listed(self) -> list[Finding]:
        """The findings by their events: numbers 1, 2, … wherever they are listed."""
        listed: list[Finding] = []
        for event in self.events():
            listed += event.findings
        return listed


def measure_distances(before: Motion, after: Motion, from_hips: bool = False) -> np.ndarray:
    """How far each of the twenty joints moved, (frames, 20) in metres: the joint, or what follows
    it (its fingers, the second bone of the neck, the top of the head) and moved furthest; in the
    world, or from the hips."""
    skeleton = after.skeleton
    joints = rig_of(after).joints
    followed = []  # for each joint of the rig the one of the twenty that it follows
    for joint in range(len(skeleton.names)):
        above = [joints.index(x) for x in skeleton.path(joint) if x in joints]
        followed.append(above[0] if above else 0)
    changed = np.any(before.rotations != after.rotations, axis=(1, 2))
    changed |= np.any(before.translations != after.translations, axis=(1, 2))
    moved = np.zeros((len(after), len(joints)))
    for frames in blocks(np.flatnonzero(changed)):
        distance = _distance(before.at(frames), after.at(frames), joints[0] if from_hips else None)
        for joint, column in enumerate(followed):
            moved[frames, column] = np.maximum(moved[frames, column], distance[:, joint])
    return moved


def _distance(before: Motion, after: Motion, origin: int | None) -> np.ndarray:
    """How far each joint of the rig moved, or the point at the end of its bone where no other joint
    is, (frames, J) in metres; relative to the joint `origin` if it is given."""
    places, turns = before.forward_kinematics()
    new_places, new_turns = after.forward_kinematics()
    change = new_places - places
    if origin is not None:
        change -= change[:, [origin]]
    distance = np.linalg.norm(change, axis=-1)
    skeleton = after.skeleton
    for joint in set(range(len(skeleton.names))) - set(skeleton.parents):
        tip = np.asarray(skeleton.end_sites.get(joint, [0.0, LEAST_LEVER_METRES, 0.0]))
        turn = rotate(new_turns[:, joint], tip) - rotate(turns[:, joint], tip)
        of_tip = np.linalg.norm(change[:, joint] + turn, axis=-1)
        distance[:, joint] = np.maximum(distance[:, joint], of_tip)
    return distance


def weaken(repaired: Repaired, strength: float = 1.0, fade: float = 0.0) -> Repaired:
    """A repair of which a part is done: each rotation and place goes a share of its way.

    Parameters
    ----------
    repaired : Repaired
        With its original motion.
    strength : float
        0 to 1: 1 is the repair, 0 the original motion. Values that were not finite are those of the
        repair in any case.
    fade : float
        Each stretch of frames that were changed begins and ends with less of it, within this time
        (s), if the motion goes on there.

    Returns
    -------
    Repaired
        Without the findings of which nothing is left, if `strength` is 0.

    Raises
    ------
    ValueError
        If the strength is not 0 to 1.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.cleanup import repair_motion
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[30, 0] += [0.5, 0.0, 0.0]
    >>> repaired = repair_motion(motion)
    >>> half = weaken(repaired, 0.5)
    >>> round(float(half.moved.max() / repaired.moved.max()), 2)
    0.5
    """
    if not 0 <= strength <= 1:
        raise ValueError(f"strength is {strength}, expected 0 to 1")
    if not 0 <= fade < np.inf:
        raise ValueError(f"fade is {fade}, expected a time in seconds of 0 or more")
    if (strength == 1 and fade == 0) or repaired.original is None:
        return repaired
    after = repaired.motion
    before = repaired.original.at(slice(len(repaired.original) - len(after), None))
    is_there = np.isfinite(before.rotations).all(axis=-1)
    is_there &= np.isfinite(before.translations).all(axis=-1)
    changes = np.any(before.rotations != after.rotations, axis=-1)
    is_changed = np.asarray(repaired.touched.any(axis=1))
    shares = strength * _fading_shares(is_changed, fade * after.rate)
    rotations = after.rotations.copy()
    turned = is_there & changes
    share = np.broadcast_to(shares[:, None], turned.shape)[turned]
    rotations[turned] = slerp(before.rotations[turned], after.rotations[turned], share)
    way = np.where(is_there[..., None], after.translations - before.translations, 0.0)
    translations = after.translations - (1 - shares[:, None, None]) * way
    motion = replace(after, rotations=rotations, translations=translations)
    moved = shares[:, None] * repaired.moved
    findings = []
    for found in repaired.findings:
        cut = len(repaired.original) - len(after)
        part = shares[max(found.stretch.start - cut, 0) : max(found.stretch.stop - cut, 0)]
        findings.append(replace(found, cm=float(part.max(initial=0.0)) * found.cm))
    touched = repaired.touched
    if strength == 0:
        findings = []
        touched = mark_missing_joints(after, [x for x in repaired.findings if x.row is NOT_FINITE])
    return replace(repaired, motion=motion, moved=moved, touched=touched, findings=tuple(findings))


def _fading_shares(is_changed: np.ndarray, fade: float) -> np.ndarray:
    """The share (frames,) of a repair that is done if each stretch of changed frames begins and
    ends within `fade` frames."""
    shares = np.zeros(len(is_changed))
    for first, end in runs(is_changed).tolist():
        shares += fade_in_and_out(len(is_changed), slice(first, end), fade)
    return np.where(is_changed, shares, 1.0)


def compare_motions(
    before: Motion, after: Motion, findings: Sequence[Finding], broken: Sequence[Finding]
) -> Repaired:
    """What a repair changed, with what was found; `broken` values are interpolated in both."""
    moved = measure_distances(before, after)
    posed = moved
    if any(is_path(finding) for finding in findings):
        posed = measure_distances(before, after, from_hips=True)
    touched = (moved > MOVED_METRES) | mark_missing_joints(before, broken)
    mended = []
    proposed = []
    for finding in findings:
        if not finding.is_repaired:
            proposed.append(finding)
        elif not touched[finding.stretch, columns_below(finding.joint)].any():
            proposed.append(replace(finding, status="kept"))
        elif finding.row is JITTER:
            # Jitter is in all frames: what the rest of the findings moves would be its centimetres.
            mended.append(finding)
        else:
            mended.append(_with_centimetres(finding, moved, posed))
    return Repaired(after, touched, moved, findings=tuple(mended), proposed=tuple(proposed))


def _with_centimetres(finding: Finding, moved: np.ndarray, posed: np.ndarray) -> Finding:
    """The finding with the joint, its own or one below it, that moved furthest (m), and how far in
    centimetres: in `moved` for a path of the root, else in `posed`."""
    columns = columns_below(finding.joint)
    distances = (moved if is_path(finding) else posed)[finding.stretch, columns].max(axis=0)
    furthest = int(distances.argmax())
    return replace(finding, cm=100 * float(distances[furthest]), mover=JOINTS[columns[furthest]])


def columns_below(joint: str) -> list[int]:
    """The indices of one of the twenty joints and those below it; of any other name, all."""
    below = {joint} if joint in JOINTS else set(JOINTS)
    for name, parent in zip(JOINTS[1:], PARENTS[1:], strict=True):
        if JOINTS[parent] in below:
            below.add(name)
    return [JOINTS.index(name) for name in JOINTS if name in below]


def join_motions(first: Motion, rest: Motion) -> Motion:
    """The frames of a motion and then those of another one of the same rig."""
    if not len(first):
        return rest
    rotations = np.concatenate([first.rotations, rest.rotations])
    translations = np.concatenate([first.translations, rest.translations])
    return replace(rest, rotations=rotations, translations=translations)
