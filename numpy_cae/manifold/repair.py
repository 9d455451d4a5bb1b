"""Repair of a motion (holden2015, section 7, "Fixing Corrupt Motion Data").

The paper projects the whole motion (`project_motion`), which also changes what was right. `repair`
changes only what is damaged, and `fill_motion` only what the user says is missing. A motion is
taken to thirty frames a second once, (F, …), and the repaired joints are taken back to the frames
of the file once, (frames, …).
"""

from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.manifold.detect import find_damage, residual
from numpy_cae.manifold.fill import checked_mask, corrected
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.smooth import smooth_motion
from numpy_cae.motion.features import features_to_positions, positions_to_features
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import change_lengths
from numpy_cae.motion.masks import at_thirty, runs
from numpy_cae.motion.motion import RATE, Motion, blocks
from numpy_cae.motion.retarget.body import Body, at_rate_of
from numpy_cae.motion.retarget.curves import on_curves, over_holes, rotations_over_holes
from numpy_cae.motion.retarget.rigs import find_joints
from numpy_cae.motion.retarget.to_rig import retarget

UNKNOWN = 0.12
"""UNKNOWN: a motion is unlike what the manifold knows if its residual exceeds this (m), which is
more than that of any take of a source left out of training (docs/lab_book/detection.md)."""
MOST_RUNS = 5
"""MOST_RUNS: at most this many runs of frames are printed with their frame numbers."""


@dataclass(frozen=True, repr=False)
class Repaired:
    """A motion after a repair, and what was changed: its repr lists joints, frames and centimetres.

    Parameters
    ----------
    motion : Motion
        With the skeleton, rate, unit and length of the original motion.
    touched : (frames, 20) array of bool
        The joints that were repaired, in the frames of the file.
    moved : (frames, 20) array of float64
        How far each joint moved, metres.
    residual : float
        Median distance of a joint from its projection, metres; 0 where it was not measured.
    known : bool
        Whether the motion is like what the manifold was learned from.

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

    def __repr__(self) -> str:
        """A line for joints that were changed in the same frames: names, frames, centimetres."""
        if not self.known:
            return (
                f"unlike what the model knows: joints are typically {100 * self.residual:.1f} cm "
                "from their projection; left unchanged (--force repairs it nevertheless)"
            )
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
        return "\n".join(lines) or "nothing to repair was found"


def _frames_of(mask: np.ndarray) -> str:
    """The runs of a mask (frames,), such as "frames 30 to 45, 102"."""
    ends = runs(mask)
    texts = [f"{a} to {b - 1}" if b - a > 1 else f"{a}" for a, b in ends[:MOST_RUNS]]
    more = f" and {len(ends) - MOST_RUNS} more" if len(ends) > MOST_RUNS else ""
    return f"frame{'' if mask.sum() == 1 else 's'} {', '.join(texts)}{more}"


def repair(
    motion: Motion,
    manifold: MotionManifold,
    damaged: np.ndarray | None = None,
    strength: float = 1.0,
    smooth: bool = False,
    force: bool = False,
) -> Repaired:
    """Find what is damaged in a motion and fill it in; the rest of the motion is unchanged.

    Parameters
    ----------
    motion : Motion
        A motion at any rate, on any rig in which the twenty joints can be found.
    manifold : MotionManifold
    damaged : (frames, 20) array of bool, optional
        In the frames of the file; found by `find_damage` where None.
    strength : float
        0 keeps the damaged positions, 1 uses the repaired ones.
    smooth : bool
        Whether to remove jitter from the whole motion, by `smooth_motion`.
    force : bool
        Whether to repair a motion that is unlike what the manifold knows; otherwise it is returned
        unchanged, with `known` False.

    Returns
    -------
    Repaired

    Raises
    ------
    UnknownRigError, ValueError
        If joints of the rig are missing; if `strength` is not from 0 to 1.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import repair, starter
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[30:33, motion.skeleton.index("lwrist")] += 0.5
    >>> repair(motion, starter())
    left_wrist: frames 30 to 32: moved 86.6 cm, at most 86.6
    """
    if not 0 <= strength <= 1:
        raise ValueError(f"strength is {strength}, expected 0 to 1")
    motion, not_finite = _finite(motion)
    manifold = manifold.remembering()
    body = manifold.body(motion)
    if damaged is None:
        damaged = find_damage(manifold, body)
    holes = Holes(body, damaged | not_finite[:, find_joints(motion.skeleton)])
    distance = holes.typical_residual(manifold)
    if distance > UNKNOWN and not force:
        nothing = np.zeros(holes.in_file.shape)
        return Repaired(motion, nothing > 0, nothing, distance, known=False)
    features = corrected(manifold, holes.features, holes.mask)
    repaired = replace(holes.filled(features, motion, strength), residual=distance)
    if smooth:
        smoothed = smooth_motion(repaired.motion)
        moved = distances(motion, smoothed)
        # Every joint that moves counts as touched.
        repaired = replace(repaired, motion=smoothed, touched=moved > 0, moved=moved)
    return repaired


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
        If joints of the rig are missing; if the mask has another shape.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import fill_motion, keyframe_mask, starter
    >>> motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> fill_motion(motion, starter(), keyframe_mask(30, 10))
    all joints: frames 1 to 9, 11 to 19: moved 4.1 cm, at most 27.8
    """
    missing = checked_mask(missing, len(motion))
    holes = Holes(manifold.body(motion), missing)
    return holes.filled(corrected(manifold, holes.features, holes.mask))


