"""The result of a repair, and the change of a motion in some joints and frames."""

from dataclasses import dataclass

import numpy as np

from numpy_cae.manifold.holes import spline
from numpy_cae.motion.motion import Motion, blocks
from numpy_cae.motion.retarget.body import Body
from numpy_cae.motion.retarget.rigs import find_joints


@dataclass(frozen=True)
class Repaired:
    """A motion after a repair, and what was changed.

    Parameters
    ----------
    motion : Motion
        Of the skeleton, rate, unit and length of the file's.
    touched : (frames, 20) array of bool
        The joints that were repaired, in the frames of the file.
    moved : (frames, 20) array of float64
        How far each joint moved, metres.
    residual : float
        Median distance of a joint from its projection, metres; 0 where it was not measured.
    known : bool
        Whether the motion is like what the manifold was learned from.
    """

    motion: Motion
    touched: np.ndarray
    moved: np.ndarray
    residual: float = 0.0
    known: bool = True


def change_joints(
    body: Body,
    original: Motion,
    target: np.ndarray,
    touched: np.ndarray,
    strength: float = 1.0,
    residual: float = 0.0,
) -> Repaired:
    """Move the joints of a mask to target positions, and nothing else.

    Parameters
    ----------
    body : Body
        Of the motion to change.
    original : Motion
        What `moved` is measured from.
    target : (F, 20, 3) array of float
        World positions at 30 frames a second, metres.
    touched : (frames, 20) array of bool
        In the frames of the file.
    strength : float
        Share of the way to the target, 0 to 1.
    residual : float
        Of `Repaired`.
    """
    if not touched.any():
        return Repaired(original, touched, np.zeros(touched.shape), residual)
    own = body.positions_in_file
    positions = body.in_file_frames(target)
    for joint in np.flatnonzero(touched.any(axis=0)):
        # The resampled curve misses known frames by a little: no jump where it meets them.
        column = [joint]
        if not touched[:, joint].all():
            miss = own[:, column] - positions[:, column]
            positions[:, column] += spline(miss, touched[:, column])
        positions[:, joint] = own[:, joint] + strength * (positions[:, joint] - own[:, joint])
    motion = body.retarget(positions, touched)
    moved = distances(original, motion, np.asarray(touched.any(axis=1)))
    return Repaired(motion, touched, moved, residual)


def distances(before: Motion, after: Motion, changed: np.ndarray | None = None) -> np.ndarray:
    """How far each of the twenty joints moved, (frames, 20) in metres. With a mask `changed`
    (frames) only its frames are compared. If `after` is shorter, it is the end of `before`."""
    joints = find_joints(after.skeleton)
    before = before.at(slice(len(before) - len(after), None))
    moved = np.zeros((len(after), len(joints)))
    for frames in blocks(np.arange(len(after)) if changed is None else np.flatnonzero(changed)):
        change = after.at(frames).positions(joints) - before.at(frames).positions(joints)
        moved[frames] = np.linalg.norm(change, axis=-1)
    return moved
