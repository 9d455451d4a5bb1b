"""The rig of a motion: where its skeleton has the twenty joints, found by names.

The user's names come first, then those of the known rig that fits best. When names are compared,
case, blanks, punctuation and a prefix up to a colon ("mixamorig:Hips") do not matter. In every rig,
`chest` is the joint that carries the collars, and `spine` is the joint nearest to the middle
between hips and chest; both follow from the hierarchy if the names do not tell.

`RIGS` has common rigs: for each of our joint names the names that the joint may have in the rig.
`rigs.json` has a line for each rig, in which | separates alternatives:

- `trunk` has the names of hips and head, or of hips, spine, chest and head
- `limbs` has the names of the joints in `_LIMBS`
- `sides` has the patterns for left and right, such as "Left{} Right{}"
- `prefixes` has the prefixes that every name may have

Rigs of one family differ in their number of spine joints, so a table may have no spine or chest.
"""

import json
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import product
from pathlib import Path

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.motion import JOINTS, Motion, Skeleton

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


JointNames = dict[str, str]
"""Some of our joint names, each with the joint's name in a rig."""
Mappings = JointNames | Sequence[JointNames] | None
"""One mapping to the names in a rig, or several: each rig then takes the first one that fits."""


_NUMBER = re.compile(r"_\d{2,}$")
"""Converters add such a number to make names unique."""
_NEARLY_ALL = 0.9
"""The names of a skeleton are numbered if at least this part of them is; its root may have no
number."""


class UnknownRigError(NumpyCaeError, ValueError):
    """Some of the twenty joints were not found in a skeleton, or its bones are not a person's."""


@dataclass(frozen=True)
class Rig:
    """Where a skeleton has the twenty joints.

    Parameters
    ----------
    found : dict of str to int
        Of each of `JOINTS` that was found the index in the skeleton.
    known : str
        The known rig that fits best.
    given : dict of str to str
        The names that the user, or else the hierarchy, gave some of the twenty joints.
    added : tuple of int
        Indices of joints, the last ones of the skeleton, that the file lacks (`with_added_joints`).
    """

    found: dict[str, int]
    known: str
    given: JointNames
    added: tuple[int, ...] = ()

    @cached_property
    def joints(self) -> list[int]:
        """The indices of the twenty joints in the skeleton, in the order of `JOINTS`; of a rig that
        lacks some, of those that were found."""
        return [self.found[joint] for joint in JOINTS if joint in self.found]


@dataclass(frozen=True, repr=False, kw_only=True, eq=False)
class RiggedMotion(Motion):
    """A motion with its rig, and everything made of it by `dataclasses.replace`.

    Parameters
    ----------
    rig : Rig
        It may lack joints; `rig_of` refuses such a motion.
    """

    rig: Rig

    def __repr__(self) -> str:
        joints = len(self.skeleton.names) - len(self.rig.added)  # those that the file has
        return f"motion of {len(self)} frames at {self.rate:g} a second, {joints} joints"


def rig_by_names(skeleton: Skeleton, mapping: Mappings = None) -> Rig:
    """The rig of a skeleton, which may lack joints, by the user's names and those of known rigs.

    A skeleton fits a mapping if it has all names in it. If there are several mappings, the first
    one that fits is used, or none if none fits.
    """
    plain = _plain_names(skeleton)
    exact = {name: joint for joint, name in enumerate(skeleton.names)}

    def index(name: str) -> int | None:
        return exact.get(name, plain.get(plain_name(name)))

    if not isinstance(mapping, dict):
        fitting = (names for names in mapping or [] if None not in map(index, names.values()))
        mapping = next(fitting, {})
    present = {joint: at for joint, name in mapping.items() if (at := index(name)) is not None}
    # The alternatives are reversed, so that the first one that the skeleton has is set last.
    present_in = {
        rig: {j: plain[n] for j, names in table.items() for n in names[::-1] if n in plain}
        for rig, table in _PLAIN_RIGS.items()
    }
    # The rig with the fewest missing joints; if several are equal, the one with the most found.
    best = min(RIGS, key=lambda rig: (len(RIGS[rig]) - len(present_in[rig]), -len(present_in[rig])))
    free = {j: at for j, at in present_in[best].items() if at not in present.values()}
    found = {joint: at for joint, at in free.items() if joint not in mapping} | present
    add_trunk(skeleton, found, set(mapping))
    return Rig(found, best, mapping)


def with_rig(motion: Motion, rig: Rig) -> RiggedMotion:
    """The motion with a rig instead of the one that it may have."""
    parts = {field.name: getattr(motion, field.name) for field in fields(Motion)}
    return RiggedMotion(**parts, rig=rig)


