"""Edits of a motion that a user asks for, and that look for no damage.

Each takes a motion and returns a new one; `numpy-cae edit` has an option for each. Joints have our
names or the rig's, frames are the first and the last one, counted from 0.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from numpy_cae.cleanup.cuts import find_cuts
from numpy_cae.cleanup.feet import find_feet, mend_feet
from numpy_cae.cleanup.finding import is_path
from numpy_cae.cleanup.interpolation import with_finite_values
from numpy_cae.cleanup.kinds import TOES
from numpy_cae.cleanup.view import View
from numpy_cae.mocap.rigs.recognise import joint_index, rig_of
from numpy_cae.motion import JOINTS, Motion, Skeleton
from numpy_cae.motion.filters import (
    HIGHEST_SHARE,
    LOWEST_HERTZ,
    butterworth,
    filter_motion,
    median_of,
    smooth_curve,
)
from numpy_cae.motion.joints import SIDES
from numpy_cae.motion.masks import fade_in_and_out
from numpy_cae.motion.motion import require_finite
from numpy_cae.motion.quaternions import slerp

FADE_SECONDS = 0.1
"""A filter of some frames begins and ends within this time (s), unless the user says otherwise."""
SYMMETRIC_SHARE = 0.2
"""The mirror image of a joint in the rest pose is nearer to its counterpart than this share of the
length of the legs."""
NOT_MIRRORED = (
    "this rig cannot be mirrored; retarget the motion to a rig whose left and right sides are "
    "mirror images in the rest pose, such as a T-pose, in the program that it comes from, and "
    "mirror that file"
)
"""What is said of a rig without two like sides."""
MIRROR = np.array([-1.0, 1.0, 1.0])
"""The signs of a place's coordinates in the mirror, x to the side."""


def trim_motion(motion: Motion, frames: Sequence[int]) -> Motion:
    """The motion from the first to the last of two frames.

    Raises
    ------
    ValueError
        If the motion does not have the frames.

    Examples
    --------
    >>> from data_synth import make_take
    >>> trim_motion(make_take("walk", 0, seconds=2.0, rate=30.0).motion, (10, 39))
    motion of 30 frames at 30 a second, 31 joints
    """
    return motion.at(_stretch(motion, frames))


def split_at_cuts(motion: Motion) -> list[Motion]:
    """The clips of a motion, which begin where `repair` says that there is a cut; the motion itself
    if there is none.

    Examples
    --------
    >>> from data_synth import make_body, make_take
    >>> from numpy_cae.cleanup.result import join_motions
    >>> body = make_body(1.75)
    >>> walk = make_take("walk", 1, seconds=2.0, rate=30.0, body=body).motion
    >>> squats = make_take("squats", 2, seconds=2.0, rate=30.0, body=body).motion
    >>> [len(clip) for clip in split_at_cuts(join_motions(walk, squats))]
    [60, 60]
    """
    cuts = find_cuts(View(with_finite_values(motion)[0]))
    if not cuts:
        return [motion]
    return [motion.at(slice(first, end)) for first, end in pairwise([0, *cuts, len(motion)])]


def filter_low_pass(
    motion: Motion,
    hertz: float,
    joints: Iterable[str] | None = None,
    frames: Sequence[int] | None = None,
    fade: float = FADE_SECONDS,
) -> Motion:
    """The motion after a Butterworth filter of second order, forwards and backwards.

    Parameters
    ----------
    motion : Motion
    hertz : float
        The cut-off frequency (Hz).
    joints : strings, optional
        Only these are filtered; all where None.
    frames : (int, int), optional
        The first and the last frame that are filtered; all where None.
    fade : float
        Within this time (s) the filter begins and ends, if frames before and after are left.

    Returns
    -------
    Motion

    Raises
    ------
    ValueError
        If the motion does not have the joints or frames, has values that are not finite, or the
        cut-off is below `LOWEST_HERTZ` or not below half of the rate.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("run", 0, seconds=2.0, rate=30.0).motion
    >>> smooth = filter_low_pass(motion, 4.0, ["left_elbow"], (20, 40))
    >>> changed = np.argwhere((smooth.rotations != motion.rotations).any(axis=-1))
    >>> [motion.skeleton.names[joint] for joint in set(changed[:, 1])], changed[[0, -1], 0]
    (['lradius'], array([20, 40]))
    """
    highest = HIGHEST_SHARE * motion.rate
    if not LOWEST_HERTZ <= hertz <= highest:
        expected = f"expected {LOWEST_HERTZ:g} to {highest:g}"
        raise ValueError(f"the cut-off is {hertz:g} Hz, {expected}")
    smooth = partial(butterworth, cut_off=hertz, rate=motion.rate)
    return _filter_part(motion, smooth, joints, frames, fade)


