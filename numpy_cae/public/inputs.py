"""What the functions of `import numpy_cae` accept: each argument in one of its forms, as one.

The functions raise TypeError for an argument of a type that is not accepted, and ValueError for a
value that does not fit; both name the argument and what was expected.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import inf
from numbers import Integral, Real
from pathlib import Path
from typing import Any

from numpy_cae.cleanup import Finding
from numpy_cae.cleanup.mask_file import EXAMPLE, entry_findings, read_mask
from numpy_cae.manifold import MotionManifold, SequenceManifold, load_manifold, starter
from numpy_cae.mocap import load_motion
from numpy_cae.mocap.rigs.recognise import joint_index
from numpy_cae.motion import JOINTS, Motion

FilePath = str | Path
AnyFindings = FilePath | Finding | Mapping[str, Any] | Iterable[Finding | Mapping[str, Any]]
"""Findings as objects, as the JSON file has them, or the path of that file."""


def to_motion(value: Motion | FilePath, name: str = "motion") -> Motion:
    """A motion, loaded where a path is given."""
    if isinstance(value, Motion):
        return value
    if isinstance(value, FilePath):
        return load_motion(value)
    raise TypeError(
        f"{name} is of type {_type(value)}, expected a Motion or the path of a motion file"
    )


def to_manifold(value: MotionManifold | FilePath | None) -> MotionManifold:
    """A manifold, loaded where a path is given; the starter model for None."""
    if value is None:
        return starter()
    manifold = load_manifold(value) if isinstance(value, FilePath) else value
    if isinstance(manifold, MotionManifold):
        return manifold
    expected = "a MotionManifold, the path of its file, or None for the starter model"
    if isinstance(manifold, SequenceManifold):
        raise ValueError(f"manifold is a sequential one, expected {expected}")
    raise TypeError(f"manifold is of type {_type(value)}, expected {expected}")


def to_joints(value: str | Iterable[str], motion: Motion) -> list[str]:
    """The names of some of the twenty joints; the rig's names are accepted."""
    names = to_strings(value, "joints")
    if not names:
        raise ValueError(f"joints is empty, expected names such as {JOINTS[7]!r}")
    joints = []
    for name in names:
        try:
            joints.append(JOINTS[joint_index(name, motion)])
        except ValueError as error:
            raise ValueError(f"joints: {error}") from None
    return joints


def to_frames(value: Sequence[int], motion: Motion) -> slice:
    """The frames of a motion from the first to the last of two numbers."""
    try:
        first, last = map(int, value)
    except (TypeError, ValueError):
        raise TypeError(f"frames is {value!r}, expected (first, last), counted from 0") from None
    if not 0 <= first <= last < len(motion):
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {len(motion) - 1}")
    return slice(first, last + 1)


def to_findings(value: AnyFindings, motion: Motion) -> list[Finding]:
    """Findings, read where the path of a JSON file is given."""
    if isinstance(value, FilePath):
        return read_mask(Path(value), motion)
    if isinstance(value, Finding | Mapping):
        value = [value]
    if not isinstance(value, Iterable):
        expected = f"Finding objects, a list such as {EXAMPLE}, or the path of a JSON file of it"
        raise TypeError(f"findings is of type {_type(value)}, expected {expected}")
    findings: list[Finding] = []
    for number, entry in enumerate(value, start=1):
        if isinstance(entry, Finding):
            findings.append(entry)
            continue
        try:
            findings += entry_findings(entry, motion)
        except ValueError as error:
            raise ValueError(f"findings, entry {number}: {error}") from None
    return findings


def to_strings(value: str | Iterable[str], name: str) -> list[str]:
    """One string or several, as a list."""
    strings = [value] if isinstance(value, str) or not isinstance(value, Iterable) else list(value)
    for text in strings:
        if not isinstance(text, str):
            raise TypeError(
                f"{name} has a value of type {_type(text)}, expected a string or several"
            )
    return strings


def to_paths(value: FilePath | Iterable[FilePath], name: str) -> list[Path]:
    """One path or several, as a list."""
    paths = list(value) if isinstance(value, Iterable) and not isinstance(value, str) else [value]
    for path in paths:
        if not isinstance(path, FilePath):
            raise TypeError(f"{name} has a value of type {_type(path)}, expected a path or several")
    if not paths:
        raise ValueError(f"{name} is empty, expected a path or several")
    return [Path(path) for path in paths]


def require_whole(value: object, name: str, least: int) -> None:
    """Raise unless a value is a whole number that is large enough."""
    expected = f"{name} is {value!r}, expected a whole number of at least {least}"
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise TypeError(expected)
    if value < least:
        raise ValueError(expected)


def require_rate(value: object) -> None:
    """Raise unless a value can be a learning rate."""
    expected = f"rate is {value!r}, expected a finite number of 0 or more"
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(expected)
    if not 0 <= float(value) < inf:
        raise ValueError(expected)


def _type(value: object) -> str:
    return type(value).__name__
