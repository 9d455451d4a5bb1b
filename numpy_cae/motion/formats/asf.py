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
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from numpy_cae.motion.formats.channels import Channels
from numpy_cae.motion.formats.text_file import TextFile, quoted
from numpy_cae.motion.quaternions import IDENTITY, from_angles
from numpy_cae.motion.skeleton import Skeleton
from numpy_cae.motion.units import INCH, require_unit

MAX_BYTES = 1_000_000
"""Of an .asf file; those of CMU have 6,000."""
_NUMBER = re.compile(r"[+-]?(\d|\.\d|inf\b)")
_ROOT_CHANNELS = ("tx", "ty", "tz", "rx", "ry", "rz")


@dataclass(frozen=True)
class AcclaimSkeleton:
    """The content of an .asf file: a skeleton in metres whose joint 0 is "root", the channels of
    each joint in an .amc file (none of a rigid bone), and metres in one unit of the file."""

    skeleton: Skeleton
    channels: list[Channels]
    unit: float


_Fields = dict[str, tuple[int, list[str]]]
"""The statements of a section or a bone: keyword -> (line number, words after the keyword)."""


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
    units, root, bones, hierarchy = _read_sections(file)
    line, words = units.get("length", (0, ["1"]))
    numbers = file.numbers(line, words)
    if len(numbers) != 1 or numbers[0] < 1e-9:
        raise file.error(line, "length of :units, expected one number above 0")
    line, words = units.get("angle", (0, ["deg"]))
    angle = " ".join(words).lower()
    if angle not in ("deg", "rad", "degrees", "radians"):
        raise file.error(line, f"angle {quoted(angle)}, expected deg or rad")
    degrees = angle.startswith("deg")
    unit = INCH / numbers[0] if unit is None else require_unit(unit)

    names = _channel_names(file, root, "order", _ROOT_CHANNELS, _ROOT_CHANNELS)
    channels = {"root": Channels(names, 0, unit, axes=IDENTITY, degrees=degrees)}
    tips = {"root": np.zeros(3)}
    for bone in bones:
        name = _name(bone)
        for required in ("name", "direction", "length", "axis"):
            if required not in bone:
                raise file.error(bone["begin"][0], f"bone {name!r} has no {required}")
        if name in tips:
            raise file.error(bone["begin"][0], f"bone name {name!r} appears a second time")
        tips[name], channels[name] = _read_bone(file, bone, unit, degrees)

    order = _depth_first(_children(file, hierarchy, set(tips)))
    joints = list(order)
    for bone in bones:
        if _name(bone) not in order:
            raise file.error(bone["begin"][0], f"bone {_name(bone)!r} is not below the root")

    zeros = (0, ["0", "0", "0"])
    position = file.three_numbers(*root.get("position", zeros), "position")
    angles = file.three_numbers(*root.get("orientation", zeros), "orientation")
    line, words = root.get("axis", (0, ["xyz"]))
    orientation = _rotation(file, line, angles, " ".join(words), degrees)
    channels["root"] = replace(channels["root"], orientation=orientation)
    parents = tuple(order.values())
    offsets = [unit * np.array(position), *(tips[joints[parent]] for parent in parents[1:])]
    leaves = sorted(set(range(len(joints))) - set(parents))
    end_sites = {leaf: tips[joints[leaf]] for leaf in leaves}
    found, first = [], 0
    for name, offset in zip(joints, offsets, strict=True):
        # The root's translation is added to its preset position, which is its offset.
        found.append(replace(channels[name], first=first, offset=offset))
        first += len(channels[name].names)
    skeleton = Skeleton(tuple(joints), parents, np.array(offsets), end_sites)
    return AcclaimSkeleton(skeleton, found, unit)


