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

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from numpy_cae.motion.io.text_file import TextFile, shortened, whole_number

CHANNELS = {
    f"{axis}{kind}".lower(): f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ"
}


@dataclass
class BvhJoint:
    """One ROOT or JOINT block.

    Parameters
    ----------
    name : str
    parent : int
        -1 for the root.
    line : int
        Where the block begins.
    offset : list of 3 float
        In units of the file.
    channels : list of str
        Such as "Xposition" or "Zrotation", in the order of the file.
    tip : list of 3 float or None
        The offset of the End Site.
    """

    name: str
    parent: int
    line: int
    offset: list[float] | None = None
    channels: list[str] | None = None
    tip: list[float] | None = None


@dataclass
class _EndSite:
    """An End Site block while it is open."""

    line: int
    offset: list[float] | None = None


def read_hierarchy(file: TextFile) -> tuple[list[BvhJoint], int]:
    """The joints, parents before children, and the number of the line that says MOTION.

    Raises
    ------
    MotionFileError
        Wherever the block does not say what BVH says.
    """
    blocks = _Blocks(file)
    for line, statement in _statements(file):
        if statement.upper() == "MOTION":
            blocks.finish(line)
            return blocks.joints, line
        blocks.take(line, statement)
    still_open = f" while {blocks.opened()} is still open" if blocks.stack else ""
    raise file.error(file.count, f"the file ends{still_open} without MOTION: is it cut off?")


def _statements(file: TextFile) -> Iterator[tuple[int, str]]:
    """(line number, statement) for each, braces being statements wherever on a line they stand."""
    started = False
    for line, text in file.numbered():
        for piece in re.split(r"([{}])", text):
            statement = piece.strip()
            if not statement:
                continue
            if started:
                yield line, statement
            elif statement.upper() != "HIERARCHY":
                raise file.error(
                    line,
                    f"expected HIERARCHY, as every BVH file begins, found {shortened(statement)}",
                )
            started = True


class _Blocks:
    """The tree while it is being read: the joints so far and the blocks that are open."""

    def __init__(self, file: TextFile):
        self.file = file
        self.joints: list[BvhJoint] = []
        self.lines: dict[str, int] = {}
        self.stack: list[int | _EndSite] = []
        self.awaited: int | _EndSite | None = None

    def take(self, line: int, statement: str) -> None:
        """Take in one statement."""
        keyword, *rest = statement.split(maxsplit=1)
        value = rest[0] if rest else ""
        keyword = keyword.upper()
        if (self.awaited is not None) != (keyword == "{"):
            self.refuse_brace(line, statement)
        if keyword == "{":
            self.stack.append(self.awaited)
            self.awaited = None
        elif keyword == "}":
            self.close(line)
        elif keyword in ("ROOT", "JOINT"):
            self.open_joint(line, keyword, value)
        elif re.fullmatch(r"END\s*SITE\b.*", statement, re.IGNORECASE):
            self.open_end_site(line)
        elif keyword == "OFFSET":
            self.take_offset(line, value)
        elif keyword == "CHANNELS":
            self.take_channels(line, value)
        else:
            raise self.file.error(
                line,
                f"{shortened(statement)} means nothing in a BVH hierarchy, expected ROOT, JOINT, "
                "End Site, OFFSET, CHANNELS, a brace or MOTION",
            )

    def refuse_brace(self, line: int, statement: str) -> None:
        if statement == "{":
            raise self.file.error(line, "'{' opens nothing: it follows ROOT, JOINT or End Site")
        raise self.file.error(line, f"expected '{{', found {shortened(statement)}")

    def open_joint(self, line: int, keyword: str, name: str) -> None:
        if not name:
            raise self.file.error(line, f"{keyword} has no name")
        if keyword == "ROOT" and self.joints:
            raise self.file.error(
                line,
                f"a second ROOT, {name!r}: the file holds several skeletons, expected one; give "
                "each a file of its own",
            )
        if keyword == "JOINT" and not self.stack:
            raise self.file.error(
                line, f"JOINT {name!r} stands outside ROOT: are there too many '}}' before it?"
            )
        if isinstance(self.stack[-1] if self.stack else None, _EndSite):
            raise self.file.error(line, f"{keyword} {name!r} cannot stand inside {self.opened()}")
        if name in self.lines:
            raise self.file.error(
                line,
                f"joint name {name!r} stands a second time, first on line {self.lines[name]}: "
                "expected every joint to have a name of its own",
            )
        self.lines[name] = line
        self.awaited = len(self.joints)
        self.joints.append(BvhJoint(name, self.stack[-1] if self.stack else -1, line))

    def open_end_site(self, line: int) -> None:
        block = self.block(line, "End Site")
        if isinstance(block, _EndSite):
            raise self.file.error(line, "End Site cannot stand inside End Site")
        if block.tip is not None:
            raise self.file.error(
                line, f"a second End Site in joint {block.name!r}, expected one at most"
            )
        self.awaited = _EndSite(line)

    def take_offset(self, line: int, value: str) -> None:
        block = self.block(line, "OFFSET")
        if block.offset is not None:
            raise self.file.error(line, f"a second OFFSET in {self.opened()}")
        block.offset = self.file.three_numbers(line, value.split(), "OFFSET")

    def take_channels(self, line: int, value: str) -> None:
        block = self.block(line, "CHANNELS")
        if isinstance(block, _EndSite):
            raise self.file.error(line, "an End Site has no CHANNELS")
        if block.channels is not None:
            raise self.file.error(line, f"a second CHANNELS in {self.opened()}")
        count, *names = value.split() or [""]
        for name in names:
            if name.lower() not in CHANNELS:
                raise self.file.error(
                    line,
                    f"{shortened(name)} is no channel, expected {', '.join(CHANNELS.values())}",
                )
        block.channels = [CHANNELS[name.lower()] for name in names]
        if whole_number(count) != len(names):
            raise self.file.error(
                line,
                f"CHANNELS says {shortened(count)} and names {len(names)}, expected as many",
            )
        if len(set(block.channels)) < len(names):
            raise self.file.error(line, f"CHANNELS names a channel twice: {' '.join(names)}")

    def close(self, line: int) -> None:
        if not self.stack:
            raise self.file.error(line, "'}' closes nothing: there are more '}' than '{'")
        closing = self.opened()
        block = self.block(line, "}")
        if block.offset is None:
            raise self.file.error(block.line, f"{closing} has no OFFSET")
        self.stack.pop()
        if isinstance(block, _EndSite):
            self.joints[self.stack[-1]].tip = block.offset

    def block(self, line: int, keyword: str) -> BvhJoint | _EndSite:
        """The innermost open block."""
        if not self.stack:
            raise self.file.error(line, f"{keyword} stands outside ROOT")
        inner = self.stack[-1]
        return inner if isinstance(inner, _EndSite) else self.joints[inner]

    def opened(self) -> str:
        """The innermost open block, for a message."""
        block = self.block(0, "")
        if isinstance(block, _EndSite):
            return f"the End Site of joint {self.joints[self.stack[-2]].name!r}"
        return f"joint {block.name!r} (line {block.line})"

    def finish(self, line: int) -> None:
        """Everything must be closed when MOTION comes."""
        if not self.joints:
            raise self.file.error(line, "MOTION stands before any ROOT")
        if self.awaited is not None:
            self.refuse_brace(line, "MOTION")
        if self.stack:
            raise self.file.error(
                line,
                f"MOTION comes while {self.opened()} is still open: {len(self.stack)} '}}' missing",
            )
