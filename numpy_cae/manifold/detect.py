"""Detection of damaged joints: by their distance from the manifold, and by direct tests.

Arrays of shape (F, …) are at thirty frames a second, arrays of shape (frames, …) in the frames of
the file.
"""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.manifold.fill import bridged_features, fill, spline
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import POSITIONS
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import frame_lengths
from numpy_cae.motion.masks import at_thirty, in_file, run_lengths, runs, runs_with, with_margin
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.retarget.body import Body
from numpy_cae.motion.retarget.rigs import body_positions, find_joints

RATIO = 4.0
"""RATIO: a joint is damaged where its distance from the manifold exceeds max(RATIO · the median of
this distance in the clip, FAR). The damage extends to the frames around that exceed half of it."""
FAR = 0.1
"""FAR: the least distance from the manifold (m) at which a joint is damaged; see RATIO."""
LEAST = 0.05
"""LEAST: a run of frames counts as damage only if filling it in moves the joint by at least this
(m)."""
SUSPICION = 0.25
"""SUSPICION: RATIO and FAR are multiplied by this between a jump and a jump back."""
MOST_JOINTS = 8
"""MOST_JOINTS: where more joints than this are far from the manifold, the pose is one that the
manifold does not know, and the joints are not damaged."""
ROUNDS = 3
"""ROUNDS: how often the damage found so far is filled in and the rest is tested again."""
MARGIN = 2
"""MARGIN: this many frames on both sides of damage count as damaged too."""
JUMP = 0.05
"""JUMP: a step to the next frame jumps if it differs by more than this (m) from the median of seven
steps."""
JUMP_RATIO = 4.0
"""JUMP_RATIO: this difference must also exceed the running median of seven by this factor."""
OPPOSITE = -0.3
"""OPPOSITE: the cosine of the angle between a jump and the jump back is at most this."""
SPIKE_FRAMES = 3
"""SPIKE_FRAMES: a displacement of at most this many frames of the file, between a jump and the jump
back, is a spike, which is damage whatever the manifold says."""
LONGEST = 150
"""LONGEST: SUSPICION applies to displacements of at most this many frames."""
STRETCHED = 0.15
"""STRETCHED: a bone has a wrong length where it differs from its median by more than this share
and by more than 2 cm."""
STILL = 3e-4
"""STILL: a joint that moves less than this (m) until the next frame stands still."""
STILL_FRAMES = 6
"""STILL_FRAMES: a joint is frozen if it stands still for at least this many frames and then
jumps."""
LEAST_JUMP = 0.03
"""LEAST_JUMP: the least step (m) with which a frozen joint moves again."""
SAME_ROTATION = 1e-6
"""SAME_ROTATION: the file repeats a rotation where the quaternion changes by less than this."""
REPEATED = 1e-6
"""REPEATED: the file repeats a pose where the joints move on average by less than this (m)."""
CAUGHT_UP = 2.5
"""CAUGHT_UP: after repeated frames, a step is a jump if it is longer than this times the median of
the three steps after it."""

_FEET = [JOINTS.index(f"{side}_{end}") for side in ("left", "right") for end in ("ankle", "toe")]
_ENDS = [JOINTS.index(f"{side}_{end}") for side in ("left", "right") for end in ("wrist", "ankle")]


def find_damage(manifold: MotionManifold, body: Body) -> np.ndarray:
    """The damaged joints of a motion.

    A joint is damaged where `direct_damage` or `find_frozen` finds it, or where it is far from its
    projection. Damage also moves the projection of other joints, so the damage found is filled in
    and the rest is tested again, `ROUNDS` times. In the end a run of frames counts only if filling
    it in moves the joint by `LEAST`, except what `direct_damage` finds, which always counts.

    Parameters
    ----------
    manifold : MotionManifold
    body : Body
        The body of the motion, as `manifold.body` returns it.

    Returns
    -------
    (frames, 20) array of bool
        In the frames of the file, as `repair` takes it.

    Examples
    --------
    A wrist that is pulled away by half a metre for a tenth of a second:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import find_damage, starter
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> wrist = motion.skeleton.index("lwrist")
    >>> motion.translations[30:33, wrist] += 0.5
    >>> damaged = find_damage(starter(), starter().body(motion))
    >>> np.flatnonzero(damaged.any(axis=1)), JOINTS[np.flatnonzero(damaged.any(axis=0))[0]]
    (array([30, 31, 32]), 'left_wrist')
    """
    direct_in_file = direct_damage(body)
    direct = at_thirty(body.motion, direct_in_file)
    points = spline(_local(bridged_features(body, direct)[0]), direct)
    steps, jumps = find_jumps(points)
    displaced = between_jumps(steps, jumps, LONGEST)
    direct |= find_frozen(body, spline(body.positions, direct), points)
    damaged = direct.copy()
    features, _ = bridged_features(body, damaged)
    for _ in range(ROUNDS):
        far = _far_from_manifold(manifold, features, damaged, displaced, jumps)
        if not far.any():
            break
        damaged |= with_margin(far, MARGIN)
        features, _ = bridged_features(body, damaged)
    damaged &= direct | displaced | (damaged.sum(axis=1, keepdims=True) <= MOST_JOINTS)
    change = np.linalg.norm(_local(fill(manifold, features, damaged) - body.features), axis=-1)
    return in_file(body.motion, runs_with(damaged, change > LEAST)) | direct_in_file