class Holes:
    """A motion in which some joints are damaged or missing in some frames.

    Parameters
    ----------
    body : Body
        The body of the motion.
    in_file : (frames, 20) array of bool
        What is damaged or missing, in the frames of the file.

    Attributes
    ----------
    mask : (F, 20) array of bool
        What is damaged or missing at thirty frames a second.
    start : Motion
        The frames that have holes, with the rotations of the rig interpolated over these
        (`on_curves`). All frames of an hour would take half a gigabyte more.
    features, root : (F, 63) array of float64, RootTransform
        Of the motion with the joints of the holes where they are in `start`: the X_0 of `fill`.
    """

    def __init__(self, body: Body, in_file: np.ndarray):
        self.body, self.in_file = body, in_file
        self.mask = at_thirty(body.motion, in_file)
        start = replace(body, motion=on_curves(body.motion, in_file))
        self.start = start.motion.at(np.asarray(in_file.any(axis=1)))
        self.lengths = start.lengths
        positions = np.where(self.mask[..., None], start.positions, body.positions)
        positions = change_lengths(positions, self.lengths, body.mean_lengths)
        self.features, self.root = positions_to_features(positions, RATE)

    def positions_of(self, features: np.ndarray) -> np.ndarray:
        """World positions of features (F, 63) on the motion's own bones, (F, 20, 3) in metres."""
        on_mean_bones = features_to_positions(features, self.root)
        return change_lengths(on_mean_bones, self.body.mean_lengths, self.lengths)

    def typical_residual(self, manifold: MotionManifold) -> float:
        """The median distance of a joint outside the holes from its projection, metres."""
        if self.mask.all():
            return 0.0
        distance = np.linalg.norm(residual(manifold, self.features, self.mask), axis=-1)
        return float(np.median(distance[~self.mask]))

    def filled(
        self, features: np.ndarray, original: Motion | None = None, strength: float = 1.0
    ) -> Repaired:
        """The motion with the joints of the holes, and nothing else, moved to those of features.

        Parameters
        ----------
        features : (F, 63) array of float
            On the mean skeleton; used only in the holes.
        original : Motion, optional
            What `Repaired.moved` is measured from; the body's motion where None.
        strength : float
            Share of the way to the features, 0 to 1.
        """
        body, holes = self.body, self.in_file
        original = body.motion if original is None else original
        if not holes.any():
            return Repaired(original, holes, np.zeros(holes.shape))
        after, before = map(self.positions_of, (features, self.features))
        correction = np.where(self.mask[..., None], after - before, 0.0)
        weight = _ramps(holes, body.motion.rate)
        joints, changed = find_joints(original.skeleton), np.asarray(holes.any(axis=1))
        row = np.cumsum(changed) - 1  # of a frame in `start`

        def targets(frames: np.ndarray) -> np.ndarray:
            before = body.motion.at(frames).positions(joints)
            after = self.start.at(row[frames]).positions(joints)
            moved = at_rate_of(body.motion, correction, frames) * weight[frames, :, None]
            return before + strength * (after + moved - before)

        motion = retarget(body.motion, targets, holes, self.start)
        return Repaired(motion, holes, distances(original, motion, changed))


def _ramps(holes: np.ndarray, rate: float) -> np.ndarray:
    """A weight for each frame of a mask (frames, 20): 0 outside the holes, and within them it rises
    smoothly to 1 in 1/30 s from each end. A correction at thirty frames a second, resampled, is not
    exactly zero next to a hole; with this weight neither place nor speed jumps."""
    frame = np.arange(len(holes), dtype=np.float32)[:, None]
    before = np.maximum.accumulate(np.where(holes, -np.inf, frame), axis=0)
    after = np.minimum.accumulate(np.where(holes, np.inf, frame)[::-1], axis=0)[::-1]
    u = np.minimum(np.minimum(frame - before, after - frame) * (RATE / rate), 1.0)
    return u * u * (3 - 2 * u)


def distances(before: Motion, after: Motion, changed: np.ndarray | None = None) -> np.ndarray:
    """How far each of the twenty joints moved, (frames, 20) in metres.

    With a mask `changed` (frames,) only its frames are compared.
    """
    joints = find_joints(after.skeleton)
    moved = np.zeros((len(after), len(joints)))
    for frames in blocks(np.arange(len(after)) if changed is None else np.flatnonzero(changed)):
        change = after.at(frames).positions(joints) - before.at(frames).positions(joints)
        moved[frames] = np.linalg.norm(change, axis=-1)
    return moved


def _finite(motion: Motion) -> tuple[Motion, np.ndarray]:
    """The motion with rotations and translations that are not finite interpolated, and a mask
    (frames, J) of the rig's joints that depend on such values."""
    wrong = ~(np.isfinite(motion.rotations).all(-1) & np.isfinite(motion.translations).all(-1))
    if not wrong.any():
        return motion, wrong
    rotations = np.where(wrong[..., None], [0.0, 0.0, 0.0, 1.0], motion.rotations)
    translations = np.where(wrong[..., None], motion.skeleton.offsets, motion.translations)
    finite = replace(
        motion,
        rotations=rotations_over_holes(rotations, wrong, motion.rate),
        translations=over_holes(translations, wrong, motion.rate),
    )
    for child, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            wrong[:, child] |= wrong[:, parent]
    return finite, wrong