def _read_sections(
    file: TextFile,
) -> tuple[_Fields, _Fields, list[_Fields], list[tuple[int, list[str]]]]:
    """The statements of `:units` and `:root`, of each bone, and the lines of `:hierarchy`."""
    fields: dict[str, _Fields] = {":units": {}, ":root": {}}
    bones: list[_Fields] = []
    hierarchy = []
    bone: _Fields | None = None
    section, seen = "", set()
    separators = str.maketrans(",()", "   ")
    for line, found in statements(file):
        words = " ".join(found).translate(separators).split()
        if not words:
            continue
        keyword, rest = words[0].lower(), words[1:]
        if keyword.startswith(":"):
            section = keyword
            seen.add(section)
        elif section in fields:
            fields[section][keyword] = line, rest
        elif section == ":hierarchy" and (rest or keyword not in ("begin", "end")):
            hierarchy.append((line, words))
        elif section == ":bonedata":
            if keyword == "begin":
                if bone is not None:
                    break
                bone = {"begin": (line, [])}
                bones.append(bone)
            elif bone is None:
                raise file.error(line, f"{quoted(words[0])} is outside begin and end")
            elif keyword == "end":
                bone = None
            elif "limits" in bone and _NUMBER.match(keyword):
                bone["limits"][1].extend(words)
            else:
                bone[keyword] = line, rest
    if bone is not None:
        raise file.error(bone["begin"][0], f"bone {_name(bone)!r} begins here and has no end")
    for required in (":bonedata", ":hierarchy"):
        if required not in seen:
            problem = f"the file ends without {required}: is it an .asf file, cut off?"
            raise file.error(file.count, problem)
    return fields[":units"], fields[":root"], bones, hierarchy


def _name(bone: _Fields) -> str:
    return " ".join(bone.get("name", (0, []))[1])


def _read_bone(
    file: TextFile, bone: _Fields, unit: float, degrees: bool
) -> tuple[np.ndarray, Channels]:
    """The end of a bone relative to its base in metres, and its channels."""
    direction = file.three_numbers(*bone["direction"], "direction")
    line, words = bone["length"]
    if len(words) != 1:
        raise file.error(line, f"length has {len(words)} values, expected one number")
    tip = unit * file.numbers(line, words)[0] * np.array(direction)
    line, words = bone["axis"]
    angles = file.three_numbers(line, words[:3], "axis")
    axes = _rotation(file, line, angles, " ".join(words[3:]), degrees)
    names = _channel_names(file, bone, "dof", _ROOT_CHANNELS[3:], ())
    try:
        limits = np.array(bone.get("limits", (0, []))[1], dtype=float)
    except ValueError:  # damaged limits are ignored
        limits = np.zeros(0)
    fitting = limits.reshape(-1, 2) if names and limits.size == 2 * len(names) else None
    return tip, Channels(names, 0, unit, axes=axes, degrees=degrees, limits=fitting)


def _channel_names(
    file: TextFile, fields: _Fields, keyword: str, known: tuple[str, ...], default: tuple[str, ...]
) -> tuple[str, ...]:
    """The channels of an `order` or `dof` statement, the default if there is none. Rotations are
    about fixed axes in this order."""
    line, words = fields.get(keyword, (0, list(default)))
    channels = tuple(word.lower() for word in words)
    for channel in channels:
        if channel not in known:
            reason = "is unknown"
            if channel in ("l", *_ROOT_CHANNELS):
                reason = "is not supported: bones here neither stretch nor slide"
            problem = f"{keyword} {quoted(channel)} {reason}; expected {' '.join(known)}"
            raise file.error(line, problem)
    if len(set(channels)) < len(channels):
        raise file.error(line, f"{keyword} names a channel twice: {' '.join(words)}")
    return channels


def _rotation(
    file: TextFile, line: int, angles: list[float], order: str, degrees: bool
) -> np.ndarray:
    """The rotation about the world's x, y and z by three angles, applied in the given order."""
    if sorted(order.lower()) != ["x", "y", "z"]:
        raise file.error(line, f"axis order {quoted(order)}, expected X, Y and Z, such as XYZ")
    order = order.upper()[::-1]  # the world's axes are the own axes in reverse
    values = np.array([[angles["XYZ".index(axis)] for axis in order]])
    return from_angles(order, np.radians(values) if degrees else values)[0]


def _children(
    file: TextFile, hierarchy: list[tuple[int, list[str]]], bones: set[str]
) -> dict[str, list[str]]:
    """The children of each bone in `:hierarchy`."""
    children: dict[str, list[str]] = {}
    lines: dict[str, int] = {}
    for line, words in hierarchy:
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


def _depth_first(children: dict[str, list[str]]) -> dict[str, int]:
    """The bones below the root, parents before children, with the place of each one's parent."""
    order: dict[str, int] = {}
    waiting = [("root", -1)]
    while waiting:
        name, parent = waiting.pop()
        waiting += [(child, len(order)) for child in reversed(children.get(name, []))]
        order[name] = parent
    return order
