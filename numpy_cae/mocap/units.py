"""The unit of length of a motion file.

BVH does not state it. The people in motion capture are adults, so the size of the skeleton tells:
a person some 172 units tall is in centimetres. The stature is derived from the lengths of the
bones alone, since a rest pose may be anything (Bandai's has every bone along x) and a root may lie
on the floor. The longest path along bones from one tip to another runs from a toe to the finger
tips; it is about 1.3 times the stature in any pose (less in a rig that ends at the wrists, as
Bandai's, more with fingers, as in CMU's).
"""

import numpy as np

from numpy_cae.motion.motion import Note, Skeleton

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

TYPICAL = 1.55
"""TYPICAL: the stature (m) to which a guess comes closest, the geometric mean of 1.1 m (a child of
five) and 2.2 m (nobody is taller)."""
TIP_TO_TIP = 1.3
"""TIP_TO_TIP: the way from a toe to the finger tips along the bones, in statures."""
PLAUSIBLE = (0.9, 2.4)
"""PLAUSIBLE: a guess that gives a stature (m) outside this range is not reliable."""


def require_unit(unit: float) -> float:
    """The unit; ValueError unless it is a positive number of metres."""
    if not (np.isfinite(unit) and unit > 0):
        raise ValueError(f"unit is {unit}, expected metres per unit of the file, above 0")
    return float(unit)


def unit_name(unit: float) -> str:
    """The name of a unit that is this many metres long."""
    for name, metres in UNITS.items():
        if abs(unit / metres - 1) < 1e-6:
            return name
    return f"units of {unit:g} m"


def stature(skeleton: Skeleton, bone_lengths: np.ndarray | None = None) -> float:
    """The stature of a person with these bones, in the unit of the lengths; 0 without two tips.

    `bone_lengths` (J,), from each joint to its parent, are by default those of the offsets.
    """
    if bone_lengths is None:
        bone_lengths = np.linalg.norm(skeleton.offsets, axis=-1)
    longest = 0.0
    # Lengths of the paths from each joint down to a tip. A path from tip to tip goes up to some
    # joint and down again; a root without branches is never such a joint.
    paths: list[list[float]] = [[] for _ in skeleton.names]
    for joint in reversed(range(len(skeleton.names))):
        if joint in skeleton.end_sites:
            paths[joint].append(float(np.linalg.norm(skeleton.end_sites[joint])))
        down = sorted(paths[joint], reverse=True)
        if len(down) > 1:
            longest = max(longest, down[0] + down[1])
        if skeleton.parents[joint] >= 0:
            length = float(bone_lengths[joint] + (down[0] if down else 0.0))
            paths[skeleton.parents[joint]].append(length)
    return longest / TIP_TO_TIP


def stated_unit(unit: float, source: str, height: float) -> Note:
    """A note on a unit and its source, from the height of the person (m, 0 if unknown). The unit is
    in doubt if nobody is as tall."""
    in_doubt = height > 0 and not PLAUSIBLE[0] <= height <= PLAUSIBLE[1]
    advice = ", which no adult is: give the right unit" if in_doubt else ""
    text = f"{unit_name(unit)} ({source}: the skeleton is about {height:.1f} m tall{advice})"
    return Note("unit", text, in_doubt)


def guess_unit(height: float) -> tuple[float, Note]:
    """The unit in metres in which a person of this height is closest to `TYPICAL`, and a note."""
    if not height > 0:
        text = "metres (assumed: the skeleton has no two limbs to measure)"
        return 1.0, Note("unit", text)
    unit = min(UNITS.values(), key=lambda unit: abs(np.log(height * unit / TYPICAL)))
    return unit, stated_unit(unit, "guessed", height * unit)
