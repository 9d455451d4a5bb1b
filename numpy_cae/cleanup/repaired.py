"""What a repair changed; in a few sentences and numbers, as the page shows it first."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.cleanup.curves import LEAST_LEVER_METRES, sliding
from numpy_cae.cleanup.finding import STATUSES, Finding, is_path
from numpy_cae.cleanup.interpolated import missing_joints, with_finite_values
from numpy_cae.cleanup.jumps import SHARP, jump_levels
from numpy_cae.cleanup.presets import PRESETS, fitting_preset, shaking
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, PARENTS, Motion
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import blocks
from numpy_cae.motion.quaternions import rotate

MOVED_METRES = 1e-6
"""MOVED_METRES: a joint is touched if it moves by more than this (m)."""
MOST_PRINTED = 5
"""MOST_PRINTED: at most this many runs of frames, and findings, are printed in full."""
NOT_DONE = {"proposed": "proposed, not changed", "left": "found, left alone"}
WHY = {"proposed": "not certain enough", "left": STATUSES["left"].partition(", since ")[2]}
"""NOT_DONE, WHY: what is said of findings of a status that were not repaired, and the reason."""


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
    known : bool
        Whether the motion is like what the manifold was learned from.
    findings : tuple of Finding
        What was found to be damaged, and mended, in the frames of the file.
    proposed : tuple of Finding
        What is less certain, and was not changed.
    original : Motion, optional
        The motion before the repair.

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
    known: bool = True
    findings: tuple[Finding, ...] = ()
    proposed: tuple[Finding, ...] = ()
    original: Motion | None = None

    def __repr__(self) -> str:
        """A line for joints that were changed in the same frames: names, frames, centimetres; then
        what was found, by kind, and what is proposed."""
        groups: dict[str, list[int]] = defaultdict(list)
        for joint in np.flatnonzero(self.touched.any(axis=0)):
            groups[_frames_of(self.touched[:, joint])].append(int(joint))
        lines = []
        for frames, joints in groups.items():
            moved = 100 * self.moved[:, joints][self.touched[:, joints]]
            names = ", ".join(JOINTS[joint] for joint in joints)
            names = "all joints" if len(joints) == len(JOINTS) else names
            change = f"moved {moved.mean():.1f} cm, at most {moved.max():.1f}"
            lines.append(f"{names}: {frames}: {change}")
        if any(finding.kind != "marked" for finding in self.findings):
            numbered = enumerate(by_size(self.findings), start=1)
            lines.append(f"{count(len(self.findings), 'finding')}:")
            lines += few([f"  {number}. {each}" for number, each in numbered])
        if self.proposed:
            lines.append(f"{count(len(self.proposed), 'proposal')}, not changed:")
            lines += few([f"  {each}" for each in by_size(self.proposed)])
        if not self.known:
            lines.append(
                f"unlike what the model knows: joints are typically {100 * self.residual:.1f} cm "
                "from their projection, so only smoothing and filters were used, no prediction"
            )
        return "\n".join(lines) or "nothing to repair was found"

    def without_first(self, frames: int) -> "Repaired":
        """The repair without its first frames; findings are in the frames of the file."""
        rest = slice(frames, None)
        motion = self.motion.at(rest)
        return replace(self, motion=motion, touched=self.touched[rest], moved=self.moved[rest])

    def listed(self) -> list[Finding]:
        """The findings, the largest first: numbers 1, 2, … wherever they are listed; then the
        proposals."""
        return by_size(self.findings) + by_size(self.proposed)


def by_size(findings: Iterable[Finding]) -> list[Finding]:
    """The findings, those of the largest centimetres first, then the most certain."""
    return sorted(findings, key=lambda finding: (-finding.cm, -finding.confidence))


def count(number: int, noun: str) -> str:
    """A number with its noun, such as "1 finding" and "2 findings"."""
    return f"{number} {noun}{'s' * (number != 1)}"


def few(lines: list[str]) -> list[str]:
    """The first lines, and how many more there are."""
    more = len(lines) - MOST_PRINTED
    return lines[:MOST_PRINTED] + [f"  and {more} more"] * (more > 0)


def _frames_of(mask: np.ndarray) -> str:
    """The runs of a mask (frames,), such as "frames 30 to 45, 102"."""
    ends = runs(mask)
    texts = [f"{a} to {b - 1}" if b - a > 1 else f"{a}" for a, b in ends[:MOST_PRINTED]]
    more = f" and {len(ends) - MOST_PRINTED} more" if len(ends) > MOST_PRINTED else ""
    return f"frame{'' if mask.sum() == 1 else 's'} {', '.join(texts)}{more}"


def distances(before: Motion, after: Motion, from_hips: bool = False) -> np.ndarray:
    """How far each of the twenty joints moved, (frames, 20) in metres: the joint, or what follows
    it (its fingers, the second bone of the neck, the top of the head) and moved furthest; in the
    world, or from the hips."""
    skeleton = after.skeleton
    joints = rig_of(after).joints
    followed = [
        next((joints.index(above) for above in skeleton.path(joint) if above in joints), 0)
        for joint in range(len(skeleton.names))
    ]
    changed = np.any(before.rotations != after.rotations, axis=(1, 2))
    changed |= np.any(before.translations != after.translations, axis=(1, 2))
    moved = np.zeros((len(after), len(joints)))
    for frames in blocks(np.flatnonzero(changed)):
        distance = _distance(before.at(frames), after.at(frames), joints[0] if from_hips else None)
        for joint, of in enumerate(followed):
            moved[frames, of] = np.maximum(moved[frames, of], distance[:, joint])
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
        carried = rotate(new_turns[:, joint], tip) - rotate(turns[:, joint], tip)
        of_tip = np.linalg.norm(change[:, joint] + carried, axis=-1)
        distance[:, joint] = np.maximum(distance[:, joint], of_tip)
    return distance


def repaired_of(
    before: Motion, after: Motion, found: Sequence[Finding], broken: Sequence[Finding]
) -> Repaired:
    """What a repair changed, with what was found; `broken` values are interpolated in both."""
    moved = posed = distances(before, after)
    if any(is_path(finding) for finding in found):
        posed = distances(before, after, from_hips=True)
    touched = (moved > MOVED_METRES) | missing_joints(before, broken)
    done = [finding for finding in found if finding.status == "repaired"]
    left = [finding for finding in found if finding.status != "repaired"]
    # Jitter is in all frames: what all other findings move would be its centimetres.
    measured = [x if x.kind == "jitter" else _with_centimetres(x, moved, posed) for x in done]
    return Repaired(after, touched, moved, findings=tuple(measured), proposed=tuple(left))


def _with_centimetres(finding: Finding, moved: np.ndarray, posed: np.ndarray) -> Finding:
    """The finding with the largest distance (m) of its joint or one below it, in centimetres: in
    `moved` for a path of the root, in `posed` for others."""
    below = {finding.joint} if finding.joint in JOINTS else set(JOINTS)
    for joint, parent in zip(JOINTS[1:], PARENTS[1:], strict=True):
        if JOINTS[parent] in below:
            below.add(joint)
    there = (moved if is_path(finding) else posed)[finding.stretch]
    cm = 100 * there[:, [JOINTS.index(joint) for joint in below]].max(initial=0.0)
    return replace(finding, cm=float(cm))


def joined(first: Motion, rest: Motion) -> Motion:
    """A motion after the frames of another one of the same rig."""
    if not len(first):
        return rest
    rotations = np.concatenate([first.rotations, rest.rotations])
    translations = np.concatenate([first.translations, rest.translations])
    return replace(rest, rotations=rotations, translations=translations)


FITS = {"video": "shakes and whose feet slide", "suit": "begins with a pose of reference"}
"""FITS: what a preset that `fitting_preset` names fits."""
Measures = list[tuple[str, float, float]]
"""The name of each measure with its unit, and its value before and after."""


def sentences(repaired: Repaired, command: str = "") -> list[str]:
    """What was found and changed, what a user should know about it and, if there is a `command` to
    which --from can be added, which preset fits."""
    kinds = Counter(finding.kind for finding in repaired.findings)
    found = ", ".join(f"{kind} {number}" for kind, number in kinds.most_common())
    changed = repaired.touched.any(axis=1).sum() / repaired.motion.rate
    said = [f"{count(len(repaired.findings), 'finding')}{f': {found}' if found else ''}"]
    said.append(f"{changed:.1f} of {repaired.motion.seconds:.1f} s are changed")
    for status, number in Counter(finding.status for finding in repaired.proposed).items():
        said.append(f"{number} {NOT_DONE[status]}, since {WHY[status]}")
    if not repaired.known:
        said.append("unlike what the model knows: used only smoothing and filters, no prediction")
    if command and repaired.original and (name := fitting_preset(repaired.original)):
        suits = f"which suits motion that {FITS[name]}, as this does"
        said.append(f"not done yet: {PRESETS[name]}, {suits}; to do it: {command} --from {name}")
    return said


def filled(repaired: Repaired) -> str:
    """What `fill` filled in, such as "filled: left wrist, frames 30 to 75"."""
    lines = repr(repaired).replace("_", " ").splitlines()
    first = [line.partition(": moved")[0].replace(": ", ", ") for line in lines[:MOST_PRINTED]]
    return f"filled: {'; '.join(first)}{' and more' if len(lines) > MOST_PRINTED else ''}"


def measures(before: Motion, after: Motion) -> Measures:
    """Measures of damage, each of the motion before and after."""
    finite = with_finite_values(before)[0]
    named = {"frames with a jump": _jumps, "feet slide, cm/s": sliding, "jitter, m/s²": shaking}
    return [(name, measure(finite), measure(after)) for name, measure in named.items()]


def _jumps(motion: Motion) -> float:
    return float(np.count_nonzero((jump_levels(motion) == SHARP).any(axis=1)))
