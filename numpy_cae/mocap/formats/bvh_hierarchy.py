"""The first half of a BVH file, HIERARCHY: joints in a tree, each with its own channels.

Lines that begin with none of the format's words, such as comments, are skipped and counted.

HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  { ...
    End Site
    {
      OFFSET 0 10 0
    }
  }
}
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from numpy_cae.mocap.formats.text_file import MAX_JOINTS, TextFile, quoted, whole_number
from numpy_cae.motion.motion import Note

CHANNELS = {f"{axis}position": f"t{axis}" for axis in "XYZ"}
CHANNELS |= {f"{axis}rotation": f"r{axis}" for axis in "XYZ"}
"""CHANNELS: usual spelling of each channel -> its name in `Channels`. Files differ in case."""
_LOWER_CASE = {name.lower(): short for name, short in CHANNELS.items()}
_KEYWORDS = {"HIERARCHY", "ROOT", "JOINT", "OFFSET", "CHANNELS", "End Site", "MOTION", "{", "}"}
_BRACKETS = str.maketrans("[]()", "    ")
_COMMA = str.maketrans(",", " ")
"""_BRACKETS, _COMMA: what scripts write around and between the numbers of a vector."""
_SKIPPABLE = re.compile(r"[^-+.\d{}][^{}]*")
"""_SKIPPABLE: a line that may be skipped has no brace and is no row of numbers."""


@dataclass
class BvhJoint:
    """A ROOT or JOINT block that begins on `line`, or an End Site; vectors are in the file's unit.

    `parent` is the index of the parent joint, or of the joint that an End Site ends. `channels` are
    names such as "tX" or "rZ", in the order of the file. `tip` is the offset of the joint's End
    Site, of the first if a hand has one for each finger.
    """

    name: str
    parent: int
    line: int
    offset: list[float] | None = None
    channels: list[str] | None = None
    tip: list[float] | None = None
    is_end_site: bool = False

    @property
    def may_follow(self) -> list[str]:
        """The statements that may follow inside the block; "}" may follow only after OFFSET."""
        keywords = ["OFFSET" if self.offset is None else "}"]
        if not self.is_end_site:
            keywords += ["CHANNELS"] * (self.channels is None) + ["JOINT", "End Site"]
        return keywords


def read_hierarchy(file: TextFile) -> tuple[list[BvhJoint], int, list[Note]]:
    """The joints, parents before children, the number of the line MOTION, and a note if lines were
    skipped.

    Raises MotionFileError if the block is not valid BVH.
    """
    tree = _Tree(file)
    skipped: list[int] = []
    for line, keyword, value in _statements(file, skipped):
        tree.require_expected(line, keyword, value)
        if keyword == "MOTION":
            lines = f"{len(skipped)} unknown line{'s' * (len(skipped) > 1)} of the hierarchy"
            text = f"skipped {lines}, first line {skipped[0]}" if skipped else ""
            return tree.joints, line, [Note("skipped lines", text)] if skipped else []
        tree.add(line, keyword, value)
    raise file.error(file.count, f"the file ends{tree.place} without MOTION: is it cut off?")


class _Tree:
    """The joints that have been read, and the blocks that are open, the root's first.

    `announced` is the block whose { must follow; `indices` are those of the joints by their names
    without prefix.
    """

    def __init__(self, file: TextFile):
        self.file = file
        self.joints: list[BvhJoint] = []
        self.indices: dict[str, int] = {}
        self.blocks: list[BvhJoint] = []
        self.announced: BvhJoint | None = None

    @property
    def place(self) -> str:
        """The block that is open, for an error."""
        return f" in {self.blocks[-1].name!r} (line {self.blocks[-1].line})" if self.blocks else ""

    def require_expected(self, line: int, keyword: str, value: str) -> None:
        """Raise MotionFileError unless a statement with this keyword may follow here."""
        if self.announced is not None:
            expected = ["{"]
        elif self.blocks:
            expected = self.blocks[-1].may_follow
        else:
            expected = ["MOTION"] if self.joints else ["ROOT"]
        if keyword == "ROOT" and self.joints and not self.blocks:
            problem = f"a second ROOT, {quoted(value)}: a file may hold one skeleton; delete this"
            raise self.file.error(line, f"{problem} one and its columns of values")
        if keyword not in expected:
            found = quoted(f"{keyword} {value}".strip())
            problem = f"expected {' or '.join(expected)}{self.place}, found {found}"
            raise self.file.error(line, problem)

    def add(self, line: int, keyword: str, value: str) -> None:
        """Add what a statement says to the joints."""
        if keyword == "{" and self.announced is not None:
            self.blocks.append(self.announced)
            self.announced = None
        elif keyword == "}":
            block = self.blocks.pop()
            if block.is_end_site:
                self.joints[block.parent].tip = self.joints[block.parent].tip or block.offset
        elif keyword == "OFFSET":
            words = [word.strip(",") for word in value.translate(_BRACKETS).split()]
            words = words if len(words) == 3 else value.translate(_BRACKETS | _COMMA).split()
            self.blocks[-1].offset = self.file.numbers(line, words, 3, "OFFSET")
        elif keyword == "CHANNELS":
            self.blocks[-1].channels = _channels(self.file, line, value)
        elif keyword == "End Site":
            joint = self.blocks[-1].name
            parent = self.indices[_plain(joint)]
            self.announced = BvhJoint(f"End Site of {joint}", parent, line, is_end_site=True)
        else:
            self._announce_joint(line, keyword, value)

    def _announce_joint(self, line: int, keyword: str, name: str) -> None:
        parent = self.indices[_plain(self.blocks[-1].name)] if self.blocks else -1
        if not name or _plain(name) in self.indices:
            problem = "expected a name that is unique without its prefix up to a colon"
            raise self.file.error(line, f"{keyword} {name!r}: {problem}")
        if len(self.joints) == MAX_JOINTS:
            raise self.file.error(line, f"the skeleton has more than {MAX_JOINTS} joints")
        self.announced = BvhJoint(name, parent, line)
        self.indices[_plain(name)] = len(self.joints)
        self.joints.append(self.announced)


def _statements(file: TextFile, skipped: list[int]) -> Iterator[tuple[int, str, str]]:
    """(line number, keyword, value) of each statement; a brace is one anywhere in a line.

    The numbers of the lines that hold no statement are added to `skipped`.
    """
    started = False
    for line, text in file.numbered():
        for statement in filter(None, map(str.strip, re.split(r"([{}])", text))):
            keyword, value = [*statement.split(maxsplit=1), ""][:2]
            if not started and statement.upper() != "HIERARCHY":
                problem = "expected HIERARCHY, as every BVH file begins, found"
                raise file.error(line, f"{problem} {quoted(statement)}")
            if re.match(r"END\s*SITE\b", statement, re.IGNORECASE):
                yield line, "End Site", ""
            elif keyword.upper() not in _KEYWORDS and _SKIPPABLE.fullmatch(text.strip()):
                skipped.append(line)
            elif started:
                yield line, keyword.upper(), value
            started = True


def _channels(file: TextFile, line: int, value: str) -> list[str]:
    count, *names = value.split() or [""]
    channels = [_LOWER_CASE.get(name.lower(), "") for name in names]
    if "" in channels or len(set(channels)) < len(names) or whole_number(count) != len(names):
        expected = f"the number of channels and different names of {', '.join(CHANNELS)}"
        raise file.error(line, f"CHANNELS {quoted(value)}: expected {expected}")
    return channels


def _plain(name: str) -> str:
    """The part of a name after the last colon; the whole name if there is none."""
    return name.rsplit(":", 1)[-1]
