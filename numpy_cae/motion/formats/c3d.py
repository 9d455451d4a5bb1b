"""Read joint centres from a C3D file (extra `c3d`, the library ezc3d).

The file's points must be named as the twenty joints are, ours or those of a known rig; other points
are ignored. Points on the skin (marker files) are another matter: joints would have to be computed
from them.
"""

from pathlib import Path

import numpy as np

from numpy_cae.motion.formats.text_file import MotionFileError
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import bone_lengths
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.fit import fit_motion
from numpy_cae.motion.retarget.rigs import UnknownRigError, find_joints
from numpy_cae.motion.skeleton import Skeleton

_METRES = {"mm": 0.001, "cm": 0.01, "dm": 0.1, "m": 1.0, "in": 0.0254, "ft": 0.3048}


def read_c3d(path: str | Path, unit: float | None = None) -> Motion:
    """Read a C3D file of joint centres as a motion of the twenty joints.

    Frames in which a joint is missing at the beginning or the end are left out; gaps in between are
    interpolated linearly. The unit and the vertical axis are as the file says (C3D's default: mm);
    `unit`, in metres, overrides the first.

    Raises
    ------
    MotionFileError
        If the file is damaged or lacks one of the twenty joints, or ezc3d is not installed.
    """
    path = Path(path)
    try:
        import ezc3d
    except ImportError:
        problem = "reading C3D needs ezc3d: pip install ezc3d"
        raise MotionFileError(path, None, problem) from None
    try:
        content = ezc3d.c3d(str(path))
        points = content["data"]["points"]
        settings = content["parameters"]["POINT"]
        labels = [str(label) for label in settings["LABELS"]["value"]]
        rate = float(settings["RATE"]["value"][0])
        named_unit = str((settings.get("UNITS", {}).get("value") or ["mm"])[0]).strip().lower()
    except Exception as error:  # ezc3d raises what its C++ raises
        raise MotionFileError(path, None, f"is not a readable C3D file: {error}") from None
    scale = unit or _METRES.get(named_unit)
    if scale is None or rate <= 0:
        problem = f"unit {named_unit!r} at {rate:g} frames a second; give the unit in metres"
        raise MotionFileError(path, None, problem)
    # A subject's name may precede the label: "Ann:LeftKnee".
    parents = (-1,) + (0,) * (len(labels) - 1)
    try:
        joints = find_joints(Skeleton(tuple(labels), parents, np.zeros((len(labels), 3))))
    except UnknownRigError as error:
        problem = f"{error}. A C3D file must have the centres of the {len(JOINTS)} joints as points"
        raise MotionFileError(path, None, problem) from None
    positions = points[:3, joints].transpose(2, 1, 0) * scale
    seen = np.isfinite(positions).all(axis=2) & (np.abs(positions).max(axis=2) > 0)
    positions = _without_gaps(path, positions, seen)
    if "Y" not in str((settings.get("Y_SCREEN", {}).get("value") or ["+Z"])[0]).upper():  # Z is up
        positions = np.stack([positions[..., 1], positions[..., 2], positions[..., 0]], axis=-1)
    return fit_motion(positions, bone_lengths(positions), rate, scale)


def _without_gaps(path: Path, positions: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Positions from the first to the last frame in which every joint was seen so far and later."""
    if not seen.any(axis=0).all():
        missing = JOINTS[int(np.argmin(seen.any(axis=0)))]
        raise MotionFileError(path, None, f"{missing} is missing in every frame")
    first = int(seen.argmax(axis=0).max())
    last = len(seen) - int(seen[::-1].argmax(axis=0).max())
    if first >= last:
        raise MotionFileError(path, None, "no stretch of frames in which every joint was seen")
    frames = np.arange(len(seen))
    filled = positions.copy()
    for joint in range(positions.shape[1]):
        known = frames[seen[:, joint]]
        for axis in range(3):
            filled[:, joint, axis] = np.interp(frames, known, positions[known, joint, axis])
    return filled[first:last]
