"""How long one unit of a motion file is.

BVH does not say. The people in motion capture are grown up, so the size of the skeleton tells:
a person some 172 units tall is written in centimetres. How tall a skeleton stands is taken from
the lengths of its bones alone, since a rest pose may be anything (Bandai's lays every bone along
x) and a root may lie on the floor. The longest way along bones from one tip to another runs from
a toe to the finger tips; it is about 1.3 times the stature in whatever pose (less where a rig
ends at the wrists, as Bandai's, more where it has fingers, as CMU's).
"""

from __future__ import annotations

import numpy as np

from numpy_cae.motion.skeleton import Skeleton

INCH = 0.0254
# CMU's skeletons say `length 0.45`: a value divided by 0.45 is inches.
CMU_UNIT = INCH / 0.45
UNITS = {
    "metres": 1.0,
    "CMU's units of 1/0.45 inch": CMU_UNIT,
    "inches": INCH,
    "centimetres": 0.01,
    "millimetres": 0.001,
}
"""The units that a guess chooses from, in metres. Feet are left out: no one writes them."""

ADULT = 1.7
"""Metres."""
TIP_TO_TIP = 1.3
"""Toe to finger tips along the bones, in statures."""
PLAUSIBLE = (0.9, 2.4)
"""Statures in metres beyond which a guess is not to be trusted."""


def require_unit(unit: float) -> float:
    """Raise ValueError unless `unit` can be a number of metres."""
    if not (np.isfinite(unit) and unit > 0):
        raise ValueError(f"unit is {unit}, expected metres per unit of the file, above 0")
    return float(unit)


def unit_name(unit: float) -> str:
    """A unit of so many metres, for a person."""
    for name, metres in UNITS.items():
        if abs(unit / metres - 1) < 1e-6:
            return name
    return f"units of {unit:g} m"


def stature(skeleton: Skeleton, bone_lengths: np.ndarray | None = None) -> float:
    """How tall someone with such bones stands.

    Parameters
    ----------
    skeleton : Skeleton
    bone_lengths : (J,) array, optional
        From each joint's parent to the joint. By default the lengths of the skeleton's offsets;
        a motion whose joints have position channels may know better.

    Returns
    -------
    float
        In the unit of the lengths; 0 where there are no two tips.
    """
    if bone_lengths is None:
        bone_lengths = np.linalg.norm(skeleton.offsets, axis=-1)
    joints = len(skeleton.names)
    # The longest way down from each joint to a tip; a way from tip to tip turns at some joint
    # and goes down on two sides. A root below the hips is never such a turning point.
    down = np.zeros(joints)
    longest = 0.0
    ways: list[list[float]] = [[] for _ in range(joints)]
    for joint in reversed(range(joints)):
        if joint in skeleton.end_sites:
            ways[joint].append(float(np.linalg.norm(skeleton.end_sites[joint])))
        ways[joint].sort(reverse=True)
        if len(ways[joint]) > 1:
            longest = max(longest, ways[joint][0] + ways[joint][1])
        down[joint] = ways[joint][0] if ways[joint] else 0.0
        parent = skeleton.parents[joint]
        if parent >= 0:
            ways[parent].append(float(bone_lengths[joint] + down[joint]))
    return longest / TIP_TO_TIP


def is_plausible(metres: float) -> bool:
    """Whether someone may be that tall."""
    return PLAUSIBLE[0] <= metres <= PLAUSIBLE[1]


def guess_unit(height: float) -> tuple[float, str]:
    """The unit in which someone `height` units tall comes nearest to a grown person.

    Parameters
    ----------
    height : float
        As `stature` gives it, in units of the file.

    Returns
    -------
    unit : float
        Metres per unit; 1 where there is nothing to measure.
    note : str
        What was taken and why, for a person.
    """
    if not height > 0:
        return 1.0, "metres (assumed: the skeleton has no two limbs to measure)"
    name = min(UNITS, key=lambda name: abs(np.log(height * UNITS[name] / ADULT)))
    tall = height * UNITS[name]
    note = f"{name} (guessed: the skeleton would stand about {tall:.1f} m tall"
    if not is_plausible(tall):
        note += ", which no grown person does; give the unit"
    return UNITS[name], note + ")"
