"""What a repair changed, as text."""

from collections import defaultdict

import numpy as np

from numpy_cae.manifold import Repaired
from numpy_cae.motion import JOINTS

MOST_STRETCHES = 5


def changes(repaired: Repaired) -> list[str]:
    """A line for joints that were changed in the same frames: names, frames and centimetres."""
    if not repaired.known:
        return [
            f"unlike what the model knows: joints are typically {100 * repaired.residual:.1f} cm "
            "from it; left unchanged (--force repairs it nevertheless)"
        ]
    groups: dict[str, list[int]] = defaultdict(list)
    for joint in np.flatnonzero(repaired.touched.any(axis=0)):
        groups[_frames(repaired.touched[:, joint])].append(joint)
    lines = []
    for frames, joints in groups.items():
        moved = 100 * repaired.moved[:, joints][repaired.touched[:, joints]]
        names = "all joints" if len(joints) == len(JOINTS) else ", ".join(JOINTS[j] for j in joints)
        lines.append(f"{names}: {frames}: moved {moved.mean():.1f} cm, at most {moved.max():.1f}")
    return lines or ["nothing to repair was found"]


HEADER = ("file", "joints", "touched, %", "moved, cm", "at most, cm", "result")


def row(name: str, repaired: Repaired) -> list[str]:
    """The cells of a table with `HEADER`; centimetres are those of the touched joints."""
    touched = repaired.touched
    if not repaired.known:
        return [name, "", "", "", "", "unknown motion, unchanged"]
    if not touched.any():
        return [name, "0", "0.0", "", "", "nothing to repair"]
    moved = 100 * repaired.moved[touched]
    share = f"{100 * touched.mean():.1f}"
    joints = str(touched.any(axis=0).sum())
    return [name, joints, share, f"{moved.mean():.1f}", f"{moved.max():.1f}", "repaired"]


def _frames(touched: np.ndarray) -> str:
    """The stretches of frames (F,) bool, such as "frames 30 to 45, 102"."""
    ends = np.flatnonzero(np.diff(touched, prepend=False, append=False)).reshape(-1, 2)
    texts = [f"{a} to {b - 1}" if b - a > 1 else f"{a}" for a, b in ends[:MOST_STRETCHES]]
    more = f" and {len(ends) - MOST_STRETCHES} more" if len(ends) > MOST_STRETCHES else ""
    word = "frame" if len(ends) == 1 and ends[0, 1] - ends[0, 0] == 1 else "frames"
    return f"{word} {', '.join(texts)}{more}"
