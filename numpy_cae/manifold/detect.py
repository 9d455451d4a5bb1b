"""Detection of damaged joints: by their distance from the manifold, and by direct tests."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.manifold.fill import fill, whole_features
from numpy_cae.manifold.holes import at_thirty, hole_lengths, spline, whole_stretches
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import POSITIONS
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import frame_lengths
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.retarget.body import Body
from numpy_cae.motion.retarget.rigs import find_joints

RATIO, FAR = 4.0, 0.1
"""A joint is damaged where it is further from the manifold than `RATIO` times its median in the
clip and than `FAR` metres; its damage reaches as far as half of that is exceeded."""
LEAST = 0.05
"""Metres by which a repair must move a joint: where it does not, nothing is changed."""
SUSPICION = 0.25
"""Between two jumps, a joint is damaged from this share of these distances on."""
MOST_JOINTS = 8
"""Where more joints are far from the manifold, the motion is unknown and not damaged."""
ROUNDS = 3
"""Times that what was found is filled in and the rest is tested again."""
MARGIN = 2
"""Frames on both sides of damage that are taken for damaged."""
JUMP, JUMP_RATIO = 0.05, 4.0
"""Metres by which a step differs from the median of seven, and times the median difference."""
OPPOSITE = -0.3
"""Cosine of the angle between a jump and the jump back, at most."""
SPIKE_FRAMES, LONGEST = 3, 150
"""Frames of the longest stretch between two jumps that is a spike, and that is tested."""
STRETCHED = 0.15
"""Share of its length by which a bone of wrong length differs from the usual one."""
STILL, STILL_FRAMES, LEAST_JUMP = 3e-4, 6, 0.03
"""Metres a frame below which a joint stands still, for how many frames before it jumps that is
damage, and metres of the smallest such jump."""
SAME_ROTATION = 1e-6
"""Difference of quaternions below which a file repeats a rotation."""
REPEATED, CAUGHT_UP = 1e-6, 2.5
"""Metres a frame below which a pose is repeated; a jump is as many times as long as later steps."""

_FEET = [JOINTS.index(f"{side}_{end}") for side in ("left", "right") for end in ("ankle", "toe")]
_ENDS = [JOINTS.index(f"{side}_{end}") for side in ("left", "right") for end in ("wrist", "ankle")]


def find_damage(manifold: MotionManifold, body: Body) -> np.ndarray:
    """The damaged joints of a motion: (F, 20) bool, at 30 frames a second.

    A joint is damaged where `direct_damage` says so or where it is far from its projection. What is
    found is filled in, since damage also moves the projection of other joints, and the rest is
    tested again. In the end a stretch counts only if filling it in moves the joint by `LEAST`.
    """
    direct = at_thirty(body.motion, direct_damage(body))
    spline_features, _ = whole_features(body, direct)
    points = spline(_local(spline_features), direct)
    steps, jumps = find_jumps(points)
    displaced = between_jumps(steps, jumps, LONGEST)
    abrupt = with_margin(jumps)
    direct |= find_frozen(body, spline(body.positions, direct), points)
    found = direct.copy()
    features, _ = whole_features(body, found)
    for _ in range(ROUNDS):
        difference = residual(manifold, features, found)
        # Rigs place joints differently: what is the same in the whole clip is no damage.
        distance = np.linalg.norm(difference - typical(difference, found), axis=-1)
        level = distance / np.maximum(FAR, RATIO * typical(distance, found))
        far = whole_stretches(level > 0.5, level > 1)
        # Without a jump it is a pose that the model does not know: someone kneels or lies.
        far = whole_stretches(far, abrupt)
        far |= whole_stretches(displaced, level > SUSPICION)
        far &= ~found
        if not far.any():
            break
        found |= with_margin(far)
        features, _ = whole_features(body, found)
    found &= direct | displaced | (found.sum(axis=1, keepdims=True) <= MOST_JOINTS)
    change = np.linalg.norm(_local(fill(manifold, features, found) - body.features), axis=-1)
    return whole_stretches(found, change > LEAST)


def residual(manifold: MotionManifold, features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The difference of each joint from the projection of the motion with its missing joints filled
    in: (F, 20, 3) in metres."""
    filled = fill(manifold, features, missing)
    return _local(features - manifold.project(filled, manifold.shifts))


