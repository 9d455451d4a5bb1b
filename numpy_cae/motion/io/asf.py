"""Read an Acclaim skeleton (.asf): bones with a direction and a length, and how each may turn.

Schafer, Acclaim Skeleton File Definition V1.10 (1994), and Vicon's notes on it, as CMU's database
uses them. A bone's angles are about axes of its own, turned by C (its `axis`) from the world's:

    R_bone = C · R(angles) · C⁻¹

which is a rotation in the world's axes of the rest pose, the axes that `Motion` has in every
joint. A joint here is named for its bone and sits at the bone's base: lfemur at the hip, ltibia
at the knee.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.io.text_file import TextFile, shortened
from numpy_cae.motion.io.units import INCH, require_unit
from numpy_cae.motion.skeleton import Skeleton

ROOT_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz")


@dataclass(frozen=True)
class AcclaimSkeleton:
    """What an .asf file says.

    Parameters
    ----------
    skeleton : Skeleton
        In metres; joint 0 is "root".
    channels : tuple of J tuples of str
        The order of each joint's values in an .amc file: "rx", "ry", "rz", for the root "tx",
        "ty", "tz" too. Rotations are about fixed axes in this order. Empty for a stiff bone.
    axes : tuple of J Rotation
        C of each bone; none for the root.
    orientation : Rotation
        Where the root's rotations start from: its rotation is orientation · R.
    unit : float
        Metres in one unit of length of the file.
    degrees : bool
        Whether angles are in degrees, where the .amc file does not say.
    """

    skeleton: Skeleton
    channels: tuple[tuple[str, ...], ...]
    axes: tuple[Rotation, ...]
    orientation: Rotation
    unit: float
    degrees: bool


@dataclass
class _Bone:
    name: str
    line: int
    direction: list[float] | None = None
    length: float | None = None
    axis: tuple[list[float], str] | None = None
    channels: tuple[str, ...] = ()


@dataclass
class _Parts:
    """The sections as they are read, in the file's units."""

    length: float = 1.0
    degrees: bool = True
    order: tuple[str, ...] = ROOT_CHANNELS
    root_axis: str = "xyz"
    position: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    orientation: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    bones: dict[str, _Bone] = field(default_factory=dict)
    children: dict[str, list[str]] = field(default_factory=dict)
    hung: dict[str, int] = field(default_factory=dict)


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
    file = TextFile.read(path)
    parts = _Parts()
    sections = {
        ":units": _take_unit,
        ":root": _take_root,
        ":bonedata": _take_bone,
        ":hierarchy": _take_children,
    }
    seen = set()
    take = None
    for line, words in _statements(file):
        if words[0].startswith(":"):
            section = words[0].lower()
            seen.add(section)
            take = sections.get(section)
        elif take is not None:
            take(file, parts, line, words)
    for section in (":bonedata", ":hierarchy"):
        if section not in seen:
            raise file.error(
                file.count, f"the file ends without {section}: is it an .asf file, cut off?"
            )
    return _assemble(file, parts, INCH / parts.length if unit is None else require_unit(unit))


def _statements(file: TextFile) -> Iterator[tuple[int, list[str]]]:
    """(line number, words); commas and brackets count as blanks, # begins a comment."""
    blanks = str.maketrans(",()", "   ")
    for line, text in file.numbered():
        words = text.partition("#")[0].translate(blanks).split()
        if words:
            yield line, words


def _take_unit(file: TextFile, parts: _Parts, line: int, words: list[str]) -> None:
    keyword, value = words[0].lower(), words[1:]
    if keyword == "length":
        numbers = file.numbers(line, value)
        if len(numbers) != 1 or numbers[0] < 1e-9:
            raise file.error(line, "length of :units, expected one number above 0")
        parts.length = numbers[0]
    elif keyword == "angle":
        parts.degrees = _is_degrees(file, line, value)


def _is_degrees(file: TextFile, line: int, words: list[str]) -> bool:
    unit = " ".join(words).lower()
    if unit not in ("deg", "rad", "degrees", "radians"):
        raise file.error(line, f"angle {shortened(unit)}, expected deg or rad")
    return unit.startswith("deg")


def _take_root(file: TextFile, parts: _Parts, line: int, words: list[str]) -> None:
    keyword, value = words[0].lower(), words[1:]
    if keyword == "order":
        parts.order = _channels(file, line, value, ROOT_CHANNELS, "order")
    elif keyword == "axis":
        parts.root_axis = _axis_order(file, line, " ".join(value))
    elif keyword == "position":
        parts.position = file.three_numbers(line, value, "position")
    elif keyword == "orientation":
        parts.orientation = file.three_numbers(line, value, "orientation")


