"""Pins, target positions of joints in the world ("a hand at a point, a root path"), for any rig.

A user pins joints of a rig in frames of its file; the optimisation is on the mean skeleton at its
own rate. The positions of the rig's joints are linear in those of the mean skeleton,

    p_j = Σ_k M_jk q_k,    M from `change_lengths`,

so the loss compares M q with the targets.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.motion.body import Body
from numpy_cae.motion.io.coordinates import points_to_y_up
from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import Mappings, body_positions, joint_index
from numpy_cae.motion.retarget.to_body import RATE


@dataclass(frozen=True)
class Pins:
    """The target positions of an optimisation, frame by frame.

    Parameters
    ----------
    targets : (F, 20, 3) array of float
        Metres; ignored where the weight is 0.
    weights : (F, 20, 3) array of float
    body : (20, 20) array of float
        M.
    """

    targets: np.ndarray
    weights: np.ndarray
    body: np.ndarray


@dataclass(frozen=True)
class Pin:
    """Target positions of one joint.

    Parameters
    ----------
    joint : str
        One of `numpy_cae.motion.JOINTS`.
    first, last : int
        Frames of the file, counted from 0, both included.
    points : (N, 3) array of float
        Metres in the world: one point to stay at, or several at equal intervals from first to last.
        A coordinate that is NaN is free.
    """

    joint: str
    first: int
    last: int
    points: np.ndarray

    def targets(self, frames: np.ndarray) -> np.ndarray:
        """The target positions at these frames, (len(frames), 3)."""
        if len(self.points) == 1 or self.first == self.last:
            return np.repeat(self.points[:1], len(frames), axis=0)
        keys = np.linspace(self.first, self.last, len(self.points))
        return np.stack([np.interp(frames, keys, column) for column in self.points.T], axis=-1)

    def errors(self, motion: Motion, mapping: Mappings = None) -> np.ndarray:
        """Distance of a motion's joint from its target in each pinned frame, metres."""
        frames = np.arange(self.first, self.last + 1)
        reached = body_positions(motion, mapping)[frames, JOINTS.index(self.joint)]
        return np.sqrt(np.nansum((reached - self.targets(frames)) ** 2, axis=-1))


def pins_on_mean_skeleton(pins: Sequence[Pin], body: Body) -> Pins:
    """Pins of a motion's rig as targets for its features."""
    frames = np.asarray(body.motion.source_frames(RATE), dtype=np.float64)
    targets = np.full((len(frames), len(JOINTS), 3), np.nan)
    for pin in pins:
        within = (frames >= pin.first) & (frames <= pin.last)
        within[np.argmin(np.abs(frames - pin.first))] = True  # a pin between two poses
        targets[within, JOINTS.index(pin.joint)] = pin.targets(frames[within])
    # The columns of M: one joint at a time away from the origin, along one axis.
    to_own = body.on_own_bones(np.eye(len(JOINTS))[..., None])[..., 0].T
    return Pins(np.nan_to_num(targets), np.isfinite(targets).astype(np.float64), to_own)


def read_pins(path: str | Path, motion: Motion, mapping: Mappings = None) -> list[Pin]:
    """Read pins from a JSON file: a list of objects such as

        {"joint": "left_wrist", "frames": [30, 45], "at": [20, 130, 35]}
        {"joint": "hips", "frames": [0, 119], "path": [[0, null, 0], [50, null, 200]]}

    in the unit of length, the axes and the frames of the motion's file, counted from 0; joints are
    named as ours or as the rig's. A coordinate that is null is free; the points of a path are at
    equal intervals.

    Raises
    ------
    MotionFileError
        If the file is not such a list; the message names the pin, from 1, and its error.
    """
    try:
        listed = json.loads(Path(path).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        line = getattr(error, "lineno", None)
        raise MotionFileError(path, line, f"not JSON: {error}") from None
    except OSError as error:
        raise MotionFileError(path, None, f"cannot be read: {error.strerror}") from None
    if not isinstance(listed, list) or not listed:
        raise MotionFileError(path, None, "expected a list of pins, [{…}, …]")
    found = []
    for number, entry in enumerate(listed, start=1):
        try:
            found.append(_pin(entry, motion, mapping))
        except ValueError as error:
            raise MotionFileError(path, None, f"pin {number}: {error}") from None
    return found


def _pin(entry: object, motion: Motion, mapping: Mappings) -> Pin:
    if not isinstance(entry, dict):
        raise ValueError("expected an object with joint, frames, and at or path")
    extra = sorted(set(entry) - {"joint", "frames", "at", "path"})
    if extra:
        raise ValueError(f"unknown: {', '.join(extra)}")
    joint = JOINTS[joint_index(str(entry.get("joint")), motion.skeleton, mapping)]
    if ("at" in entry) == ("path" in entry):
        raise ValueError("expected either at, a point, or path, a list of points")
    points = [_point(p) for p in ([entry["at"]] if "at" in entry else _list(entry["path"]))]
    for axis, column in zip("xyz", np.transpose(points), strict=True):
        if 0 < np.isnan(column).sum() < len(column):
            raise ValueError(
                f"{axis} is null in some points of the path, expected in all or in none"
            )
    first, last = _frames(entry.get("frames"), len(motion))
    return Pin(joint, first, last, points_to_y_up(np.array(points) * motion.unit, motion))


def _list(path: object) -> list:
    if not isinstance(path, list) or len(path) < 2:
        raise ValueError(f"path is {path!r}, expected a list of two points or more")
    return path


def _point(point: object) -> list[float]:
    if (
        not isinstance(point, list)
        or len(point) != 3
        or not all(n is None or (type(n) in (int, float) and abs(n) < 1e9) for n in point)
        or all(n is None for n in point)
    ):
        raise ValueError(f"{point!r} is not a point, expected [x, y, z], null where it is free")
    return [np.nan if n is None else float(n) for n in point]


def _frames(frames: object, count: int) -> tuple[int, int]:
    if not isinstance(frames, list) or len(frames) != 2 or not all(type(n) is int for n in frames):
        raise ValueError(f"frames is {frames!r}, expected [first, last]")
    first, last = frames
    if not 0 <= first <= last < count:
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {count - 1}")
    return first, last
