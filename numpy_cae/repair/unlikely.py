"""Joints that are far from the manifold.

The distance alone accuses nobody: a pose that the manifold has not learned is far from it too. It
counts together with jumps of the joint at both ends; without these it is proposed. Arrays of shape
(F, …) are at thirty frames a second, arrays of shape (frames, …) in the frames of the file.
"""

import numpy as np

from numpy_cae.manifold.fill import fill
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retarget.body import Body
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion.features import local_positions
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.masks import at_thirty, in_file, runs, runs_with
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.curves import curves_of
from numpy_cae.repair.finding import Finding
from numpy_cae.repair.segments import jumps_of

FAR_METRES, FAR_RATIO = 0.1, 4.0
"""FAR_METRES, FAR_RATIO: a joint is far where its distance from the manifold exceeds FAR_METRES (m)
and FAR_RATIO times the median of this distance in the clip. The stretch extends to the frames
around that exceed half of it."""
NEAR_SECONDS = 0.1
"""NEAR_SECONDS: a jump is at an end of a stretch if it is nearer than this (s)."""
CONFIDENCES = (0.05, 0.2, 0.6)
"""CONFIDENCES: a stretch has one of these confidences, with jumps at none, at one and at both of
its ends."""


def find_unlikely(
    manifold: MotionManifold, body: Body, damaged: np.ndarray | None = None
) -> list[Finding]:
    """The joints of a motion that are far from their projections.

    Parameters
    ----------
    manifold : MotionManifold
    body : Body
        The body of the motion, as `manifold.body` returns it.
    damaged : (frames, 20) array of bool, optional
        Joints that are known to be damaged, in the frames of the file; they are filled in.

    Returns
    -------
    list of Finding
        Of kind "unlikely", proposed; their confidence is one of `CONFIDENCES`.

    Examples
    --------
    An arm that leaves its place without a jump, and comes back:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> from numpy_cae.repair import find_unlikely
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> away = 0.4 * np.hanning(20)[:, None]
    >>> motion.translations[20:40, motion.skeleton.index("lwrist")] += away
    >>> found = find_unlikely(starter(), Body(motion, starter().lengths))
    >>> sorted({finding.joint for finding in found}), found[0].confidence
    (['left_elbow', 'left_wrist'], 0.05)
    """
    motion = body.motion
    known = np.zeros((len(motion), len(JOINTS)), bool) if damaged is None else damaged
    known = at_thirty(motion, known)
    difference = residual(manifold, body.features, known)
    # Rigs place joints differently: a constant distance in the whole clip is no damage.
    distance = np.linalg.norm(difference - typical(difference, known), axis=-1)
    level = distance / np.maximum(FAR_METRES, FAR_RATIO * typical(distance, known))
    stretches = in_file(motion, runs_with((level > 0.5) & ~known, level > 1))
    jumps = _jumps(motion) if stretches.any() else stretches
    near = round(NEAR_SECONDS * motion.rate)
    found = []
    for joint in np.flatnonzero(stretches.any(axis=0)):
        for ends in runs(stretches[:, joint]).tolist():
            jumping = sum(int(jumps[max(at - near, 0) : at + near, joint].any()) for at in ends)
            where = ("at neither end", "at one end", "at both ends")[jumping]
            why = f"far from what the model knows; jumps {where}"
            frames = ends[0], ends[1] - 1
            sure = CONFIDENCES[jumping]
            found.append(Finding(JOINTS[joint], frames, "unlikely", why, 0.0, sure, "proposed"))
    return found


def _jumps(motion: Motion) -> np.ndarray:
    """The frames after which a rotation or place on the way to each of the twenty joints jumps,
    (frames, 20) of bool."""
    jumps = np.zeros((len(motion), len(JOINTS)), bool)
    paths = [motion.skeleton.path(joint) for joint in rig_of(motion).joints]
    for curve in curves_of(motion):
        for frame, _ in jumps_of(curve):
            jumps[frame - 1] |= [curve.joint in path for path in paths]
    return jumps


def residual(manifold: MotionManifold, features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The difference of each joint from its projection, (F, 20, 3) in metres.

    The motion (F, 63) is projected after the joints of the mask `missing` (F, 20) are filled in.
    """
    filled = fill(manifold, features, missing)
    return local_positions(features - manifold.project(filled, average_shifts=True))


def typical(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The median over time of each joint's values (F, 20, …), without the missing ones (F, 20)."""
    ignored = missing & ~missing.all(axis=0)
    ignored = ignored.reshape(*ignored.shape, *[1] * (values.ndim - 2))
    return np.nanmedian(np.where(ignored, np.nan, values), axis=0)
