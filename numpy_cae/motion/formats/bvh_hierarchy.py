"""The first half of a BVH file, HIERARCHY: joints in a tree, each with its own channels.

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

from numpy_cae.motion.formats.text_file import (
    MAX_JOINTS,
    MotionFileError,
    TextFile,
    quoted,
    whole_number,
)

CHANNELS = {
    f"{axis}{kind}".lower(): f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ"
}


@dataclass
class BvhJoint:
    """One ROOT or JOINT block that begins on `line`; vectors are in units of the file.

    `channels` are such as "Xposition" or "Zrotation", in the order of the file, and `tip` is the
    offset of the End Site.
    """

    name: str
    parent: int
    line: int
    offset: list[float] | None = None
    channels: list[str] | None = None
    tip: list[float] | None = None

    def __str__(self) -> str:
        return f"joint {self.name!r} (line {self.line})"


class _EndSite(BvhJoint):
    """An End Site block while it is open; its name is that of its joint."""

    def __str__(self) -> str:
        return f"the End Site of joint {self.name!r}"


def read_hierarchy(file: TextFile) -> tuple[list[BvhJoint], int]:
    """The joints, parents before children, and the number of the line MOTION.

    Raises MotionFileError if the block is not valid BVH.
    """
    blocks = _Blocks(file)
    for line, statement in _statements(file):
        blocks.line = line
        if statement.upper() == "MOTION":
            blocks.finish()
            return blocks.joints, line
        blocks.read(statement)
    still_open = f" while {blocks.open[-1]} is still open" if blocks.open else ""
    raise file.error(file.count, f"the file ends{still_open} without MOTION: is it cut off?")


def _statements(file: TextFile) -> Iterator[tuple[int, str]]:
    """(line number, statement); a brace is a statement wherever on a line it is."""
    started = False
    for line, text in file.numbered():
        for piece in re.split(r"([{}])", text):
            statement = piece.strip()
            if statement and started:
                yield line, statement
            elif statement and statement.upper() != "HIERARCHY":
                problem = "expected HIERARCHY, as every BVH file begins, found"
                raise file.error(line, f"{problem} {quoted(statement)}")
            started = started or bool(statement)


class _Blocks:
    """The tree while it is being read: the joints so far, the blocks that are open, and the one
    whose brace follows. `places` are the joints' by their names behind any colon."""

    def __init__(self, file: TextFile):
        self.file, self.line = file, 0
        self.joints: list[BvhJoint] = []
        self.places: dict[str, int] = {}
        self.open: list[BvhJoint] = []
        self.announced: BvhJoint | None = None

    def error(self, problem: str) -> MotionFileError:
        """An error about the present line."""
        return self.file.error(self.line, problem)

    def read(self, statement: str) -> None:
        """Process one statement."""
        keyword, value = [*statement.split(maxsplit=1), ""][:2]
        keyword = keyword.upper()
        if (self.announced is not None) != (keyword == "{"):
            self.require_no_brace_missing(statement)
        if self.announced is not None:
            self.open.append(self.announced)
            self.announced = None
        elif keyword == "}":
            self.close()
        elif keyword in ("ROOT", "JOINT"):
            self.open_joint(keyword, value)
        elif re.fullmatch(r"END\s*SITE\b.*", statement, re.IGNORECASE):
            self.open_end_site()
        elif keyword == "OFFSET":
            block = self.block("OFFSET")
            if block.offset is not None:
                raise self.error(f"a second OFFSET in {block}")
            block.offset = self.file.three_numbers(self.line, value.split(), "OFFSET")
        elif keyword == "CHANNELS":
            self.read_channels(value)
        else:
            expected = "ROOT, JOINT, End Site, OFFSET, CHANNELS, a brace or MOTION"
            problem = f"{quoted(statement)} means nothing in a BVH hierarchy, expected {expected}"
            raise self.error(problem)

    def require_no_brace_missing(self, statement: str) -> None:
        if statement == "{":
            raise self.error("'{' opens nothing: it follows ROOT, JOINT or End Site")
        if self.announced is not None:
            raise self.error(f"expected '{{', found {quoted(statement)}")

    def open_joint(self, keyword: str, name: str) -> None:
        parent = self.open[-1] if self.open else None
        if not name:
            raise self.error(f"{keyword} has no name")
        if len(self.joints) == MAX_JOINTS:
            raise self.error(f"the skeleton has more than {MAX_JOINTS} joints")
        if keyword == "ROOT" and self.joints:
            advice = "the file holds several skeletons, expected one; give each a file of its own"
            raise self.error(f"a second ROOT, {name!r}: {advice}")
        if keyword == "JOINT" and parent is None:
            raise self.error(f"JOINT {name!r} is outside ROOT: are there too many '}}' before it?")
        if isinstance(parent, _EndSite):
            raise self.error(f"{keyword} {name!r} cannot stand inside {parent}")
        plain = name.rsplit(":", 1)[-1]
        if plain in self.places:
            first = self.joints[self.places[plain]]
            raise self.error(
                f"joint name {name!r} appears a second time, first as {first.name!r} on line "
                f"{first.line}: expected every joint to have a name of its own behind any colon"
            )
        above = -1 if parent is None else self.places[parent.name.rsplit(":", 1)[-1]]
        self.places[plain] = len(self.joints)
        self.announced = BvhJoint(name, above, self.line)
        self.joints.append(self.announced)

    def open_end_site(self) -> None:
        block = self.block("End Site")
        if isinstance(block, _EndSite):
            raise self.error("End Site cannot stand inside End Site")
        if block.tip is not None:
            raise self.error(f"a second End Site in joint {block.name!r}, expected one at most")
        self.announced = _EndSite(block.name, block.parent, self.line)

    def read_channels(self, value: str) -> None:
        block = self.block("CHANNELS")
        if isinstance(block, _EndSite):
            raise self.error("an End Site has no CHANNELS")
        if block.channels is not None:
            raise self.error(f"a second CHANNELS in {block}")
        count, *names = value.split() or [""]
        for name in names:
            if name.lower() not in CHANNELS:
                known = ", ".join(CHANNELS.values())
                raise self.error(f"{quoted(name)} is no channel, expected {known}")
        block.channels = [CHANNELS[name.lower()] for name in names]
        if whole_number(count) != len(names):
            counts = f"CHANNELS says {quoted(count)} and names {len(names)}"
            raise self.error(f"{counts}, expected as many")
        if len(set(block.channels)) < len(names):
            raise self.error(f"CHANNELS names a channel twice: {' '.join(names)}")

    def close(self) -> None:
        if not self.open:
            raise self.error("'}' closes nothing: there are more '}' than '{'")
        block = self.open.pop()
        if block.offset is None:
            raise self.file.error(block.line, f"{block} has no OFFSET")
        if isinstance(block, _EndSite):
            self.open[-1].tip = block.offset

    def block(self, keyword: str) -> BvhJoint:
        """The innermost open block."""
        if not self.open:
            raise self.error(f"{keyword} is outside ROOT")
        return self.open[-1]

    def finish(self) -> None:
        """Check that everything is closed at MOTION."""
        if not self.joints:
            raise self.error("MOTION is before any ROOT")
        self.require_no_brace_missing("MOTION")
        if self.open:
            problem = f"{self.open[-1]} is still open: {len(self.open)} '}}' missing"
            raise self.error(f"MOTION comes while {problem}")
