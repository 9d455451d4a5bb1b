"""Read an Acclaim skeleton (.asf): bones with a direction and a length, and their rotation axes.

The format is that of Schafer, Acclaim Skeleton File Definition V1.10 (1994), and of Vicon's notes
on it, as CMU's database uses them. Each bone has axes of its own, which the rotation C (its `axis`)
turns away from the world's. Its angles are about these axes:

    R_bone = C · R(angles) · C⁻¹

is the same rotation expressed in the world's axes. `Motion` needs this form, because in the rest
pose the local axes of all its joints are the world's. A joint here is named for its bone and is at
the bone's base: lfemur is at the hip, ltibia at the knee.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.mocap.formats.channels import Channels, JointChannels
from numpy_cae.mocap.formats.text_file import TextFile, quote
from numpy_cae.mocap.units import INCH, require_unit
from numpy_cae.motion.motion import Skeleton, depth_first
from numpy_cae.motion.quaternions import from_angles

_COMMENT = re.compile(r"(?<!\.)#.*")
"""A comment begins with #; the # of 1.#QNAN begins none."""
MAX_BYTES = 1_000_000
"""A longer .asf file is refused; those of CMU have 6,000 bytes."""
ANGLE_UNITS = {"deg": np.radians(1.0), "degrees": np.radians(1.0), "rad": 1.0, "radians": 1.0}
"""Radians in one unit of the angles of a file, by the name of the unit."""
_SEPARATORS = str.maketrans(",()", "   ")
_CUT_OFF = (
    "expected :bonedata with the end of each bone and :hierarchy: is the file cut off, or no .asf "
    "file?"
)
_ROOT_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz")


@dataclass
class _Block:
    """A section, or a bone from `begin` to `end`; `line` is its first line.

    `statements` are keyword -> (line number, words after the keyword).
    """

    file: TextFile
    line: int
    statements: dict[str, tuple[int, list[str]]]

    def words(self, keyword: str, default: str | None = None) -> tuple[int, list[str]]:
        """The statement with a keyword, or else `default`; MotionFileError if there is neither."""
        if keyword in self.statements:
            return self.statements[keyword]
        if default is None:
            raise self.file.error(self.line, f"the bone that begins here has no {keyword}")
        return self.line, default.split()

    def numbers(self, keyword: str, count: int, default: str | None = None) -> list[float]:
        """The `count` numbers of a statement."""
        return self.file.numbers(*self.words(keyword, default), count, keyword)

    def rotation(self, angles: list[float], order: list[str], angle_unit: float) -> np.ndarray:
        """The rotation by three angles about the world's x, y and z, applied in `order`."""
        letters = "".join(order).lower()
        if sorted(letters) != ["x", "y", "z"]:
            problem = f"axis order {quote(letters.upper())}, expected X, Y and Z, such as XYZ"
            raise self.file.error(self.words("axis", "")[0], problem)
        values = np.array([[angles["xyz".index(letter)] for letter in letters]])
        return from_angles(letters, angle_unit * values)[0]

    def tip(self, unit: float) -> np.ndarray:
        """The end of a bone, relative to its base."""
        return unit * self.numbers("length", 1)[0] * np.array(self.numbers("direction", 3))

    def bone_channels(self, unit: float, angle_unit: float) -> Channels:
        """The channels of a bone, about axes that its `axis` turns."""
        line, words = self.words("axis")
        axes = self.rotation(self.file.numbers(line, words[:3], 3, "axis"), words[3:], angle_unit)
        names = self.channels("dof", _ROOT_CHANNELS[3:], "")
        return Channels(names, unit, axes=axes, angle_unit=angle_unit)

    def root_channels(self, position: np.ndarray, unit: float, angle_unit: float) -> Channels:
        """The channels of the root, which an `orientation` turns; its translation is added to its
        preset position."""
        names = self.channels("order", _ROOT_CHANNELS, " ".join(_ROOT_CHANNELS))
        angles = self.numbers("orientation", 3, "0 0 0")
        turned = self.rotation(angles, self.words("axis", "XYZ")[1], angle_unit)
        return Channels(names, unit, position, orientation=turned, angle_unit=angle_unit)

    def channels(self, keyword: str, allowed: tuple[str, ...], default: str) -> tuple[str, ...]:
        """The channels of an `order` or `dof` statement; rotations are about fixed axes in this
        order."""
        line, words = self.words(keyword, default)
        names = tuple(word.lower() for word in words)
        if not set(names) <= set(allowed) or len(set(names)) < len(names):
            expected = f"expected each of {' '.join(allowed)} at most once: bones only rotate"
            raise self.file.error(line, f"{keyword} {quote(' '.join(words))}, {expected}")
        return names


def statements(file: TextFile, after: int = 0) -> Iterator[tuple[int, list[str]]]:
    """(line number, words) of each line below line `after`, without comments, which # begins."""
    for line, text in file.numbered_lines(after):
        words = (_COMMENT.sub("", text) if "#" in text else text).split()
        if words:
            yield line, words


