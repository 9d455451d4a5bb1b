"""The names of joints in common rigs.

The table of a rig gives for each of our joint names the names that the joint may have in the rig.
`rig_names.json` has a line for each rig, in which | separates alternatives:

- `trunk` has the names of hips and head, or of hips, spine, chest and head
- `limbs` has the names of the joints in `_LIMBS`
- `sides` has the patterns for left and right, such as "Left{} Right{}"
- `prefixes` has the prefixes that every name may have

Rigs of one family differ in their number of spine joints. If a table has no spine or chest, they
are found by hierarchy (`numpy_cae.mocap.rigs.rigs`). Blanks and punctuation in names do not
matter.
"""

import json
from itertools import product
from pathlib import Path

from numpy_cae.motion.joints import JOINTS

Names = dict[str, tuple[str, ...]]
"""For each of our joint names, the names that it may have in a rig, the usual one first."""

_LIMBS = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")


def _rig(trunk: str, limbs: str, sides: str, prefixes: str = "") -> Names:
    """The table of a rig."""
    trunk_names = trunk.split()
    joints = ("hips", "head") if len(trunk_names) == 2 else ("hips", "spine", "chest", "head")
    names = {joint: text.split("|") for joint, text in zip(joints, trunk_names, strict=True)}
    for side, patterns in zip(("left", "right"), sides.split(), strict=True):
        for joint, text in zip(_LIMBS, limbs.split(), strict=True):
            options = product(patterns.split("|"), text.split("|"))
            names[f"{side}_{joint}"] = [pattern.format(name) for pattern, name in options]
    return {
        joint: tuple(prefix + name for prefix, name in product(prefixes.split("|"), text))
        for joint, text in names.items()
    }


_KNOWN = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))
RIGS: dict[str, Names] = {
    "numpy_cae": {joint: (joint,) for joint in JOINTS},
    **{rig: _rig(**patterns) for rig, patterns in _KNOWN.items()},
}
