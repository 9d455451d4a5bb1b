"""The poses of an armature, as Blender has them, become a `Motion`, and a motion poses.

A bone b of an armature has a rest matrix M_b, which takes its own axes to those of the world. Its
pose is a rotation B_b and a location l_b in its own axes, so that in the world it is at

    P_b = P_p M_p⁻¹ M_b (B_b, l_b)

where p is its parent. A joint of a `Motion` is not rotated in the rest pose: its rotation in the
world is P_b M_b⁻¹. Relative to its parent the rotation R_b and the translation t_b are therefore

    R_b = M_b B_b M_b⁻¹        t_b = o_b + M_b l_b

with the rotation and the scale of M_b, and o_b from the parent's head to that of the bone in the
rest pose. The object that has the armature may move by itself: D, which takes its first place to
that of a frame, is applied to the root.

The world of an armature has Z up, that of a motion Y. Its unit and its floor are found as those of
a file.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.mocap.coordinates import turn_as_in_file, turn_y_up
from numpy_cae.mocap.rigs.recognise import recognise_rig
from numpy_cae.mocap.rigs.rigs import RiggedMotion
from numpy_cae.mocap.units import guess_unit_from_limbs
from numpy_cae.motion import Motion, Note, Skeleton
from numpy_cae.motion.filters import LEAST_RATE
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import depth_first
from numpy_cae.motion.quaternions import (
    continuous_angles,
    from_angles,
    from_vector,
    inverse,
    nearest,
    product,
    rotate,
    to_angles,
    to_vector,
)

Z_UP_TO_Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Takes the world of an armature to that of a motion."""
LEAST_DIFFERENCE = 1e-3
"""Scales that differ by less than this share are equal, and so are times that differ by less than
this part of a frame: both are rounded to float32 in files."""