def read_asf(path: str | Path, unit: float | None = None) -> tuple[Skeleton, JointChannels, float]:
    r"""Read an Acclaim skeleton.

    Parameters
    ----------
    path : path of the .asf file
    unit : float, optional
        Metres in one unit of the file. The default is 0.0254 / length: a value in the file
        divided by the `length` of `:units` is in inches.

    Returns
    -------
    skeleton : Skeleton
        In metres; its joint 0 is "root".
    channels : JointChannels
        Those of each joint in an .amc file; a rigid bone has none.
    unit : float
        Metres in one unit of the file.

    Raises
    ------
    MotionFileError
        If the file is damaged, or a bone may stretch or slide (dof l, tx, ty, tz).

    Examples
    --------
    A root and one bone, five inches long, that turns about x:

    >>> _ = Path("01.asf").write_text(
    ...     ":root\n position 0 0 0\n:bonedata\n"
    ...     "begin\n name arm\n direction 1 0 0\n length 5\n axis 0 0 0 XYZ\n dof rx\n end\n"
    ...     ":hierarchy\n root arm\n"
    ... )
    >>> skeleton, channels, unit = read_asf("01.asf")
    >>> skeleton.names, channels["arm"].names, unit
    (('root', 'arm'), ('rx',), 0.0254)
    """
    file = TextFile.read(path, MAX_BYTES)
    sections = _read_sections(file)
    units = _block(file, sections.get(":units", []))
    root = _block(file, sections.get(":root", []))
    unit = _unit_of(units) if unit is None else require_unit(unit)
    angle_unit = _angle_unit_of(units)
    bones = {"root": root} | _bones(file, sections[":bonedata"])
    parent_of = _parents(bones, sections[":hierarchy"])
    joints = list(parent_of)
    channels = {}
    tips = {"root": np.zeros(3)}
    for name in joints[1:]:
        channels[name] = bones[name].bone_channels(unit, angle_unit)
        tips[name] = bones[name].tip(unit)
    position = unit * np.array(root.numbers("position", 3, "0 0 0"))
    channels = {"root": root.root_channels(position, unit, angle_unit)} | channels
    return _make_skeleton(parent_of, position, tips), channels, unit


def _make_skeleton(
    parent_of: dict[str, str], position: np.ndarray, tips: dict[str, np.ndarray]
) -> Skeleton:
    """The skeleton of bones with these parents and tips; its root is at `position`."""
    joints = list(parent_of)
    offsets = np.array([position, *(tips[parent_of[name]] for name in joints[1:])])
    parents = (-1, *(joints.index(parent_of[name]) for name in joints[1:]))
    with_children = set(parent_of.values())
    end_sites = {
        joint: tips[name] for joint, name in enumerate(joints) if name not in with_children
    }
    return Skeleton(tuple(joints), parents, offsets, end_sites)


def _unit_of(units: _Block) -> float:
    """Metres in one unit of length."""
    (length,) = units.numbers("length", 1, "1")
    if length < 1e-9:
        line, _ = units.words("length")
        raise units.file.error(line, f"length {length:g}, expected a number above 0")
    return INCH / length


def _angle_unit_of(units: _Block) -> float:
    """Radians in one unit of the angles."""
    line, words = units.words("angle", "deg")
    angle_unit = ANGLE_UNITS.get(" ".join(words).lower())
    if angle_unit is None:
        raise units.file.error(line, f"angle {quote(' '.join(words))}, expected deg or rad")
    return angle_unit


_Lines = list[tuple[int, list[str]]]
"""The number and the words of each line of a section."""


def _read_sections(file: TextFile) -> dict[str, _Lines]:
    """The lines of each section, such as ":units"."""
    sections: dict[str, _Lines] = {}
    section: _Lines = []
    for line, statement in statements(file):
        words = " ".join(statement).translate(_SEPARATORS).split()
        if words and words[0].startswith(":"):
            section = sections.setdefault(words[0].lower(), [])
        elif words:
            section.append((line, words))
    if not {":bonedata", ":hierarchy"} <= set(sections):
        raise file.error(file.count, _CUT_OFF)
    return sections


def _block(file: TextFile, lines: _Lines) -> _Block:
    """The statements of a section."""
    return _Block(file, 0, {words[0].lower(): (line, words[1:]) for line, words in lines})


def _bones(file: TextFile, lines: _Lines) -> dict[str, _Block]:
    """The bones of `:bonedata` by name, each from `begin` to `end`."""
    blocks: list[_Block] = []
    for line, (word, *rest) in lines:
        keyword = word.lower()
        is_open = bool(blocks) and "end" not in blocks[-1].statements
        if (keyword == "begin") == is_open:
            expected = f"the end of the bone on line {blocks[-1].line}" if is_open else "begin"
            raise file.error(line, f"expected {expected}, found {quote(word)}")
        if keyword == "begin":
            blocks.append(_Block(file, line, {}))
        blocks[-1].statements[keyword] = line, rest
    if blocks and "end" not in blocks[-1].statements:
        raise file.error(blocks[-1].line, _CUT_OFF)
    bones: dict[str, _Block] = {}
    for block in blocks:
        name = " ".join(block.words("name")[1])
        if name in bones or name == "root":
            raise file.error(block.line, f"bone name {name!r} appears a second time")
        bones[name] = block
    return bones


def _parents(bones: dict[str, _Block], hierarchy: _Lines) -> dict[str, str]:
    """The parent of each bone in the lines of `:hierarchy`, depth first; "" of the root."""
    file = bones["root"].file
    parent_of = {"root": ""}
    children = defaultdict(list)
    for line, (parent, *names) in hierarchy:
        if not names and parent.lower() in ("begin", "end"):
            continue
        for place, name in enumerate((parent, *names)):
            if name not in bones or (place and name in parent_of):
                expected = "expected bones of :bonedata, each as a child of one other"
                raise file.error(line, f":hierarchy, {quote(name)}: {expected}")
            if place:
                parent_of[name] = parent
                children[parent].append(name)
    joints = depth_first("root", children)
    for name, bone in bones.items():
        if name not in joints:
            raise file.error(bone.line, f"bone {name!r} is not below the root")
    return {name: parent_of[name] for name in joints}
