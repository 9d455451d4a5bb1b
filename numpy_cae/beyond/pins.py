"""Where joints are wanted in the world: "a hand at a point, a root path", for a motion of any rig.

A person pins joints of their own rig, in its frames; the descent knows the mean skeleton at its own
rate. Between the two the lengths of bones change, and that is linear: joints of the rig's body are

    p_j = Σ_k M_jk q_k

of those of the mean skeleton, M from `change_lengths`. So pins are asked of M q itself.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import RootTransform
from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import body_positions
from numpy_cae.motion.retarget.to_body import RATE, body_of

_HIPS = 0


@dataclass(frozen=True)
class Pins:
    """What the descent is asked for.

    Parameters
    ----------
    targets : (F, 20, 3) array of float
        Metres; any number where nothing is wanted.
    weights : (F, 20) or (F, 20, 3) array of float
        0 where nothing is wanted, 1 where it is.
    body : (20, 20) array of float, optional
        M, for targets of another body than the mean skeleton.
    """

    targets: np.ndarray
    weights: np.ndarray
    body: np.ndarray | None = None

    def start(self, own: RootTransform) -> RootTransform:
        """Its own place, or where hips are pinned in the first frame."""
        weights = np.broadcast_to(self.weights.T, self.targets.T.shape).T[0, _HIPS]
        ratio = 1.0 if self.body is None else self.body[_HIPS, _HIPS]
        x, _, z = self.targets[0, _HIPS] / ratio
        return RootTransform(
            x if weights[0] > 0 else own.x, z if weights[2] > 0 else own.z, own.heading
        )


@dataclass(frozen=True)
class Pin:
    """One wish of a person.

    Parameters
    ----------
    joint : str
        One of `numpy_cae.motion.JOINTS`.
    first, last : int
        Frames of the file, counted from 0, both included.
    points : (N, 3) array of float
        Metres in the world; one to stay at, or several to pass evenly from first to last. A
        coordinate that is NaN is left free.
    """

    joint: str
    first: int
    last: int
    points: np.ndarray

    def at(self, frames: np.ndarray) -> np.ndarray:
        """Where the joint is wanted at these frames, (len(frames), 3)."""
        if len(self.points) == 1 or self.first == self.last:
            return np.repeat(self.points[:1], len(frames), axis=0)
        keys = np.linspace(self.first, self.last, len(self.points))
        return np.stack([np.interp(frames, keys, column) for column in self.points.T], axis=-1)

    def missed(self, motion: Motion, mapping: dict[str, str] | None = None) -> np.ndarray:
        """How far a motion's joint is from where it is wanted, metres, a number a pinned frame."""
        frames = np.arange(self.first, self.last + 1)
        gap = body_positions(motion, mapping)[frames, JOINTS.index(self.joint)] - self.at(frames)
        return np.sqrt(np.nansum(gap**2, axis=-1))


def pins_for(
    pins: Sequence[Pin],
    motion: Motion,
    manifold: MotionManifold,
    mapping: dict[str, str] | None = None,
) -> Pins:
    """Pins on a motion's own body, for the descent.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    own = bone_lengths(body_of(motion, mapping))
    moments = np.asarray(motion.source_frames(RATE), dtype=np.float64)
    targets = np.full((len(moments), len(JOINTS), 3), np.nan)
    for pin in pins:
        within = (moments >= pin.first) & (moments <= pin.last)
        within[np.argmin(np.abs(moments - pin.first))] = True  # between two poses, the nearer
        targets[within, JOINTS.index(pin.joint)] = pin.at(moments[within])
    # One joint at a time away from the origin, along one axis: the columns of M.
    each = np.eye(len(JOINTS))[..., None]
    body = change_lengths(each, manifold.lengths, own)[..., 0].T
    return Pins(np.nan_to_num(targets), np.isfinite(targets).astype(np.float64), body)


def read_pins(path: str | Path, motion: Motion) -> list[Pin]:
    """Pins from a JSON file: a list of objects such as

        {"joint": "left_wrist", "frames": [30, 45], "at": [20, 130, 35]}
        {"joint": "hips", "frames": [0, 119], "path": [[0, null, 0], [50, null, 200]]}

    in the unit of length and the frames of the motion's file, counted from 0. null leaves a
    coordinate free; a path is passed evenly.

    Raises
    ------
    MotionFileError
        If the file is not such a list, naming the pin, from 1, and what is wrong with it.
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
    for number, one in enumerate(listed, start=1):
        try:
            found.append(_pin(one, motion))
        except ValueError as error:
            raise MotionFileError(path, None, f"pin {number}: {error}") from None
    return found


def _pin(one: object, motion: Motion) -> Pin:
    if not isinstance(one, dict):
        raise ValueError("expected an object with joint, frames, and at or path")
    extra = sorted(set(one) - {"joint", "frames", "at", "path"})
    if extra:
        raise ValueError(f"nothing is known of {', '.join(extra)}")
    joint = one.get("joint")
    if joint not in JOINTS:
        raise ValueError(f"there is no joint {joint!r}, expected one of {', '.join(JOINTS)}")
    if ("at" in one) == ("path" in one):
        raise ValueError("expected at, a point, or path, a list of points, one of the two")
    points = [_point(p) for p in ([one["at"]] if "at" in one else _list(one["path"]))]
    for axis, column in zip("xyz", np.transpose(points), strict=True):
        if 0 < np.isnan(column).sum() < len(column):
            raise ValueError(f"{axis} is null in some points of the path: in all or in none")
    first, last = _frames(one.get("frames"), len(motion))
    return Pin(joint, first, last, np.array(points) * motion.unit)


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
        raise ValueError(f"{point!r} is no point, expected [x, y, z], null where it is free")
    return [np.nan if n is None else float(n) for n in point]


def _frames(frames: object, count: int) -> tuple[int, int]:
    if not isinstance(frames, list) or len(frames) != 2 or not all(type(n) is int for n in frames):
        raise ValueError(f"frames is {frames!r}, expected [first, last]")
    first, last = frames
    if not 0 <= first <= last < count:
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {count - 1}")
    return first, last