@dataclass(frozen=True, eq=False)
class Armature:
    """Bones in their rest pose, parents before children; the first has no parent.

    Parameters
    ----------
    names : tuple of J str
    parents : tuple of J int
        The index of each bone's parent, -1 for the first.
    rest : (J, 4, 4) array of float64
        M_b: the matrix of each bone in the rest pose, in the world with Z up, the object at its
        place in the first frame.
    tails : (J, 3) array of float64
        Where each bone ends in the rest pose, in the world.

    Raises
    ------
    ValueError
        If a bone has other scales than the first, or is mirrored.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    rest: np.ndarray
    tails: np.ndarray

    def __post_init__(self) -> None:
        scale = self.scale
        for name, matrix in zip(self.names, self.rest[:, :3, :3], strict=True):
            squares = matrix.T @ matrix / scale**2
            if np.abs(squares - np.eye(3)).max() > LEAST_DIFFERENCE or np.linalg.det(matrix) < 0:
                problem = f"bone {name!r} is scaled differently along its axes, or mirrored"
                raise ValueError(f"{problem}; apply the scale of the armature (Ctrl A)")

    @property
    def scale(self) -> float:
        """Units of the world in one unit of the armature."""
        return float(np.linalg.norm(self.rest[0, :3, 0]))

    @property
    def heads(self) -> np.ndarray:
        """Where each bone begins in the rest pose, (J, 3)."""
        return np.asarray(self.rest[:, :3, 3])


@dataclass(frozen=True, eq=False)
class Poses:
    """The poses of an armature, frame by frame.

    Parameters
    ----------
    rotations : (F, J, 4) array of float64
        B_b as unit quaternions (x, y, z, w).
    locations : (F, J, 3) array of float64
        l_b, in units of the armature.
    places : (F, 4, 4) array of float64
        D: takes the place of the object in the first frame to that in each, in the world.
    """

    rotations: np.ndarray
    locations: np.ndarray
    places: np.ndarray


def order_bones(parents: dict[str, str | None]) -> list[str]:
    """The bones of the largest tree of an armature, parents before children.

    Controls and helpers often hang on no bone, or on a few of their own: these are left out.

    Parameters
    ----------
    parents : dict of str to str or None
        For each bone the name of its parent.

    Examples
    --------
    >>> order_bones({"IK": None, "hips": None, "leg": "hips", "spine": "hips", "foot": "leg"})
    ['hips', 'leg', 'foot', 'spine']
    """
    children: dict[str, list[str]] = {}
    roots = []
    for name, parent in parents.items():
        if parent is None:
            roots.append(name)
        else:
            children.setdefault(parent, []).append(name)
    trees = [depth_first(root, children) for root in roots]
    return max(trees, key=len, default=[])


def to_motion(armature: Armature, poses: Poses, rate: float) -> RiggedMotion:
    """The motion of an armature, in metres with Y up, with its rig, as a file of it would be read.

    Parameters
    ----------
    armature : Armature
    poses : Poses
    rate : float
        Frames a second.

    Returns
    -------
    RiggedMotion
        Also if the rig is not recognised: `rig_of` refuses such a motion. `Motion.notes` say
        what was found.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import rig_of
    >>> walk = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> armature = armature_of_skeleton(walk.skeleton)
    >>> motion = to_motion(armature, to_poses(armature, walk), 30.0)
    >>> rig_of(motion).name, round(float(np.abs(motion.positions() - walk.positions()).max()), 6)
    ('CMU Acclaim', 0.0)
    """
    axes = nearest(Z_UP_TO_Y_UP @ armature.rest[:, :3, :3] / armature.scale)
    rotations = product(product(axes, poses.rotations), inverse(axes))
    offsets, tips = _offsets_and_tips(armature)
    translations = offsets + rotate(axes, armature.scale * poses.locations)
    turns, moves = _places_y_up(poses.places)
    rotations[:, 0] = product(turns, rotations[:, 0])
    translations[:, 0] = rotate(turns, translations[:, 0]) + moves
    skeleton = Skeleton(armature.names, armature.parents, offsets, tips)
    unit = (Note("unit", "metres"),)
    motion = recognise_rig(Motion(skeleton, rate, rotations, translations, notes=unit))
    return turn_y_up(guess_unit_from_limbs(motion))


def to_poses(armature: Armature, motion: Motion, places: np.ndarray | None = None) -> Poses:
    """The poses with which an armature moves as a motion: the inverse of `to_motion`.

    Parameters
    ----------
    armature : Armature
    motion : Motion
        As `to_motion` made it from this armature, with other rotations and translations.
    places : (F, 4, 4) array of float64, optional
        `Poses.places`; the object does not move where None.

    Returns
    -------
    Poses
    """
    if places is None:
        places = np.tile(np.eye(4), (len(motion), 1, 1))
    motion = turn_as_in_file(motion)
    axes = nearest(Z_UP_TO_Y_UP @ armature.rest[:, :3, :3] / armature.scale)
    offsets, _ = _offsets_and_tips(armature)
    rotations = motion.rotations.copy()
    translations = motion.translations / motion.unit
    turns, moves = _places_y_up(places)
    rotations[:, 0] = product(inverse(turns), rotations[:, 0])
    translations[:, 0] = rotate(inverse(turns), translations[:, 0] - moves)
    return Poses(
        rotations=product(product(inverse(axes), rotations), axes),
        locations=rotate(inverse(axes), translations - offsets) / armature.scale,
        places=places,
    )


def armature_of_skeleton(skeleton: Skeleton) -> Armature:
    """An armature, Z up, whose bones have the places of a skeleton's joints and the world's axes.

    Examples
    --------
    >>> leg = Skeleton(("hip", "knee"), (-1, 0), np.array([[0.0, 0.9, 0.0], [0.0, -0.4, 0.0]]))
    >>> armature_of_skeleton(leg).heads
    array([[0. , 0. , 0.9],
           [0. , 0. , 0.5]])
    """
    heads = skeleton.rest_positions()
    tails = heads.copy()
    for joint, tip in skeleton.end_sites.items():
        tails[joint] += tip
    rest = np.tile(np.eye(4), (len(heads), 1, 1))
    rest[:, :3, 3] = heads @ Z_UP_TO_Y_UP
    return Armature(skeleton.names, skeleton.parents, rest, tails @ Z_UP_TO_Y_UP)


def _offsets_and_tips(armature: Armature) -> tuple[np.ndarray, dict[int, np.ndarray]]:
    """The offsets (J, 3) of the joints of a skeleton, and its End Sites, Y up."""
    heads = armature.heads @ Z_UP_TO_Y_UP.T
    tails = armature.tails @ Z_UP_TO_Y_UP.T
    offsets = heads.copy()
    for bone, parent in enumerate(armature.parents):
        if parent >= 0:
            offsets[bone] -= heads[parent]
    ends = set(range(len(heads))) - set(armature.parents)
    return offsets, {bone: tails[bone] - heads[bone] for bone in ends}


def _places_y_up(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rotations (F, 4) and translations (F, 3) of places of an object, Y up; ValueError if it
    changes its size."""
    matrices = places[:, :3, :3]
    if np.abs(matrices.swapaxes(1, 2) @ matrices - np.eye(3)).max(initial=0) > LEAST_DIFFERENCE:
        raise ValueError("the armature changes its size; remove the keys of its scale")
    turns = nearest(Z_UP_TO_Y_UP @ matrices @ Z_UP_TO_Y_UP.T)
    return turns, places[:, :3, 3] @ Z_UP_TO_Y_UP.T