def typical(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The median of each joint's values (F, 20, …) over the frames in which it is not missing."""
    gone = missing & ~missing.all(axis=0)
    gone = gone.reshape(*gone.shape, *[1] * (values.ndim - 2))
    return np.nanmedian(np.where(gone, np.nan, values), axis=0)


def direct_damage(body: Body) -> np.ndarray:
    """Damage that shows without a manifold: (frames, 20) bool in the frames of the file."""
    positions = body.positions_in_file
    spikes = between_jumps(*find_jumps(positions - positions[:, :1]), SPIKE_FRAMES)
    return spikes | find_stretched(positions) | find_repeated(positions)[:, None]


def between_jumps(steps: np.ndarray, jumps: np.ndarray, longest: int) -> np.ndarray:
    """Joints displaced between a jump of `find_jumps` and a jump back: (F, 20) bool.

    The two have opposite directions, their lengths differ by less than a factor of two, and at most
    `longest` frames are between them.
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
    """What is unlike the median of seven in the step of points (F, 20, 3) to the next frame, in
    their shape, and where that is a jump, (F, 20) bool."""
    unlike, jumps = np.zeros(points.shape), np.zeros(points.shape[:2], bool)
    for joint in range(points.shape[1]):
        step = _steps(points[:, joint])[:-1]
        unlike[:-1, joint] = step - median_of_seven(step)
        size = np.linalg.norm(unlike[:-1, joint], axis=-1)
        usual = median_of_seven(size[:, None])[:, 0]
        jumps[:-1, joint] = (size > JUMP) & (size > JUMP_RATIO * usual)
    return unlike, jumps


def median_of_seven(values: np.ndarray) -> np.ndarray:
    """The running median of values (F, N) over seven frames; beyond the ends they are held."""
    if not len(values):
        return values
    held = np.pad(values, ((3, 3), (0, 0)), mode="edge")
    return np.sort(sliding_window_view(held, 7, axis=0), axis=-1)[..., 3]


def with_margin(mask: np.ndarray) -> np.ndarray:
    """A mask (F, N) with `MARGIN` more frames on both sides of each stretch."""
    held = np.pad(mask, ((MARGIN, MARGIN), (0, 0)))
    return np.any(sliding_window_view(held, 2 * MARGIN + 1, axis=0), axis=-1)


def find_repeated(positions: np.ndarray) -> np.ndarray:
    """Frames of positions (F, 20, 3) that repeat the pose before, until the body catches up in one
    step: (F,) bool. Dropped frames and held keys look so, and no one who stands still."""
    # One joint at a time: an hour at 120 Hz would take half a gigabyte more.
    joints = range(positions.shape[1])
    steps = [np.linalg.norm(_steps(positions[:, joint]), axis=-1) for joint in joints]
    step = np.stack(steps, axis=1).mean(axis=1)
    return _until_a_jump(step < REPEATED, step, 0.0)


def find_frozen(body: Body, positions: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Joints that stand still until they jump: (F, 20) bool at 30 frames a second.

    A joint is still in the world, but for feet, or in the body's frame, a wrist or an ankle also at
    a constant distance from its shoulder or hip, and any joint while the file repeats the rotation
    that moves it. Hands that rest do the same, but do not jump when they move again.

    `positions` and `local` (F, 20, 3) are in the world and in the body's frame, without spikes.
    """
    reach = np.linalg.norm(positions[:, _ENDS] - positions[:, np.subtract(_ENDS, 2)], axis=-1)
    bends = np.full(positions.shape[:2], np.inf)
    bends[:, _ENDS] = np.abs(_steps(reach))
    world, own = (np.linalg.norm(_steps(place), axis=-1) for place in (positions, local))
    world[:, _FEET] = np.inf
    frozen = np.zeros(own.shape, bool)
    for speed in (world, own, bends, _turns(body)):
        rests = hole_lengths(speed < STILL) >= STILL_FRAMES
        for joint in np.flatnonzero(rests.any(axis=0)):
            frozen[:, joint] |= _until_a_jump(rests[:, joint], own[:, joint], LEAST_JUMP)
    # A rig holds a wrist or an ankle by the elbow or the knee above it.
    frozen[:, np.subtract(_ENDS, 1)] |= frozen[:, _ENDS]
    return frozen


def _until_a_jump(still: np.ndarray, step: np.ndarray, least: float) -> np.ndarray:
    """Frames that repeat the one before where the stretch of them ends with a jump: (F,) bool.

    `still` is True and `step` is small where the next frame is the same; a jump is a step of more
    than `least` and than `CAUGHT_UP` times the median of the three steps after it.
    """
    found = np.zeros(len(still), bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        after = step[last + 1 : last + 4]
        if len(after) and step[last] > max(least, CAUGHT_UP * float(np.median(after))):
            found[first + 1 : last + 1] = True
    return found


def find_stretched(positions: np.ndarray) -> np.ndarray:
    """Joints whose bone is not as long as usual: positions (F, 20, 3) to (F, 20) bool."""
    lengths = frame_lengths(positions)
    usual = np.median(lengths, axis=0)
    return np.abs(lengths - usual) > np.maximum(0.02, STRETCHED * usual)


def _turns(body: Body) -> np.ndarray:
    """How much the rotation that moves each joint changes until the next frame: (F, 20), the
    difference of quaternions in units of which `SAME_ROTATION` is as still as `STILL`."""
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