def own_rig(motion: Motion) -> Rig:
    """The rig of a motion, which may lack joints: its own, or else the one that names give."""
    return motion.rig if isinstance(motion, RiggedMotion) else rig_by_names(motion.skeleton)


def add_trunk(skeleton: Skeleton, found: dict[str, int], named: set[str]) -> None:
    """Find chest and spine by hierarchy if they are missing or the collars begin above the chest.

    The joints that the user `named` are not changed.
    """
    arms = next((f"{{}}_{arm}" for arm in ("collar", "shoulder") if f"left_{arm}" in found), None)
    if arms is None or arms.format("right") not in found or "hips" not in found:
        return
    left, right = (skeleton.path(found[arms.format(side)]) for side in ("left", "right"))
    carrier = next((joint for joint in left[1:] if joint in right[1:]), -1)
    ancestors = skeleton.path(carrier)[1:] if carrier >= 0 else []
    if "chest" not in named and found.get("chest", found["hips"]) in ancestors:
        found["chest"] = carrier
        if "spine" not in named:
            found.pop("spine", None)
    if {"chest", "spine"} & (named | set(found)) != {"chest"} or found["hips"] not in ancestors:
        return
    between = ancestors[: ancestors.index(found["hips"])]
    if between:
        lengths = np.linalg.norm(skeleton.offsets, axis=-1)
        # Distance from the chest down to each joint in between, and to the hips.
        down = np.cumsum(lengths[[carrier, *between]])
        found["spine"] = between[int(np.argmin(np.abs(down[:-1] - down[-1] / 2)))]


def _plain_names(skeleton: Skeleton) -> dict[str, int]:
    """Plain name -> index of the first joint that has it, with and without what all names begin and
    end with, or the number that a converter added to nearly all of them."""
    names = list(skeleton.names)
    numbered = sum(bool(_NUMBER.search(name)) for name in names) >= _NEARLY_ALL * len(names)
    cores = [_NUMBER.sub("", name) if numbered else name for name in names]
    begin = _common_words(cores)
    end = _common_words([name[::-1] for name in cores])
    cores = [name[begin : len(name) - end] for name in cores]
    known: dict[str, int] = {}
    for forms in (cores, names):
        known |= {plain_name(form): joint for joint, form in reversed(list(enumerate(forms)))}
    return known


def _common_words(texts: list[str]) -> int:
    """The length of the whole words, each with its separator, with which all texts begin."""
    first, last = min(texts), max(texts)
    pairs = zip(first, last, strict=False)
    same = next((n for n, (a, b) in enumerate(pairs) if a != b), min(len(first), len(last)))
    return len(re.sub(r"[^\s_.\-]*$", "", first[:same]))


def plain_name(name: str) -> str:
    """The name without case, blanks, punctuation and a prefix up to a colon."""
    name = name.rsplit(":", 1)[-1].lower()
    return re.sub(r"[\s_.\-]", "", name) or name


def left_or_right(one: str, other: str) -> str:
    """The side of joint `one` by its name and that of the same joint on the other side, such as
    "lShldr" and "rShldr": "left" or "right", or "" if the names do not tell."""
    pairs = zip(one.lower(), other.lower(), strict=False)
    differing = next((a + b for a, b in pairs if a != b), "")
    return {"lr": "left", "rl": "right"}.get(differing, "")


_PLAIN_RIGS = {
    rig: {joint: tuple(map(plain_name, names)) for joint, names in table.items()}
    for rig, table in RIGS.items()
}


def read_mapping(path: str | Path) -> JointNames:
    """Read a user's names of joints, a JSON object of {our joint name: name in the file}.

    Parameters
    ----------
    path : path of the file

    Returns
    -------
    dict of str to str

    Raises
    ------
    UnknownRigError
        If the file is not such an object; the message says what is wrong.

    Examples
    --------
    >>> _ = Path("rig.json").write_text('{"hips": "pelvis", "head": "skull"}')
    >>> read_mapping("rig.json")
    {'hips': 'pelvis', 'head': 'skull'}
    """
    try:
        mapping = json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise UnknownRigError(f"{path}: not JSON: {error}") from None
    if not isinstance(mapping, dict) or not all(isinstance(v, str) for v in mapping.values()):
        raise UnknownRigError(f'{path}: expected an object such as {{"hips": "pelvis", …}}')
    unknown = sorted(set(mapping) - set(JOINTS))
    if unknown:
        problem = f"not among the twenty joints: {', '.join(unknown)}; they are {', '.join(JOINTS)}"
        raise UnknownRigError(f"{path}: {problem}")
    twice = sorted(name for name, count in Counter(mapping.values()).items() if count > 1)
    if twice:
        problem = f"{', '.join(twice)} stands for several joints; leave out a joint that the rig"
        raise UnknownRigError(f"{path}: {problem} lacks")
    return mapping
