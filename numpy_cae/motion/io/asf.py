"""Read an Acclaim skeleton (.asf): bones with a direction and a length, and their rotation axes.

Schafer, Acclaim Skeleton File Definition V1.10 (1994), and Vicon's notes on it, as CMU's database
uses them. A bone's angles are about axes of its own, rotated by C (its `axis`) from the world's:

    R_bone = C · R(angles) · C⁻¹

which is a rotation in the world's axes of the rest pose, the axes that `Motion` has in every
joint. A joint here is named for its bone and is at the bone's base: lfemur at the hip, ltibia
at the knee.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.io.text_file import TextFile, quoted
from numpy_cae.motion.io.units import INCH, require_unit
from numpy_cae.motion.skeleton import Skeleton

ROOT_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz")


@dataclass(frozen=True)
class AcclaimSkeleton:
    """The content of an .asf file.

    Parameters
    ----------
    skeleton : Skeleton
        In metres; joint 0 is "root".
    channels : tuple of J tuples of str
        The order of each joint's values in an .amc file: "rx", "ry", "rz", for the root also
        "tx", "ty", "tz". Rotations are about fixed axes in this order. Empty for a rigid bone.
    axes : tuple of J Rotation
        C of each bone; the identity for the root.
    orientation : Rotation
        The root's rotation is orientation · R.
    unit : float
        Metres in one unit of length of the file.
    degrees : bool
        Whether angles are in degrees, if the .amc file does not say.
    """

    skeleton: Skeleton
    channels: tuple[tuple[str, ...], ...]
    axes: tuple[Rotation, ...]
    orientation: Rotation
    unit: float
    degrees: bool

    @property
    def counts(self) -> dict[str, int]:
        """The number of channels of each joint that has any."""
        named = zip(self.skeleton.names, self.channels, strict=True)
        return {name: len(channels) for name, channels in named if channels}


@dataclass
class _Bone:
    line: int
    name: str = ""
    direction: list[float] | None = None
    length: float | None = None
    axis: tuple[list[float], str] | None = None
    channels: tuple[str, ...] = ()


def statements(file: TextFile, after: int = 0) -> Iterator[tuple[int, list[str]]]:
    """(line number, words) of the lines below a line; # begins a comment."""
    for line, text in file.numbered(after):
        words = text.partition("#")[0].split()
        if words:
            yield line, words


def read_asf(path: str | Path, unit: float | None = None) -> AcclaimSkeleton:
    """Read an Acclaim skeleton.

    Parameters
    ----------
    path : path of the .asf file
    unit : float, optional
        Metres in one unit of the file. By default 0.0254 / length, since a value divided by the
        `length` of `:units` is inches.

    Raises
    ------
    MotionFileError
        If the file is damaged, or a bone may stretch or slide (dof l, tx, ty, tz).
    """
    parts = _Parts(TextFile.read(path))
    parts.read()
    return parts.assemble(INCH / parts.length if unit is None else require_unit(unit))