QUATERNION = "QUATERNION"
AXIS_ANGLE = "AXIS_ANGLE"


def read_rotations(mode: str, channels: np.ndarray) -> np.ndarray:
    """Unit quaternions (F, 4) (x, y, z, w) of the rotation channels of a bone.

    Parameters
    ----------
    mode : str
        Blender's rotation mode: "QUATERNION", "AXIS_ANGLE" or the order of Euler angles, such as
        "XYZ": X first, about fixed axes.
    channels : (F, 4) or (F, 3) array of float64
        w, x, y, z; or an angle and an axis; or the angles about X, Y and Z. Angles are in radians.

    Examples
    --------
    >>> half = np.sqrt(0.5)
    >>> read_rotations("QUATERNION", np.array([[2.0, 2.0, 0.0, 0.0]])).round(2)
    array([[0.71, 0.  , 0.  , 0.71]])
    """
    if mode == QUATERNION:
        norms = np.linalg.norm(channels, axis=1, keepdims=True)
        unit = np.where(norms > 0, channels / np.where(norms > 0, norms, 1.0), [1.0, 0.0, 0.0, 0.0])
        return unit[:, [1, 2, 3, 0]]
    if mode == AXIS_ANGLE:
        norms = np.linalg.norm(channels[:, 1:], axis=1, keepdims=True)
        axis = np.where(norms > 0, channels[:, 1:] / np.where(norms > 0, norms, 1.0), 0.0)
        return from_vector(channels[:, :1] * axis)
    return from_angles(mode.lower(), channels[:, ["XYZ".index(axis) for axis in mode]])


def write_rotations(mode: str, rotations: np.ndarray, before: np.ndarray) -> np.ndarray:
    """The rotation channels of a bone for unit quaternions (F, 4): the inverse of
    `read_rotations`, without avoidable jumps from the channels `before` (4 or 3,) of the frame
    before, and from frame to frame."""
    if mode == QUATERNION:
        channels = rotations[:, [3, 0, 1, 2]]
        previous = np.vstack([before, channels[:-1]])
        flips = np.cumsum(np.sum(previous * channels, axis=1) < 0) % 2 == 1
        return np.where(flips[:, None], -channels, channels)
    if mode == AXIS_ANGLE:
        vectors = to_vector(rotations)
        angles = np.linalg.norm(vectors, axis=1, keepdims=True)
        axis = np.where(angles > 0, vectors / np.where(angles > 0, angles, 1.0), before[1:])
        return np.hstack([angles, axis])
    columns = ["XYZ".index(axis) for axis in mode]
    angles = to_angles(mode[::-1], rotations)[:, ::-1]  # about own axes in reverse order
    channels = np.empty_like(angles)
    channels[:, columns] = continuous_angles(angles, before[columns])
    return channels


