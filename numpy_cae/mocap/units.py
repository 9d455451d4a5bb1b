"""The unit of length of a motion file.

BVH does not state it. The people in motion capture are adults, so the size of the skeleton tells:
a person some 172 units tall is in centimetres. The stature is derived from the lengths of the
bones alone, since a rest pose may be anything (Bandai's has every bone along x) and a root may lie
on the floor. The longest path along bones from one tip to another runs from a toe to the finger
tips; it is about 1.3 times the stature in any pose (less in a rig that ends at the wrists, as
Bandai's, more with fingers, as in CMU's).
"""

from dataclasses import replace

import numpy as np

from numpy_cae.mocap.rigs.rigs import RiggedMotion
from numpy_cae.motion import JOINTS, PARENTS, Note, Skeleton

INCH = 0.0254
# CMU's skeletons say `length 0.45`: a value divided by 0.45 is inches.
CMU_UNIT = INCH / 0.45
UNITS = {
    "metres": 1.0,
    "decimetres": 0.1,
    "CMU's units of 1/0.45 inch": CMU_UNIT,
    "inches": INCH,
    "centimetres": 0.01,
    "millimetres": 0.001,
}
"""The candidates of a guess, in metres. Feet are not among them: no file uses them."""

SMALLEST_UNIT = 1e-6
LARGEST_UNIT = 1e4
"""A unit that is given is within this range (m): with others lengths overflow."""
TYPICAL_METRES = 1.55
"""The stature (m) to which a guess comes closest, the geometric mean of 1.1 m (a child of five) and
2.2 m (nobody is taller)."""
TIP_TO_TIP_STATURES = 1.3
"""The way from a toe to the finger tips along the bones, in statures."""
PLAUSIBLE_METRES = (0.9, 2.4)
"""A guess that gives a stature (m) outside this range is not reliable."""


def require_unit(unit: float) -> float:
    """The unit; ValueError unless it is a number of metres from `SMALLEST_UNIT` to
    `LARGEST_UNIT`."""
    if not SMALLEST_UNIT <= unit <= LARGEST_UNIT:
        expected = f"expected metres per unit of the file, {SMALLEST_UNIT:g} to {LARGEST_UNIT:g}"
        raise ValueError(f"unit is {unit}, {expected}")
    return float(unit)


def unit_name(unit: float) -> str:
    """The name of a unit that is this many metres long."""
    names = (name for name, metres in UNITS.items() if abs(unit / metres - 1) < 1e-6)
    return next(names, f"units of {unit:g} m")


def stature(skeleton: Skeleton, bone_lengths: np.ndarray) -> float:
    """The stature of a person with bones of these lengths (J,), from each joint to its parent, in
    the unit of the lengths; 0 without two tips."""
    longest = 0.0
    # The longest path down from each joint to a tip. A path from tip to tip goes up to some joint
    # and down again; a root without branches is never such a joint.
    reach = np.full(len(skeleton.names), -np.inf)
    for joint, tip in skeleton.end_sites.items():
        reach[joint] = np.linalg.norm(tip)
    for joint in range(len(reach) - 1, 0, -1):
        parent = skeleton.parents[joint]
        length = bone_lengths[joint] + max(reach[joint], 0.0)
        longest = max(longest, float(reach[parent] + length))
        reach[parent] = max(reach[parent], length)
    return longest / TIP_TO_TIP_STATURES


def describe_unit(unit: float, source: str, height: float) -> Note:
    """A note on a unit and its source, from the height of the person (m, 0 if unknown). The unit is
    in doubt if nobody is as tall."""
    in_doubt = height > 0 and not PLAUSIBLE_METRES[0] <= height <= PLAUSIBLE_METRES[1]
    advice = ", which no adult is: give the right unit" if in_doubt else ""
    text = f"{unit_name(unit)} ({source}: the skeleton is about {height:.1f} m tall{advice})"
    return Note("unit", text, in_doubt)


def guess_unit(height: float) -> tuple[float, Note]:
    """The unit in metres in which a person of this height is closest to `TYPICAL_METRES`, and a
    note."""
    if not height > 0:
        text = "metres (assumed: the skeleton has no two limbs to measure)"
        return 1.0, Note("unit", text)
    unit = min(UNITS.values(), key=lambda unit: abs(np.log(height * unit / TYPICAL_METRES)))
    return unit, describe_unit(unit, "guessed", height * unit)


_LIMB_ENDS = (
    "left_knee",
    "left_ankle",
    "left_elbow",
    "left_wrist",
    "right_knee",
    "right_ankle",
    "right_elbow",
    "right_wrist",
)
"""The joints where the long bones of legs and arms end."""
LIMBS_SHARE = 0.77
"""A leg from hip to ankle and an arm from shoulder to wrist are together this part of a person's
stature."""
_POSES_OF_BONES = 100
"""Bones are measured in about this many poses of a motion."""


def guess_unit_from_limbs(motion: RiggedMotion) -> RiggedMotion:
    """The motion with its unit guessed again, from the twenty joints' legs and arms alone: props,
    hair and fingers do not count. The same motion if they were not found."""
    indices = motion.rig.indices
    starts = {end: JOINTS[PARENTS[JOINTS.index(end)]] for end in _LIMB_ENDS}
    if not {*starts, *starts.values()} <= set(indices):
        return motion
    translations = motion.sampled(_POSES_OF_BONES).translations
    lengths = np.linalg.norm(np.median(translations, axis=0), axis=-1)
    total = 0.0
    for end, start in starts.items():
        path = motion.skeleton.path(indices[end])
        if indices[start] in path:
            total += lengths[path[: path.index(indices[start])]].sum()
    unit, note = guess_unit(total / 2 / LIMBS_SHARE / motion.unit)
    scale = unit / motion.unit
    motion = replace(motion, unit=unit, notes=(note, *motion.notes[1:]))
    if scale == 1:
        return motion
    skeleton = motion.skeleton.scaled(scale)
    return replace(motion, skeleton=skeleton, translations=scale * motion.translations)
