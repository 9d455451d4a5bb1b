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

from numpy_cae.motion.io.text_file import MAX_JOINTS, TextFile, quoted, whole_number

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


@dataclass
class _EndSite:
    """An End Site block while it is open."""

    joint: BvhJoint
    line: int
    offset: list[float] | None = None

    def __str__(self) -> str:
        return f"the End Site of joint {self.joint.name!r}"


def read_hierarchy(file: TextFile) -> tuple[list[BvhJoint], int]:
    """The joints, parents before children, and the number of the line MOTION.

    Raises MotionFileError if the block is not valid BVH.
    """
    blocks = _Blocks(file)
    for line, statement in _statements(file):
        if statement.upper() == "MOTION":
            blocks.finish(line)
            return blocks.joints, line
        blocks.read(line, statement)
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
                raise file.error(
                    line,
                    f"expected HIERARCHY, as every BVH file begins, found {quoted(statement)}",
                )
            started = started or bool(statement)


class _Blocks:
    """The tree while it is being read: the joints so far and the blocks that are open."""

    def __init__(self, file: TextFile):
        self.file = file
        self.joints: list[BvhJoint] = []
        self.indices: dict[str, int] = {}
        self.plain: dict[str, int] = {}
        self.open: list[BvhJoint | _EndSite] = []
        self.announced: BvhJoint | _EndSite | None = None

    def read(self, line: int, statement: str) -> None:
        """Process one statement."""
        keyword, *rest = statement.split(maxsplit=1)
        value = rest[0] if rest else ""
        keyword = keyword.upper()
        if (self.announced is not None) != (keyword == "{"):
            self.require_no_brace_missing(line, statement)
        if self.announced is not None:
            self.open.append(self.announced)
            self.announced = None
        elif keyword == "}":
            self.close(line)
        elif keyword in ("ROOT", "JOINT"):
            self.open_joint(line, keyword, value)
        elif re.fullmatch(r"END\s*SITE\b.*", statement, re.IGNORECASE):
            self.open_end_site(line)
        elif keyword == "OFFSET":
            block = self.block(line, "OFFSET")
            if block.offset is not None:
                raise self.file.error(line, f"a second OFFSET in {block}")
            block.offset = self.file.three_numbers(line, value.split(), "OFFSET")
        elif keyword == "CHANNELS":
            self.read_channels(line, value)
        else:
            raise self.file.error(
                line,
                f"{quoted(statement)} means nothing in a BVH hierarchy, expected ROOT, JOINT, "
                "End Site, OFFSET, CHANNELS, a brace or MOTION",
            )

    def require_no_brace_missing(self, line: int, statement: str) -> None:
        if statement == "{":
            raise self.file.error(line, "'{' opens nothing: it follows ROOT, JOINT or End Site")
        if self.announced is not None:
            raise self.file.error(line, f"expected '{{', found {quoted(statement)}")

    def open_joint(self, line: int, keyword: str, name: str) -> None:
        parent = self.open[-1] if self.open else None
        problem = None
        if not name:
            problem = f"{keyword} has no name"
        elif len(self.joints) == MAX_JOINTS:
            problem = f"the skeleton has more than {MAX_JOINTS} joints"
        elif keyword == "ROOT" and self.joints:
            problem = (
                f"a second ROOT, {name!r}: the file holds several skeletons, expected one; give "
                "each a file of its own"
            )
        elif keyword == "JOINT" and parent is None:
            problem = f"JOINT {name!r} is outside ROOT: are there too many '}}' before it?"
        elif isinstance(parent, _EndSite):
            problem = f"{keyword} {name!r} cannot stand inside {parent}"
        elif name.rsplit(":", 1)[-1] in self.plain:
            first = self.joints[self.plain[name.rsplit(":", 1)[-1]]]
            problem = (
                f"joint name {name!r} appears a second time, first as {first.name!r} on line "
                f"{first.line}: expected every joint to have a name of its own behind any colon"
            )
        if problem is not None:
            raise self.file.error(line, problem)
        self.indices[name] = self.plain[name.rsplit(":", 1)[-1]] = len(self.joints)
        above = self.indices[parent.name] if isinstance(parent, BvhJoint) else -1
        self.announced = BvhJoint(name, above, line)
        self.joints.append(self.announced)

    def open_end_site(self, line: int) -> None:
        block = self.block(line, "End Site")
        if isinstance(block, _EndSite):
            raise self.file.error(line, "End Site cannot stand inside End Site")
        if block.tip is not None:
            problem = f"a second End Site in joint {block.name!r}, expected one at most"
            raise self.file.error(line, problem)
        self.announced = _EndSite(block, line)

    def read_channels(self, line: int, value: str) -> None:
        block = self.block(line, "CHANNELS")
        if isinstance(block, _EndSite):
            raise self.file.error(line, "an End Site has no CHANNELS")
        if block.channels is not None:
            raise self.file.error(line, f"a second CHANNELS in {block}")
        count, *names = value.split() or [""]
        for name in names:
            if name.lower() not in CHANNELS:
                problem = f"{quoted(name)} is no channel, expected {', '.join(CHANNELS.values())}"
                raise self.file.error(line, problem)
        block.channels = [CHANNELS[name.lower()] for name in names]
        if whole_number(count) != len(names):
            problem = f"CHANNELS says {quoted(count)} and names {len(names)}, expected as many"
            raise self.file.error(line, problem)
        if len(set(block.channels)) < len(names):
            raise self.file.error(line, f"CHANNELS names a channel twice: {' '.join(names)}")

    def close(self, line: int) -> None:
        if not self.open:
            raise self.file.error(line, "'}' closes nothing: there are more '}' than '{'")
        block = self.open.pop()
        if block.offset is None:
            raise self.file.error(block.line, f"{block} has no OFFSET")
        if isinstance(block, _EndSite):
            block.joint.tip = block.offset

    def block(self, line: int, keyword: str) -> BvhJoint | _EndSite:
        """The innermost open block."""
        if not self.open:
            raise self.file.error(line, f"{keyword} is outside ROOT")
        return self.open[-1]

    def finish(self, line: int) -> None:
        """Check that everything is closed at MOTION."""
        if not self.joints:
            raise self.file.error(line, "MOTION is before any ROOT")
        self.require_no_brace_missing(line, "MOTION")
        if self.open:
            problem = f"{self.open[-1]} is still open: {len(self.open)} '}}' missing"
            raise self.file.error(line, f"MOTION comes while {problem}")
