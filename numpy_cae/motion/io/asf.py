"""Read an Acclaim skeleton (.asf): bones with a direction and a length, and their rotation axes.

Schafer, Acclaim Skeleton File Definition V1.10 (1994), and Vicon's notes on it, as CMU's database
uses them. A bone's angles are about axes of its own, rotated by C (its `axis`) from the world's:

    R_bone = C · R(angles) · C⁻¹

which is a rotation in the world's axes of the rest pose, the axes that `Motion` has in every
joint. A joint here is named for its bone and is at the bone's base: lfemur at the hip, ltibia
at the knee.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from numpy_cae.motion.io.text_file import TextFile, quoted
from numpy_cae.motion.io.units import INCH, require_unit
from numpy_cae.motion.quaternions import IDENTITY, from_angles
from numpy_cae.motion.skeleton import Skeleton

MAX_BYTES = 1_000_000
"""Of an .asf file; those of CMU have 6,000."""
_NUMBER = re.compile(r"[+-]?(\d|\.\d|inf\b)")
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
    axes : tuple of J (4,) arrays
        C of each bone; the identity for the root.
    orientation : (4,) array
        The root's rotation is orientation · R.
    limits : tuple of J arrays (number of rotations, 2), or None
        Smallest and largest angle of each rotation; None for a bone without `limits`.
    unit, degrees
        Metres in one unit of the file; whether its angles are in degrees.
    """

    skeleton: Skeleton
    channels: tuple[tuple[str, ...], ...]
    axes: tuple[np.ndarray, ...]
    orientation: np.ndarray
    limits: tuple[np.ndarray | None, ...]
    unit: float
    degrees: bool


_Fields = dict[str, tuple[int, list[str]]]
"""The statements of a section or a bone: keyword -> (line number, words after the keyword)."""


@dataclass
class _Bone:
    """The line of a bone's `begin`, and its statements."""

    line: int
    fields: _Fields = field(default_factory=dict)

    @property
    def name(self) -> str:
        return " ".join(self.fields.get("name", (0, []))[1])


@dataclass
class _Sections:
    """The statements of a file, sorted into its sections."""

    units: _Fields = field(default_factory=dict)
    root: _Fields = field(default_factory=dict)
    bones: list[_Bone] = field(default_factory=list)
    hierarchy: list[tuple[int, list[str]]] = field(default_factory=list)


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
    file = TextFile.read(path, MAX_BYTES)
    sections = _read_sections(file)
    line, words = sections.units.get("length", (0, ["1"]))
    numbers = file.numbers(line, words)
    if len(numbers) != 1 or numbers[0] < 1e-9:
        raise file.error(line, "length of :units, expected one number above 0")
    line, words = sections.units.get("angle", (0, ["deg"]))
    angle = " ".join(words).lower()
    if angle not in ("deg", "rad", "degrees", "radians"):
        raise file.error(line, f"angle {quoted(angle)}, expected deg or rad")
    unit = INCH / numbers[0] if unit is None else require_unit(unit)
    return _assemble(file, sections, unit, angle.startswith("deg"))


def _read_sections(file: TextFile) -> _Sections:
    sections, section, seen = _Sections(), "", set()
    bone: _Bone | None = None
    separators = str.maketrans(",()", "   ")
    for line, words in statements(file):
        words = " ".join(words).translate(separators).split()
        keyword = words[0].lower() if words else ""
        if keyword.startswith(":"):
            section = keyword
            seen.add(section)
        elif words and section == ":units":
            sections.units[keyword] = line, words[1:]
        elif words and section == ":root":
            sections.root[keyword] = line, words[1:]
        elif words and section == ":hierarchy":
            if len(words) > 1 or keyword not in ("begin", "end"):
                sections.hierarchy.append((line, words))
        elif words and section == ":bonedata":
            if keyword == "begin" and bone is None:
                bone = _Bone(line)
                sections.bones.append(bone)
            elif keyword == "begin":
                break
            elif bone is None:
                raise file.error(line, f"{quoted(words[0])} is outside begin and end")
            elif keyword == "end":
                bone = None
            elif "limits" in bone.fields and _NUMBER.match(keyword):
                bone.fields["limits"][1].extend(words)
            else:
                bone.fields[keyword] = line, words[1:]
    if bone is not None:
        raise file.error(bone.line, f"bone {bone.name!r} begins here and has no end")
    for required in (":bonedata", ":hierarchy"):
        if required not in seen:
            problem = f"the file ends without {required}: is it an .asf file, cut off?"
            raise file.error(file.count, problem)
    return sections


def _channels(
    file: TextFile,
    fields: _Fields,
    keyword: str,
    known: tuple[str, ...],
    default: tuple[str, ...],
) -> tuple[str, ...]:
    """The channels of an `order` or `dof` statement, the default if there is none."""
    line, words = fields.get(keyword, (0, list(default)))
    channels = tuple(word.lower() for word in words)
    for channel in channels:
        if channel not in known:
            reason = "is unknown"
            if channel in ("l", *ROOT_CHANNELS):
                reason = "is not supported: bones here neither stretch nor slide"
            raise file.error(
                line, f"{keyword} {quoted(channel)} {reason}; expected {' '.join(known)}"
            )
    if len(set(channels)) < len(channels):
        raise file.error(line, f"{keyword} names a channel twice: {' '.join(words)}")
    return channels


