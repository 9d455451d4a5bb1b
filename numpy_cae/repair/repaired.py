"""What a repair changed."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.chunks import chunks
from numpy_cae.repair.finding import Finding, is_path

MOST_PRINTED = 5
"""MOST_PRINTED: at most this many runs of frames, and findings, are printed in full."""


@dataclass(frozen=True, repr=False)
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
            lines.append(
                f"{names}: {frames}: moved {moved.mean():.1f} cm, at most {moved.max():.1f}"
            )
        found = [finding for finding in self.findings if finding.kind != "marked"]
        lines += _listed("found:", found) + _listed("proposed, not changed:", self.proposed)
        if not self.known:
            lines.append(
                f"unlike what the model knows: joints are typically {100 * self.residual:.1f} cm "
                "from their projection, so only what the file itself shows was mended"
            )
        return "\n".join(lines) or "nothing to repair was found"


def _listed(title: str, findings: Sequence[Finding]) -> list[str]:
    """Lines with the findings of the largest centimetres, and the number of the others."""
    some = sorted(findings, key=lambda finding: (-finding.cm, -finding.confidence))[:MOST_PRINTED]
    more = len(findings) - len(some)
    lines = [title, *(f"  {finding}" for finding in some)] if findings else []
    return lines + [f"  and {more} more"] * bool(more)


def _frames_of(mask: np.ndarray) -> str:
    """The runs of a mask (frames,), such as "frames 30 to 45, 102"."""
    ends = runs(mask)
    texts = [f"{a} to {b - 1}" if b - a > 1 else f"{a}" for a, b in ends[:MOST_PRINTED]]
    more = f" and {len(ends) - MOST_PRINTED} more" if len(ends) > MOST_PRINTED else ""
    return f"frame{'' if mask.sum() == 1 else 's'} {', '.join(texts)}{more}"


def distances(before: Motion, after: Motion, from_hips: bool = False) -> np.ndarray:
    """How far each of the twenty joints moved, (frames, 20) in metres: the joint, or the joint of
    the rig that follows it (its fingers, the second bone of the neck) and moved furthest; in the
    world, or from the hips."""
    skeleton, joints = after.skeleton, rig_of(after).joints
    followed = [
        next((joints.index(above) for above in skeleton.path(joint) if above in joints), 0)
        for joint in range(len(skeleton.names))
    ]
    changed = np.any(before.rotations != after.rotations, axis=(1, 2))
    changed |= np.any(before.translations != after.translations, axis=(1, 2))
    moved = np.zeros((len(after), len(joints)))
    for frames, _ in chunks(np.flatnonzero(changed)):
        change = after.at(frames).positions() - before.at(frames).positions()
        change -= from_hips * change[:, joints[:1]]
        distance = np.linalg.norm(change, axis=-1)
        for joint, of in enumerate(followed):
            moved[frames, of] = np.maximum(moved[frames, of], distance[:, joint])
    return moved


def with_centimetres(
    findings: Sequence[Finding], moved: np.ndarray, posed: np.ndarray
) -> list[Finding]:
    """The findings with the largest distance (m) of their joint or one below it, in centimetres: in
    `moved` for a path of the root, in `posed` for others."""
    measured = []
    for finding in findings:
        below = {finding.joint} if finding.joint in JOINTS else set(JOINTS)
        for joint, parent in zip(JOINTS[1:], PARENTS[1:], strict=True):
            if JOINTS[parent] in below:
                below.add(joint)
        there = (moved if is_path(finding) else posed)[finding.stretch]
        cm = 100 * there[:, [JOINTS.index(joint) for joint in below]].max(initial=0.0)
        measured.append(replace(finding, cm=float(cm)))
    return measured
