"""Constraints on a repaired motion in its own rig: standing feet, the ground and pins.

Bones have the lengths of the rig, whatever its joints do, and the root stays on the way of the
file. A foot stands where the file has it standing; where its joints are damaged, where it stands in
the repaired motion, at the place of the undamaged frames of that step if there are such. The ankle
and the toe are moved there, the knee bends, and between two steps the correction is interpolated.
Pins come from the manifold (`project_constrained`): the difference from the plain projection is
added to the motion, fading out around the pins, and hands and feet then meet their pins exactly.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from numpy_cae.beyond.constrained import project_constrained
from numpy_cae.beyond.pins import Pin, pins_on_mean_skeleton
from numpy_cae.manifold import MotionManifold, Repaired
from numpy_cae.manifold.holes import spline
from numpy_cae.motion.contacts import FEET, find_contacts, floor_height
from numpy_cae.motion.features import VELOCITY
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import body_positions
from numpy_cae.motion.retarget.to_rig import retarget

FADE = 0.75
"""Seconds around a pin in which the rest of the body follows it."""
SMOOTHING = 0.1
"""Seconds. The motion towards pins is smoothed so much, since they begin and end suddenly."""
CARRIED = 0.05
"""Metres. Where pins move the hips further, feet stand in other places than in the file."""
GROUND_MARGIN = 0.01
"""Metres that a repaired toe may be below the floor on which the feet stand."""
_SAME = 1e-6  # metres


def constrain(
    motion: Motion,
    repaired: Repaired,
    manifold: MotionManifold,
    mapping: dict[str, str] | None = None,
    pins: Sequence[Pin] = (),
) -> Repaired:
    """A repaired motion with standing feet, no toe below the ground, and joints at their pins.

    Parameters
    ----------
    motion : Motion
        As it was before the repair.
    repaired : Repaired
        Joints that are not `touched` are trusted to be right in `motion`.
    manifold : MotionManifold
    mapping : dict of joint name to the rig's joint name, optional
    pins : sequence of Pin
        Target positions of joints.

    Returns
    -------
    Repaired
        Where no foot slides, none is below the ground and nothing is pinned, the motion is the
        same to the bit.
    """
    before, own = body_positions(motion, mapping), body_positions(repaired.motion, mapping)
    positions = own.copy()
    carried = np.zeros(len(motion), bool)
    if pins:
        way = _way_of_hips(own, pins)
        carried = np.linalg.norm(way, axis=-1)[:, 0] > CARRIED
        positions += way
        positions += _towards_pins(repaired.motion, positions, manifold, mapping, pins)
        positions += _remaining(positions, pins, 0, motion.rate)[:, None]
    for toe in FEET:
        damaged = repaired.touched[:, toe - 1 : toe + 1].any(axis=1)
        stands = standing(before, own, damaged, toe, motion.rate)
        _place_foot(positions, before, own, toe, stands, damaged | carried)
    for joint in range(1, len(JOINTS)):
        change = _remaining(positions, pins, joint, motion.rate)
        positions[:, joint] += change
        if JOINTS[joint].endswith(("wrist", "ankle")):
            positions[:, joint - 1] += change / 2  # the direction in which the limb bends
    changed = np.linalg.norm(positions - own, axis=-1) > _SAME
    result = retarget(repaired.motion, positions, mapping, changed, np.ones_like(changed))
    moved = np.linalg.norm(body_positions(result, mapping) - before, axis=-1)
    return replace(repaired, motion=result, touched=repaired.touched | changed, moved=moved)


def standing(
    before: np.ndarray, after: np.ndarray, damaged: np.ndarray, toe: int, rate: float
) -> np.ndarray:
    """The frames (F) in which a foot stands, from positions (F, 20, 3) before a repair, and after
    it where the foot was damaged (F)."""
    floor = floor_height(before)
    foot = FEET.index(toe)
    trusted, repaired = (find_contacts(each, rate, floor)[:, foot] for each in (before, after))
    return np.where(damaged, repaired, trusted)


def _place_foot(
    positions: np.ndarray,
    before: np.ndarray,
    own: np.ndarray,
    toe: int,
    stands: np.ndarray,
    free: np.ndarray,
) -> None:
    """Move the ankle and the toe so that the foot stands still, in `positions`.

    In frames that are not `free` (F) it stands as it does in the positions `before`; `own` has
    the length of the foot.
    """
    foot = [toe - 1, toe]
    step = np.zeros((len(positions), 2, 3))
    known = np.linalg.norm(positions[:, foot] - before[:, foot], axis=-1).max(axis=1) < _SAME
    edges = np.flatnonzero(np.diff(stands, prepend=False, append=False))
    for first, end in edges.reshape(-1, 2):
        frames = np.arange(first, end)
        fixed = frames[~free[first:end]]
        place = np.repeat(positions[first:end, toe].mean(axis=0)[None], end - first, axis=0)
        if len(fixed):
            columns = before[fixed, toe].T
            place = np.stack([np.interp(frames, fixed, column) for column in columns], axis=-1)
        step[first:end] = (place - positions[first:end, toe])[:, None]
        step[fixed] = before[fixed][:, foot] - positions[fixed][:, foot]
        known[first:end] = True
    if known.any():
        step = spline(step, np.repeat(~known[:, None], 2, axis=1))
    lowest = positions[:, toe, 1] + step[:, 1, 1]
    below = floor_height(before) - GROUND_MARGIN - lowest
    step[..., 1] += np.where(free, np.maximum(below, 0.0), 0.0)[:, None]
    moves = np.linalg.norm(step, axis=-1).max(axis=1) > _SAME
    ankle, end = np.moveaxis(positions[moves][:, foot] + step[moves], 1, 0)
    length = np.linalg.norm(own[moves, toe - 1] - own[moves, toe], axis=-1, keepdims=True)
    up = ankle - end
    positions[moves, toe] = end
    positions[moves, toe - 1] = end + up * length / np.linalg.norm(up, axis=-1, keepdims=True)


def _way_of_hips(own: np.ndarray, pins: Sequence[Pin]) -> np.ndarray:
    """How far pins of the hips take the body along the floor: (F, 1, 3). Between and beyond the
    pinned frames the nearest ones decide, so that the rest of the way is kept."""
    way, free = np.zeros((len(own), 1, 3)), np.ones((len(own), 1), bool)
    for pin in pins:
        if pin.joint == "hips":
            frames = np.arange(pin.first, pin.last + 1)
            way[frames, 0] = np.nan_to_num(pin.targets(frames) - own[frames, 0]) * [1, 0, 1]
            free[frames] = False
    return spline(way, free)


def _towards_pins(
    motion: Motion,
    positions: np.ndarray,
    manifold: MotionManifold,
    mapping: dict[str, str] | None,
    pins: Sequence[Pin],
) -> np.ndarray:
    """The change (frames, 20, 3) of the positions that takes joints near their pins, without the
    root. It is the difference of two projections: near the pins, and of the unchanged motion."""
    plain = manifold.body(motion, mapping)
    moved = plain
    if any(pin.joint == "hips" for pin in pins):
        moved = manifold.body(retarget(motion, positions, mapping), mapping)
    targets = pins_on_mean_skeleton(pins, moved)
    found = project_constrained(manifold, moved.features, moved.root, pins=targets)
    unchanged = manifold.project(plain.features, manifold.shifts)
    unchanged[:, VELOCITY.start :] = found[:, VELOCITY.start :]
    towards, away = (
        moved.in_file_frames(moved.positions_of(features)) for features in (found, unchanged)
    )
    change = gaussian_filter1d(towards - away, SMOOTHING * motion.rate, axis=0, mode="nearest")
    weight = np.max([_fade(len(motion), pin, motion.rate) for pin in pins], axis=0)
    change *= weight[:, None, None]
    return np.where(np.linalg.norm(change, axis=-1, keepdims=True) > 1e-3, change, 0.0)


def _remaining(positions: np.ndarray, pins: Sequence[Pin], joint: int, rate: float) -> np.ndarray:
    """The change (F, 3) of a joint that takes it exactly to its pins, fading out around them."""
    own = [pin for pin in pins if pin.joint == JOINTS[joint]]
    change = np.zeros((len(positions), 1, 3))
    near, pinned = np.zeros((2, len(positions), 1), bool)
    for pin in own:
        frames = np.arange(pin.first, pin.last + 1)
        change[frames, 0] = np.nan_to_num(pin.targets(frames) - positions[frames, joint])
        pinned[frames] = True
        near |= _fade(len(positions), pin, rate)[:, None] > 0
    return spline(change, near & ~pinned)[:, 0]


def _fade(frames: int, pin: Pin, rate: float) -> np.ndarray:
    """(frames,): 1 in the frames of the pin, 0 from `FADE` seconds before and after them."""
    frame = np.arange(frames)
    away = np.maximum(np.maximum(pin.first - frame, frame - pin.last), 0) / (FADE * rate)
    return 0.5 + 0.5 * np.cos(np.pi * np.minimum(away, 1.0))