def _limits(bone: _Bone, count: int) -> np.ndarray | None:
    """The `limits` of a bone, (count, 2); None where it has none or damaged ones."""
    try:
        limits = np.array(bone.fields.get("limits", (0, []))[1], dtype=float)
    except ValueError:
        return None
    return limits.reshape(count, 2) if count and limits.size == 2 * count else None


def _rotation(
    file: TextFile, line: int, angles: list[float], order: str, degrees: bool
) -> np.ndarray:
    """The rotation about the world's x, y and z by three angles, applied in the given order."""
    if sorted(order.lower()) != ["x", "y", "z"]:
        raise file.error(line, f"axis order {quoted(order)}, expected X, Y and Z, such as XYZ")
    by_axis = dict(zip("xyz", angles, strict=True))
    order = order.lower()[::-1]  # the world's axes are the own axes in reverse
    values = np.array([[by_axis[axis] for axis in order]])
    return from_angles(order.upper(), np.radians(values) if degrees else values)[0]


def _children(file: TextFile, sections: _Sections) -> dict[str, list[str]]:
    """The children of each bone in `:hierarchy`."""
    bones = {"root", *(bone.name for bone in sections.bones)}
    children: dict[str, list[str]] = {}
    lines: dict[str, int] = {}
    for line, words in sections.hierarchy:
        for name in words:
            if name not in bones:
                problem = f":hierarchy names {name!r}, a bone that :bonedata lacks"
                raise file.error(line, problem)
        for child in words[1:]:
            if child == "root" or child in lines:
                first = f", first on line {lines[child]}" if child in lines else ": it is the root"
                raise file.error(line, f"{child!r} is listed as a child a second time{first}")
            lines[child] = line
        children.setdefault(words[0], []).extend(words[1:])
    return children


def _assemble(file: TextFile, sections: _Sections, unit: float, degrees: bool) -> AcclaimSkeleton:
    """The skeleton in metres, parents before children, depth first."""
    # For each bone its end relative to its base in metres, its channels and its axes C.
    tips = {"root": np.zeros(3)}
    channels = {"root": _channels(file, sections.root, "order", ROOT_CHANNELS, ROOT_CHANNELS)}
    axes = {"root": IDENTITY}
    limits: dict[str, np.ndarray | None] = {}
    for bone in sections.bones:
        for required in ("name", "direction", "length", "axis"):
            if required not in bone.fields:
                raise file.error(bone.line, f"bone {bone.name!r} has no {required}")
        if bone.name in tips:
            raise file.error(bone.line, f"bone name {bone.name!r} appears a second time")
        direction = file.three_numbers(*bone.fields["direction"], "direction")
        line, words = bone.fields["length"]
        if len(words) != 1:
            raise file.error(line, f"length has {len(words)} values, expected one number")
        tips[bone.name] = unit * file.numbers(line, words)[0] * np.array(direction)
        line, words = bone.fields["axis"]
        angles = file.three_numbers(line, words[:3], "axis")
        axes[bone.name] = _rotation(file, line, angles, " ".join(words[3:]), degrees)
        channels[bone.name] = _channels(file, bone.fields, "dof", ROOT_CHANNELS[3:], ())
        limits[bone.name] = _limits(bone, len(channels[bone.name]))

    children = _children(file, sections)
    names: list[str] = []
    parents: list[int] = []
    waiting = [("root", -1)]
    while waiting:
        name, parent = waiting.pop()
        waiting += [(child, len(names)) for child in reversed(children.get(name, []))]
        names.append(name)
        parents.append(parent)
    connected = set(names)
    for bone in sections.bones:
        if bone.name not in connected:
            raise file.error(bone.line, f"bone {bone.name!r} is not below the root")

    zeros = (0, ["0", "0", "0"])
    position = file.three_numbers(*sections.root.get("position", zeros), "position")
    angles = file.three_numbers(*sections.root.get("orientation", zeros), "orientation")
    line, order = sections.root.get("axis", (0, ["xyz"]))
    offsets = [unit * np.array(position), *(tips[names[parent]] for parent in parents[1:])]
    leaves = sorted(set(range(len(names))) - set(parents))
    end_sites = {leaf: tips[names[leaf]] for leaf in leaves}
    return AcclaimSkeleton(
        skeleton=Skeleton(tuple(names), tuple(parents), np.array(offsets), end_sites),
        channels=tuple(channels[name] for name in names),
        axes=tuple(axes[name] for name in names),
        limits=(None, *(limits[name] for name in names[1:])),
        orientation=_rotation(file, line, angles, " ".join(order), degrees),
        unit=unit,
        degrees=degrees,
    )