def filter_median(
    motion: Motion,
    around: int,
    joints: Iterable[str] | None = None,
    frames: Sequence[int] | None = None,
    fade: float = FADE_SECONDS,
) -> Motion:
    """The motion whose values are the medians of as many frames before and after as `around` says;
    the other parameters, results and errors are those of `filter_low_pass`.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("idle", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[30, 0] += [0.5, 0.0, 0.0]
    >>> steps = np.diff(filter_median(motion, 2).translations[:, 0], axis=0)
    >>> bool(np.abs(steps).max() < 0.01)
    True
    """
    if around < 1:
        raise ValueError(f"the median is over {around} frames around, expected at least 1")
    if around >= len(motion):
        problem = f"the median is over {around} frames around, the motion has {len(motion)} in all"
        raise ValueError(f"{problem}: expected fewer")
    return _filter_part(motion, partial(median_of, around=around), joints, frames, fade)


def filter_jitter(
    motion: Motion,
    joints: Iterable[str] | None = None,
    frames: Sequence[int] | None = None,
    fade: float = FADE_SECONDS,
) -> Motion:
    """The motion after the filter of `repair --smooth`, whose cut-off is chosen from the noise of
    each curve (`motion.filters`); parameters, results and errors are those of `filter_low_pass`.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> noise = 0.02 * np.random.default_rng(0).normal(size=motion.translations.shape)
    >>> noisy = replace(motion, translations=motion.translations + noise)
    >>> smooth = filter_jitter(noisy, ["hips"])
    >>> errors = [np.abs(x.translations - motion.translations)[:, 0] for x in (noisy, smooth)]
    >>> bool(errors[1].mean() < 0.7 * errors[0].mean())
    True
    """
    smooth = partial(smooth_curve, rate=motion.rate)
    return _filter_part(motion, smooth, joints, frames, fade)


def hold_standing_feet(
    motion: Motion,
    toes: Iterable[str] = TOES,
    frames: Sequence[int] | None = None,
) -> Motion:
    """The motion with feet that stand held at their places, as by `repair --feet`, but only the
    named toes, and only in some frames.

    Parameters
    ----------
    motion : Motion
        On any rig in which the twenty joints can be found.
    toes : strings
        Which of `kinds.TOES`, by our names or the rig's.
    frames : (int, int), optional
        The first and the last frame in which feet are held; all where None.

    Returns
    -------
    Motion

    Raises
    ------
    ValueError
        If the motion does not have the frames, has values that are not finite, a joint is no toe,
        or the hips do not move with the feet, so that the path of the whole motion is missing.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.translations[:, 0, 0] += np.linspace(0.0, 0.6, 60)
    >>> held = hold_standing_feet(motion, ["left_toe"], (0, 29))
    >>> int(np.flatnonzero((held.rotations != motion.rotations).any(axis=(1, 2)))[-1]) < 40
    True
    """
    require_finite(motion)
    stretch = _stretch(motion, frames)
    names = [JOINTS[joint_index(toe, motion)] for toe in toes]
    for name in names:
        if name not in TOES:
            raise ValueError(f"{name} does not stand: expected {' or '.join(TOES)}")
    view = View(motion)
    findings = []
    for finding in find_feet(view, sensitivity=1.0):
        if is_path(finding):
            raise ValueError(
                "the hips do not move as the feet do: give the whole motion its path first, by "
                "repair --feet"
            )
        first = max(finding.stretch.start, stretch.start)
        end = min(finding.stretch.stop, stretch.stop)
        if finding.joint in names and first < end:
            findings.append(replace(finding, frames=(first, end - 1)))
    return mend_feet(view, findings) if findings else motion


def mirror_motion(motion: Motion) -> Motion:
    """The mirror image of a motion on its own skeleton: the left side does what the right one did.

    Raises
    ------
    ValueError
        If the two sides of the rest pose are not mirror images, so that rotations of one cannot be
        those of the other; if values are not finite.

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("wave", 0, seconds=2.0, rate=30.0).motion
    >>> again = mirror_motion(mirror_motion(motion))
    >>> bool(np.abs(again.rotations - motion.rotations).max() < 1e-9)
    True
    """
    require_finite(motion)
    axis = _side_axis(motion)
    counterparts = _pair_joints(motion.skeleton, axis, _leg_length(motion))
    signs = np.roll(MIRROR, axis)
    # A rotation about an axis in the mirror plane turns the other way.
    rotations = motion.rotations[:, counterparts] * np.append(-signs, 1.0)
    offsets = motion.skeleton.offsets
    away = motion.translations - offsets  # of joints with channels for their places
    translations = offsets + signs * away[:, counterparts]
    translations[:, 0] = signs * motion.translations[:, 0]
    return replace(motion, rotations=rotations, translations=translations)


