"""The rig of a motion: where its skeleton has the twenty joints, found by names.

The user's names come first, then those of the common rig that fits best. When names are compared,
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
from functools import cached_property, lru_cache
from itertools import product
from pathlib import Path

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.mocap.formats.text_file import TextFile
from numpy_cae.motion import JOINTS, Motion, Skeleton
from numpy_cae.motion.joints import SIDES

Names = dict[str, tuple[str, ...]]
"""For each of our joint names, the names that it may have in a rig, the usual one first."""

_LIMBS = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")


def _rig(trunk: str, limbs: str, sides: str, prefixes: str = "") -> Names:
    """The table of a rig."""
    trunk_names = trunk.split()
    joints = ("hips", "head") if len(trunk_names) == 2 else ("hips", "spine", "chest", "head")
    names = {joint: text.split("|") for joint, text in zip(joints, trunk_names, strict=True)}
    for side, patterns in zip(SIDES, sides.split(), strict=True):
        for joint, text in zip(_LIMBS, limbs.split(), strict=True):
            options = product(patterns.split("|"), text.split("|"))
            names[f"{side}_{joint}"] = [pattern.format(name) for pattern, name in options]
    table = {}
    for joint, alternatives in names.items():
        options = product(prefixes.split("|"), alternatives)
        table[joint] = tuple(prefix + name for prefix, name in options)
    return table


_FILE = Path(__file__).with_suffix(".json").read_text(encoding="utf-8")
RIGS: dict[str, Names] = {"numpy_cae": {joint: (joint,) for joint in JOINTS}}
RIGS |= {rig_name: _rig(**patterns) for rig_name, patterns in json.loads(_FILE).items()}
"""The common rigs by name."""


JointNames = dict[str, str]
"""Some of our joint names, each with the joint's name in a rig."""
Mappings = JointNames | Sequence[JointNames] | None
"""One mapping to the names in a rig, or several: each rig then takes the first one that fits."""


_NUMBER = re.compile(r"_\d{2,}$")
"""Converters add such a number to make names unique."""
_NEARLY_ALL = 0.9
"""The names of a skeleton are numbered if at least this part of them is; its root may have no
number."""


MOST_BYTES = 1 << 20
"""A longer file of a mapping is refused: twenty names take a kilobyte."""


class UnknownRigError(NumpyCaeError, ValueError):
    """Some of the twenty joints were not found in a skeleton, or its bones are not a person's."""


@dataclass(frozen=True)
class Rig:
    """Where a skeleton has the twenty joints.

    Parameters
    ----------
    indices : dict of str to int
        The index in the skeleton of each of `JOINTS` that was found.
    name : str
        The name in `RIGS` of the common rig that fits best.
    mapping : dict of str to str
        The names that the user, or else the hierarchy, gave some of the twenty joints.
    added : tuple of int
        Indices of the joints that the file lacks and that `add_missing_joints` added, the last ones
        of the skeleton.
    """

    indices: dict[str, int]
    name: str
    mapping: JointNames
    added: tuple[int, ...] = ()

    @cached_property
    def joints(self) -> list[int]:
        """The indices of the twenty joints in the skeleton, in the order of `JOINTS`; of a rig that
        lacks some, of those that were found."""
        return [self.indices[joint] for joint in JOINTS if joint in self.indices]


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
    """The rig of a skeleton, which may lack joints, by the user's names and those of common rigs.

    A skeleton fits a mapping if it has all names in it. If there are several mappings, the first
    one that fits is used, or none if none fits.
    """
    names = _NamesOf(skeleton)
    if not isinstance(mapping, dict):
        mapping = names.first_fitting(mapping or [])
    named = names.find(mapping)
    indices_in = {rig_name: names.find_plain(table) for rig_name, table in _PLAIN_RIGS.items()}
    # The rig with the fewest missing joints; if several are equal, the one with the most found.
    best = min(
        RIGS, key=lambda name: (len(RIGS[name]) - len(indices_in[name]), -len(indices_in[name]))
    )
    indices = {}
    for joint, index in indices_in[best].items():
        if joint not in mapping and index not in named.values():
            indices[joint] = index
    indices |= named
    add_trunk(skeleton, indices, set(mapping))
    return Rig(indices, best, mapping)


class _NamesOf:
    """The joints of a skeleton by name, as it is or plain."""

    def __init__(self, skeleton: Skeleton):
        self._exact = {name: index for index, name in enumerate(skeleton.names)}
        self._plain = _plain_names(skeleton)

    def index(self, name: str) -> int | None:
        """The index of the joint with a name; None if there is none."""
        return self._exact.get(name, self._plain.get(plain_name(name)))

    def first_fitting(self, mappings: Sequence[JointNames]) -> JointNames:
        """The first mapping of which the skeleton has all names, or an empty one."""
        for mapping in mappings:
            if all(self.index(name) is not None for name in mapping.values()):
                return mapping
        return {}

    def find(self, mapping: JointNames) -> dict[str, int]:
        """The indices of the joints of a mapping that the skeleton has."""
        indices = {}
        for joint, name in mapping.items():
            index = self.index(name)
            if index is not None:
                indices[joint] = index
        return indices

    def find_plain(self, table: Names) -> dict[str, int]:
        """The indices of the joints of a table of plain names, by the first of the alternatives
        that the skeleton has."""
        indices = {}
        for joint, alternatives in table.items():
            present = [name for name in alternatives if name in self._plain]
            if present:
                indices[joint] = self._plain[present[0]]
        return indices