def choose_times(keys: Sequence[float], rate: float) -> np.ndarray:
    """The times, in frames of a scene, at which an action is read, from those of its keys.

    Where the keys are evenly spaced, as recorded motion is, the times are those of the keys;
    otherwise every frame from the first key to the last. Keys at fewer than `LEAST_RATE` a second
    are poses to be interpolated, and no recording.

    Parameters
    ----------
    keys : sequence of float
        The times of all keys of the bones, in frames, in any order.
    rate : float
        Frames a second of the scene.

    Examples
    --------
    >>> choose_times([1, 3, 5, 5], 30.0)
    array([1., 3., 5.])
    >>> choose_times([1, 2, 5], 30.0)
    array([1., 2., 3., 4., 5.])
    """
    times = np.unique(np.round(np.asarray(keys, dtype=np.float64), 4))
    if len(times) < 2:
        return times
    times = times[np.concatenate([[True], np.diff(times) > LEAST_DIFFERENCE])]
    first = float(times[0])
    step = float(times[-1] - first) / (len(times) - 1)
    grid = first + step * np.arange(len(times))
    if np.abs(times - grid).max() <= 2 * LEAST_DIFFERENCE and rate / step >= LEAST_RATE:
        return times
    return np.arange(np.floor(first), np.ceil(times[-1]) + 1)


def choose_keys(keys: np.ndarray, times: np.ndarray, changed: np.ndarray) -> np.ndarray:
    """Where a curve gets keys so that it changes in some frames and nowhere else, (F,) bool.

    Beside a run of changed frames a curve would bend from its last key before the run to the first
    in it. So the frames between the two are keyed with their values; beyond the first and the last
    key, where a curve is level, one frame is enough.

    Parameters
    ----------
    keys : (K,) array of float64
        The times of the curve's keys, ascending.
    times : (F,) array of float64
        The times of the frames, ascending.
    changed : (F,) array of bool

    Examples
    --------
    >>> frames = np.arange(8.0)
    >>> changed = np.isin(frames, [4])
    >>> np.flatnonzero(choose_keys(np.array([1.0, 7.0]), frames, changed))
    array([2, 3, 4, 5, 6])
    >>> np.flatnonzero(choose_keys(np.array([]), frames, changed))
    array([3, 4, 5])
    """
    chosen = np.array(changed)
    for first, end in runs(changed):
        before = keys[keys < times[first] - LEAST_DIFFERENCE]
        after = keys[keys > times[end - 1] + LEAST_DIFFERENCE]
        is_between = np.zeros(len(times), bool)
        is_between[max(first - 1, 0) : end + 1] = True
        if len(before):
            is_between[:first] = times[:first] > before[-1] + LEAST_DIFFERENCE
        if len(after):
            is_between[end:] = times[end:] < after[0] - LEAST_DIFFERENCE
        chosen |= is_between
    return chosen


def find_frames(keys: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The frame at which each key of a curve is, (K,) int; -1 for a key that is between two.

    Parameters
    ----------
    keys : (K,) array of float64
        The times of the keys.
    times : (F,) array of float64
        The times of the frames, ascending.

    Examples
    --------
    >>> find_frames(np.array([2.0, 2.4, 3.0001]), np.array([1.0, 2.0, 3.0]))
    array([ 1, -1,  2])
    """
    after = np.searchsorted(times, keys).clip(1, len(times) - 1)
    is_nearer = keys - times[after - 1] < times[after] - keys
    frames = np.where(is_nearer, after - 1, after)
    return np.where(np.abs(times[frames] - keys) <= LEAST_DIFFERENCE, frames, -1)


def find_changes(before: Motion, after: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Where two motions of a rig have other rotations, and other translations, (frames, J) bool."""
    rotations = np.any(before.rotations != after.rotations, axis=-1)
    translations = np.any(before.translations != after.translations, axis=-1)
    return rotations, translations