@dataclass
class _Parts:
    """The sections of the file while it is being read, in the file's units."""

    file: TextFile
    length: float = 1.0
    degrees: bool = True
    order: tuple[str, ...] = ROOT_CHANNELS
    root_axis: str = "xyz"
    position: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    orientation: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    bones: dict[str, _Bone] = field(default_factory=dict)
    open_bone: _Bone | None = None
    children: dict[str, list[str]] = field(default_factory=dict)
    parent_lines: dict[str, int] = field(default_factory=dict)

    def read(self) -> None:
        """Read every section."""
        sections = {
            ":units": self.read_units,
            ":root": self.read_root,
            ":bonedata": self.read_bone,
            ":hierarchy": self.read_children,
        }
        seen, section = set(), ""
        separators = str.maketrans(",()", "   ")
        for line, words in statements(self.file):
            words = " ".join(words).translate(separators).split()
            if words and words[0].startswith(":"):
                section = words[0].lower()
                seen.add(section)
            elif words and section in sections:
                sections[section](line, words[0].lower(), words)
        for required in (":bonedata", ":hierarchy"):
            if required not in seen:
                raise self.file.error(
                    self.file.count,
                    f"the file ends without {required}: is it an .asf file, cut off?",
                )
        self.require_finished()

    def read_units(self, line: int, keyword: str, words: list[str]) -> None:
        if keyword == "length":
            numbers = self.file.numbers(line, words[1:])
            if len(numbers) != 1 or numbers[0] < 1e-9:
                raise self.file.error(line, "length of :units, expected one number above 0")
            self.length = numbers[0]
        elif keyword == "angle":
            unit = " ".join(words[1:]).lower()
            if unit not in ("deg", "rad", "degrees", "radians"):
                raise self.file.error(line, f"angle {quoted(unit)}, expected deg or rad")
            self.degrees = unit.startswith("deg")

    def read_root(self, line: int, keyword: str, words: list[str]) -> None:
        if keyword == "order":
            self.order = self.channels(line, words, ROOT_CHANNELS)
        elif keyword == "axis":
            self.root_axis = self.axis_order(line, " ".join(words[1:]))
        elif keyword in ("position", "orientation"):
            setattr(self, keyword, self.file.three_numbers(line, words[1:], keyword))

    def read_bone(self, line: int, keyword: str, words: list[str]) -> None:
        if keyword == "begin":
            self.require_finished()
            self.open_bone = _Bone(line)
            return
        bone = self.open_bone
        if bone is None:
            raise self.file.error(line, f"{quoted(words[0])} stands outside begin and end")
        if keyword == "end":
            self.finish_bone(bone)
        elif keyword == "name":
            bone.name = " ".join(words[1:])
        elif keyword == "direction":
            bone.direction = self.file.three_numbers(line, words[1:], keyword)
        elif keyword == "length":
            numbers = self.file.numbers(line, words[1:])
            if len(numbers) != 1:
                problem = f"length has {len(numbers)} values, expected one number"
                raise self.file.error(line, problem)
            bone.length = numbers[0]
        elif keyword == "axis":
            angles = self.file.three_numbers(line, words[1:4], keyword)
            bone.axis = angles, self.axis_order(line, " ".join(words[4:]))
        elif keyword == "dof":
            bone.channels = self.channels(line, words, ROOT_CHANNELS[3:])

    def finish_bone(self, bone: _Bone) -> None:
        for required in ("name", "direction", "length", "axis"):
            if getattr(bone, required) in (None, ""):
                raise self.file.error(bone.line, f"bone {bone.name!r} has no {required}")
        if bone.name in self.bones or bone.name == "root":
            raise self.file.error(bone.line, f"bone name {bone.name!r} stands a second time")
        self.bones[bone.name] = bone
        self.open_bone = None

    def require_finished(self) -> None:
        if self.open_bone is not None:
            name, line = self.open_bone.name, self.open_bone.line
            raise self.file.error(line, f"bone {name!r} begins here and has no end")

    def read_children(self, line: int, keyword: str, words: list[str]) -> None:
        if len(words) == 1 and keyword in ("begin", "end"):
            return
        self.require_finished()
        parent, *children = words
        for name in words:
            if name != "root" and name not in self.bones:
                problem = f":hierarchy names {name!r}, a bone that :bonedata lacks"
                raise self.file.error(line, problem)
        for child in children:
            if child == "root" or child in self.parent_lines:
                before = self.parent_lines.get(child)
                first = f", first on line {before}" if before else ": it is the root"
                raise self.file.error(line, f"{child!r} is hung a second time{first}")
            self.parent_lines[child] = line
        self.children.setdefault(parent, []).extend(children)

    def channels(self, line: int, words: list[str], known: tuple[str, ...]) -> tuple[str, ...]:
        """The channels of an `order` or `dof` statement."""
        keyword, *channels = (word.lower() for word in words)
        for channel in channels:
            if channel not in known:
                reason = "is unknown"
                if channel in ("l", *ROOT_CHANNELS):
                    reason = "is not supported: bones here neither stretch nor slide"
                raise self.file.error(
                    line, f"{keyword} {quoted(channel)} {reason}; expected {' '.join(known)}"
                )
        if len(set(channels)) < len(channels):
            problem = f"{keyword} names a channel twice: {' '.join(words[1:])}"
            raise self.file.error(line, problem)
        return tuple(channels)

    def axis_order(self, line: int, order: str) -> str:
        if sorted(order.lower()) != ["x", "y", "z"]:
            problem = f"axis order {quoted(order)}, expected X, Y and Z, such as XYZ"
            raise self.file.error(line, problem)
        return order.lower()

    def assemble(self, unit: float) -> AcclaimSkeleton:
        """The skeleton in metres, parents before children, depth first."""
        names, parents, waiting = [], [], [("root", -1)]
        while waiting:
            name, parent = waiting.pop()
            children = self.children.get(name, [])
            waiting += [(child, len(names)) for child in reversed(children)]
            names.append(name)
            parents.append(parent)
        connected = set(names)
        for bone in self.bones.values():
            if bone.name not in connected:
                problem = f"bone {bone.name!r} hangs nowhere below the root"
                raise self.file.error(bone.line, problem)
        bones = [self.bones[name] for name in names[1:]]
        tips = [np.zeros(3)]
        tips += [unit * bone.length * np.array(bone.direction) for bone in bones]
        offsets = [unit * np.array(self.position), *(tips[parent] for parent in parents[1:])]
        leaves = sorted(set(range(len(names))) - set(parents))
        skeleton = Skeleton(
            tuple(names), tuple(parents), np.array(offsets), {leaf: tips[leaf] for leaf in leaves}
        )
        return AcclaimSkeleton(
            skeleton=skeleton,
            channels=(self.order, *(bone.channels for bone in bones)),
            axes=(Rotation.identity(), *(self.rotation(*bone.axis) for bone in bones)),
            orientation=self.rotation(self.orientation, self.root_axis),
            unit=unit,
            degrees=self.degrees,
        )

    def rotation(self, angles: list[float], order: str) -> Rotation:
        """Rotation about the world's x, y and z by three angles, applied in the order given."""
        by_axis = dict(zip("xyz", angles, strict=True))
        return Rotation.from_euler(order, [by_axis[axis] for axis in order], degrees=self.degrees)