def attach_rig(motion: Motion, rig: Rig) -> RiggedMotion:
    """The motion with a rig instead of the one that it may have."""
    parts = {field.name: getattr(motion, field.name) for field in fields(Motion)}
    return RiggedMotion(**parts, rig=rig)


def partial_rig_of(motion: Motion) -> Rig:
    """The rig of a motion, which may lack joints: its own, or else the one that names give."""
    return motion.rig if isinstance(motion, RiggedMotion) else _rig_by_names_alone(motion.skeleton)


@lru_cache(maxsize=8)
def _rig_by_names_alone(skeleton: Skeleton) -> Rig:
    """`rig_by_names`, kept for the last skeletons: a repair asks for its rig forty times."""
    return rig_by_names(skeleton)


def add_trunk(skeleton: Skeleton, indices: dict[str, int], named: set[str]) -> None:
    """Find chest and spine by hierarchy if they are missing or the collars begin above the chest,
    and put their indices into `indices`. A joint at the hips is no spine.

    The joints that the user `named` are not changed.
    """
    arms = _first_arm_joints(indices)
    if arms is None or "hips" not in indices:
        return
    left_path, right_path = (skeleton.path(arm) for arm in arms)
    carrier = next((joint for joint in left_path[1:] if joint in right_path[1:]), -1)
    ancestors = skeleton.path(carrier)[1:] if carrier >= 0 else []
    if "chest" not in named and indices.get("chest", indices["hips"]) in ancestors:
        indices["chest"] = carrier
        if "spine" not in named:
            indices.pop("spine", None)
    hips = indices["hips"]
    if "spine" not in named and "spine" in indices and _is_at(skeleton, indices["spine"], hips):
        indices.pop("spine")
    has_chest_alone = {"chest", "spine"} & (named | set(indices)) == {"chest"}
    if not has_chest_alone or hips not in ancestors:
        return
    between = ancestors[: ancestors.index(hips)]
    lengths = np.linalg.norm(skeleton.offsets, axis=-1)
    # Distance from the chest down to each joint in between, and to the hips.
    down = np.cumsum(lengths[[carrier, *between]])
    from_middle = np.abs(down[:-1] - down[-1] / 2)
    distances = dict(zip(between, from_middle, strict=True))
    above_hips = [joint for joint in between if not _is_at(skeleton, joint, hips)]
    if above_hips:
        indices["spine"] = min(above_hips, key=distances.__getitem__)


def _is_at(skeleton: Skeleton, joint: int, ancestor: int) -> bool:
    """Whether no bone between a joint and its ancestor has a length."""
    path = skeleton.path(joint)
    if ancestor not in path:
        return False
    bones = path[: path.index(ancestor)]
    return not skeleton.offsets[bones].any()


def _first_arm_joints(indices: dict[str, int]) -> tuple[int, int] | None:
    """The left and the right collar, or the shoulders if there is no left collar; None if one of
    the pair is missing."""
    joint = "collar" if "left_collar" in indices else "shoulder"
    left = indices.get(f"left_{joint}")
    right = indices.get(f"right_{joint}")
    if left is None or right is None:
        return None
    return left, right


def _plain_names(skeleton: Skeleton) -> dict[str, int]:
    """Plain name -> index of the first joint that has it, with and without what all names begin and
    end with, or the number that a converter added to nearly all of them."""
    names = list(skeleton.names)
    cores = names
    if sum(bool(_NUMBER.search(name)) for name in names) >= _NEARLY_ALL * len(names):
        cores = [_NUMBER.sub("", name) for name in names]
    begin = _common_words(cores)
    end = _common_words([name[::-1] for name in cores])
    cores = [name[begin : len(name) - end] for name in cores]
    plain: dict[str, int] = {}
    for forms in (cores, names):
        # In reverse order, so that the first joint with a name is set last.
        for joint, form in reversed(list(enumerate(forms))):
            plain[plain_name(form)] = joint
    return plain


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


def left_or_right(name: str, opposite: str) -> str:
    """The side of a joint by its name and that of the same joint on the opposite side, such as
    "lShldr" and "rShldr": "left" or "right", or "" if the names do not tell."""
    pairs = zip(name.lower(), opposite.lower(), strict=False)
    differing = next((a + b for a, b in pairs if a != b), "")
    return {"lr": "left", "rl": "right"}.get(differing, "")


def _plain_table(table: Names) -> Names:
    return {joint: tuple(map(plain_name, names)) for joint, names in table.items()}


_PLAIN_RIGS = {rig_name: _plain_table(table) for rig_name, table in RIGS.items()}


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
    MotionFileError
        If the file is no regular file, is longer than `MOST_BYTES` or is not text.
    UnknownRigError
        If the file is not such an object; the message says what is wrong.

    Examples
    --------
    >>> _ = Path("rig.json").write_text('{"hips": "pelvis", "head": "skull"}')
    >>> read_mapping("rig.json")
    {'hips': 'pelvis', 'head': 'skull'}
    """
    content = TextFile.read(path, MOST_BYTES).data
    try:
        mapping = json.loads(content)
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