def _far_from_manifold(
    manifold: MotionManifold,
    features: np.ndarray,
    damaged: np.ndarray,
    displaced: np.ndarray,
    jumps: np.ndarray,
) -> np.ndarray:
    """The joints (F, 20) that are far from the manifold and not in the mask `damaged` yet."""
    difference = residual(manifold, features, damaged)
    # Rigs place joints differently: a constant distance in the whole clip is no damage.
    distance = np.linalg.norm(difference - typical(difference, damaged), axis=-1)
    level = distance / np.maximum(FAR, RATIO * typical(distance, damaged))
    far = runs_with(level > 0.5, level > 1)
    # Without a jump, the pose is one that the model does not know: someone kneels or lies.
    far = runs_with(far, with_margin(jumps, MARGIN))
    far |= runs_with(displaced, level > SUSPICION)
    return far & ~damaged


def residual(manifold: MotionManifold, features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The difference of each joint from its projection, (F, 20, 3) in metres.

    The motion (F, 63) is projected after the joints of the mask `missing` (F, 20) are filled in.
    """
    filled = fill(manifold, features, missing)
    return _local(features - manifold.project(filled, average_shifts=True))


def typical(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The median over time of each joint's values (F, 20, …), without the missing ones (F, 20)."""
    ignored = missing & ~missing.all(axis=0)
    ignored = ignored.reshape(*ignored.shape, *[1] * (values.ndim - 2))
    return np.nanmedian(np.where(ignored, np.nan, values), axis=0)


def direct_damage(body: Body) -> np.ndarray:
    """Damage that shows without a manifold, (frames, 20) of bool: spikes, bones of wrong length and
    repeated poses."""
    positions = body_positions(body.motion)
    spikes = between_jumps(*find_jumps(positions - positions[:, :1]), SPIKE_FRAMES)
    return spikes | find_stretched(positions) | find_repeated(positions)[:, None]


def between_jumps(steps: np.ndarray, jumps: np.ndarray, longest: int) -> np.ndarray:
    """Joints displaced between a jump and a jump back, (F, 20) of bool.

    The two jumps have opposite directions, their lengths differ by less than a factor of two, and
    at most `longest` frames are between them. `steps` and `jumps` are those of `find_jumps`.
    """
    displaced = np.zeros(jumps.shape, bool)
    for joint in np.flatnonzero(jumps.sum(axis=0) > 1):
        jump, step = steps[:, joint], np.linalg.norm(steps[:, joint], axis=-1)
        away = None
        for back in np.flatnonzero(jumps[:, joint]):
            if away is not None and back - away <= longest:
                one, other = jump[away], jump[back]
                sizes = step[away], step[back]
                if one @ other < OPPOSITE * sizes[0] * sizes[1] and max(sizes) < 2 * min(sizes):
                    displaced[away + 1 : back + 1, joint] = True
                    away = None
                    continue
            away = back
    return displaced


def find_jumps(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Steps of points (F, 20, 3) to the next frame minus their running median of seven frames, in
    the same shape, and a mask (F, 20) of the steps that are jumps; see `JUMP`."""
    differences, jumps = np.zeros(points.shape), np.zeros(points.shape[:2], bool)
    for joint in range(points.shape[1]):
        step = _steps(points[:, joint])[:-1]
        differences[:-1, joint] = step - median_of_seven(step)
        size = np.linalg.norm(differences[:-1, joint], axis=-1)
        usual = median_of_seven(size[:, None])[:, 0]
        jumps[:-1, joint] = (size > JUMP) & (size > JUMP_RATIO * usual)
    return differences, jumps


def median_of_seven(values: np.ndarray) -> np.ndarray:
    """The running median of values (F, N) over seven frames; the first and last are repeated."""
    if not len(values):
        return values
    padded = np.pad(values, ((3, 3), (0, 0)), mode="edge")
    return np.sort(sliding_window_view(padded, 7, axis=0), axis=-1)[..., 3]


def find_repeated(positions: np.ndarray) -> np.ndarray:
    """Frames of positions (F, 20, 3) that repeat the previous pose until a jump, (F,) of bool.

    Dropped frames and repeated keyframes look like this. A person who stands still is never
    exactly still.
    """
    # One joint at a time: with all at once an hour at 120 Hz would take half a gigabyte more.
    joints = range(positions.shape[1])
    steps = [np.linalg.norm(_steps(positions[:, joint]), axis=-1) for joint in joints]
    step = np.stack(steps, axis=1).mean(axis=1)
    return _until_a_jump(step < REPEATED, step, 0.0)


def find_frozen(body: Body, positions: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Joints that stand still until they jump, (F, 20) of bool.

    A joint stands still if one of these does not change:

    - its position in the body's coordinates
    - its position in the world (not tested for feet, which stand)
    - its distance from the shoulder or the hip (wrists and ankles only)
    - the rotation in the file that moves it

    Hands that rest stand still too, but do not jump when they move again.

    `positions` and `local` (F, 20, 3) are in the coordinates of the world and of the body, without
    spikes.
    """
    distances = np.linalg.norm(positions[:, _ENDS] - positions[:, np.subtract(_ENDS, 2)], axis=-1)
    bends = np.full(positions.shape[:2], np.inf)
    bends[:, _ENDS] = np.abs(_steps(distances))
    in_world, in_body = (np.linalg.norm(_steps(points), axis=-1) for points in (positions, local))
    in_world[:, _FEET] = np.inf
    frozen = np.zeros(in_body.shape, bool)
    for speed in (in_world, in_body, bends, _turns(body)):
        rests = run_lengths(speed < STILL) >= STILL_FRAMES
        for joint in np.flatnonzero(rests.any(axis=0)):
            frozen[:, joint] |= _until_a_jump(rests[:, joint], in_body[:, joint], LEAST_JUMP)
    # A frozen wrist or ankle can only be filled in if its elbow or knee is filled in too.
    frozen[:, np.subtract(_ENDS, 1)] |= frozen[:, _ENDS]
    return frozen


def _until_a_jump(still: np.ndarray, step: np.ndarray, least: float) -> np.ndarray:
    """Frames that repeat the one before, in runs that end with a jump: (F,) of bool.

    `still` (F,) is True where the next frame is the same, and `step` (F,) is the distance to it. A
    jump is a step of more than `least` and than `CAUGHT_UP` times the median of the three steps
    after it.
    """
    repeated = np.zeros(len(still), bool)
    for first, end in runs(still):
        after = step[end + 1 : end + 4]
        if len(after) and step[end] > max(least, CAUGHT_UP * float(np.median(after))):
            repeated[first + 1 : end + 1] = True
    return repeated


def find_stretched(positions: np.ndarray) -> np.ndarray:
    """Joints whose bone has a wrong length in positions (F, 20, 3): (F, 20) of bool."""
    lengths = frame_lengths(positions)
    usual = np.median(lengths, axis=0)
    return np.abs(lengths - usual) > np.maximum(0.02, STRETCHED * usual)


def _turns(body: Body) -> np.ndarray:
    """The change, to the next frame, of the rotation that moves each joint, (F, 20).

    The difference of the quaternions is scaled so that `SAME_ROTATION` becomes `STILL`.
    """
    rig = find_joints(body.motion.skeleton)
    rotations = body.motion.resampled(RATE).rotations
    parents = [body.motion.skeleton.parents[joint] for joint in rig]
    return np.abs(_steps(rotations[:, parents])).max(axis=-1) * (STILL / SAME_ROTATION)


def _steps(values: np.ndarray) -> np.ndarray:
    """The difference from the next frame, 0 for the last."""
    return np.diff(values, axis=0, append=values[-1:])


def _local(features: np.ndarray) -> np.ndarray:
    """The positions in features (F, 63) as (F, 20, 3)."""
    return features[:, POSITIONS].reshape(-1, len(JOINTS), 3)