def _channels(
    file: TextFile, line: int, words: list[str], known: tuple[str, ...], keyword: str
) -> tuple[str, ...]:
    channels = tuple(word.lower() for word in words)
    for channel in channels:
        if channel not in known:
            reason = (
                "is not supported: bones here neither stretch nor slide"
                if channel in ("l", *ROOT_CHANNELS)
                else "is unknown"
            )
            raise file.error(
                line, f"{keyword} {shortened(channel)} {reason}; expected {' '.join(known)}"
            )
    if len(set(channels)) < len(channels):
        raise file.error(line, f"{keyword} names a channel twice: {' '.join(words)}")
    return channels


def _axis_order(file: TextFile, line: int, order: str) -> str:
    if sorted(order.lower()) != ["x", "y", "z"]:
        raise file.error(line, f"axis order {shortened(order)}, expected X, Y and Z, such as XYZ")
    return order.lower()


def _take_bone(file: TextFile, parts: _Parts, line: int, words: list[str]) -> None:
    keyword, value = words[0].lower(), words[1:]
    if keyword == "begin":
        _require_finished(file, parts)
        parts.bones[""] = _Bone("", line)
        return
    bone = parts.bones.get("")
    if bone is None:
        raise file.error(line, f"{shortened(words[0])} stands outside begin and end")
    if keyword == "end":
        _finish_bone(file, parts, bone)
    elif keyword == "name":
        bone.name = " ".join(value)
    elif keyword == "direction":
        bone.direction = file.three_numbers(line, value, "direction")
    elif keyword == "length":
        numbers = file.numbers(line, value)
        if len(numbers) != 1:
            raise file.error(line, f"length has {len(numbers)} values, expected one number")
        bone.length = numbers[0]
    elif keyword == "axis":
        angles = file.three_numbers(line, value[:3], "axis")
        bone.axis = angles, _axis_order(file, line, " ".join(value[3:]))
    elif keyword == "dof":
        bone.channels = _channels(file, line, value, ROOT_CHANNELS[3:], "dof")


def _finish_bone(file: TextFile, parts: _Parts, bone: _Bone) -> None:
    for what in ("name", "direction", "length", "axis"):
        if getattr(bone, what) in (None, ""):
            raise file.error(bone.line, f"bone {bone.name!r} has no {what}")
    if bone.name in parts.bones or bone.name == "root":
        raise file.error(bone.line, f"bone name {bone.name!r} stands a second time")
    del parts.bones[""]
    parts.bones[bone.name] = bone


def _require_finished(file: TextFile, parts: _Parts) -> None:
    if "" in parts.bones:
        bone = parts.bones[""]
        raise file.error(bone.line, f"bone {bone.name!r} begins here and has no end")


def _take_children(file: TextFile, parts: _Parts, line: int, words: list[str]) -> None:
    if [word.lower() for word in words] in (["begin"], ["end"]):
        return
    _require_finished(file, parts)
    parent, *children = words
    for name in words:
        if name != "root" and name not in parts.bones:
            raise file.error(line, f":hierarchy names {name!r}, a bone that :bonedata lacks")
    for child in children:
        if child == "root" or child in parts.hung:
            before = parts.hung.get(child)
            first = f", first on line {before}" if before else ": it is the root"
            raise file.error(line, f"{child!r} is hung a second time{first}")
        parts.hung[child] = line
    parts.children.setdefault(parent, []).extend(children)


def _assemble(file: TextFile, parts: _Parts, unit: float) -> AcclaimSkeleton:
    _require_finished(file, parts)
    names, parents, waiting = [], [], [("root", -1)]
    while waiting:
        name, parent = waiting.pop()
        children = parts.children.get(name, [])
        waiting += [(child, len(names)) for child in reversed(children)]
        names.append(name)
        parents.append(parent)
    hung = set(names)
    for bone in parts.bones.values():
        if bone.name not in hung:
            raise file.error(bone.line, f"bone {bone.name!r} hangs nowhere below the root")

    def tip(name: str) -> np.ndarray:
        bone = parts.bones.get(name)
        return np.zeros(3) if bone is None else unit * bone.length * np.array(bone.direction)

    offsets = [unit * np.array(parts.position), *(tip(names[parent]) for parent in parents[1:])]
    leaves = set(range(len(names))) - set(parents)
    bones = [parts.bones[name] for name in names[1:]]
    return AcclaimSkeleton(
        skeleton=Skeleton(
            tuple(names),
            tuple(parents),
            np.array(offsets),
            {leaf: tip(names[leaf]) for leaf in sorted(leaves)},
        ),
        channels=(parts.order, *(bone.channels for bone in bones)),
        axes=(Rotation.identity(), *(_axes(*bone.axis, parts.degrees) for bone in bones)),
        orientation=_axes(parts.orientation, parts.root_axis, parts.degrees),
        unit=unit,
        degrees=parts.degrees,
    )


def _axes(angles: list[float], order: str, degrees: bool) -> Rotation:
    """Rotations about the world's x, y and z by three angles, applied in the order given."""
    by_axis = dict(zip("xyz", angles, strict=True))
    return Rotation.from_euler(order, [by_axis[axis] for axis in order], degrees=degrees)