def _stretch(motion: Motion, frames: Sequence[int] | None) -> slice:
    """The frames from the first to the last of two; all where None."""
    if frames is None:
        return slice(0, len(motion))
    first, last = frames
    if not 0 <= first <= last < len(motion):
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {len(motion) - 1}")
    return slice(first, last + 1)


def _filter_part(
    motion: Motion,
    smooth: Callable[[np.ndarray], np.ndarray],
    joints: Iterable[str] | None,
    frames: Sequence[int] | None,
    fade: float,
) -> Motion:
    """The motion with the curves of some joints filtered in some frames."""
    require_finite(motion)
    stretch = _stretch(motion, frames)
    indices = list(range(len(motion.skeleton.names)))
    if joints is not None:
        indices = sorted({joint_of_rig(name, motion) for name in joints})
    filtered = filter_motion(motion, smooth)
    share = fade_in_and_out(len(motion), stretch, fade * motion.rate)[stretch]
    rotations = motion.rotations.copy()
    translations = motion.translations.copy()
    for joint in indices:
        values = rotations[stretch, joint]
        rotations[stretch, joint] = slerp(values, filtered.rotations[stretch, joint], share)
        way = filtered.translations[stretch, joint] - translations[stretch, joint]
        translations[stretch, joint] += share[:, None] * way
    return replace(motion, rotations=rotations, translations=translations)


def joint_of_rig(name: str, motion: Motion) -> int:
    """The index in the rig of a joint, by our name or by the rig's; ValueError if it has none."""
    if name in JOINTS:
        return rig_of(motion).joints[JOINTS.index(name)]
    try:
        return motion.skeleton.index(name)
    except KeyError as error:
        raise ValueError(str(error.args[0])) from None


def _leg_length(motion: Motion) -> float:
    """The length of a thigh and a shank in metres."""
    joints = rig_of(motion).joints
    knee, ankle = (joints[JOINTS.index(f"left_{name}")] for name in ("knee", "ankle"))
    return float(np.linalg.norm(motion.skeleton.offsets[[knee, ankle]], axis=1).sum())


def _side_axis(motion: Motion) -> int:
    """The axis, 0 to 2, along which the hips of the rest pose are apart."""
    rest = motion.skeleton.rest_positions()
    joints = rig_of(motion).joints
    left_hip, right_hip = (rest[joints[JOINTS.index(f"{side}_hip")]] for side in SIDES)
    return int(np.abs(left_hip - right_hip).argmax())


def _pair_joints(skeleton: Skeleton, axis: int, leg: float) -> list[int]:
    """For each joint the one whose place in the rest pose is its mirror image, itself in the
    middle: among the children of counterparts, the one whose limb is nearest."""
    centres = _limb_centres(skeleton)
    signs = np.roll(MIRROR, axis)
    centres -= centres[0] * (signs < 0)
    counterparts = [0] * len(skeleton.names)
    for joint, parent in enumerate(skeleton.parents[1:], start=1):
        candidates = skeleton.children(counterparts[parent])
        image = signs * centres[joint]
        distances = [np.linalg.norm(image - centres[candidate]) for candidate in candidates]
        if not distances or min(distances) > SYMMETRIC_SHARE * leg:
            name = skeleton.names[joint]
            problem = f"joint {name!r} has no counterpart on the other side of the rest pose"
            raise ValueError(f"{problem}: {NOT_MIRRORED}")
        counterparts[joint] = candidates[int(np.argmin(distances))]
    if sorted(counterparts) != list(range(len(counterparts))):
        raise ValueError(f"two joints have one counterpart in the rest pose: {NOT_MIRRORED}")
    return counterparts


def _limb_centres(skeleton: Skeleton) -> np.ndarray:
    """The mean rest position of each joint and all that is below it, (J, 3) in metres from the
    root: joints at one place differ in their limbs."""
    places = skeleton.rest_positions() - skeleton.offsets[0]
    sums = places.copy()
    counts = np.ones(len(places))
    for joint in reversed(range(1, len(places))):
        parent = skeleton.parents[joint]
        sums[parent] += sums[joint]
        counts[parent] += counts[joint]
    return np.asarray(sums / counts[:, None])
