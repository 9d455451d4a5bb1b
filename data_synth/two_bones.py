"""Inverse kinematics of two bones: the knee and the elbow by the law of cosines.

    cos(interior angle) = (u² + l² - d²) / (2 u l),      d = |target - start|

The hinge axis determines the plane in which the limb bends; all frames are computed at once.
"""

import numpy as np
from scipy.spatial.transform import Rotation

# Up to this share of its length a limb reaches the target; beyond it, it straightens smoothly.
YIELDS_AT = 0.990
YIELDS_FOR = 0.0075


def unit(vectors: np.ndarray) -> np.ndarray:
    """The vectors (..., 3) at length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def reach(
    start: np.ndarray, target: np.ndarray, upper: float, lower: float, hinge: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The positions of the middle joint and of the end.

    Parameters
    ----------
    start, target : (F, 3) arrays
        Hip and ankle, or shoulder and wrist, in metres.
    upper, lower : float
        The lengths of the two bones.
    hinge : (F, 3) array
        Roughly the axis about which the limb bends; the middle joint goes to the side
        ``hinge × (start - target)`` of the straight line.

    Returns
    -------
    middle, end : (F, 3) arrays
        The end is the target if that is within 0.99 of the limb's length, else a point on the line
        to the target.
    """
    span = target - start
    distance = np.linalg.norm(span, axis=-1, keepdims=True)
    along = span / np.maximum(distance, 1e-9)
    longest = YIELDS_AT * (upper + lower)
    slack = YIELDS_FOR * (upper + lower)
    beyond = longest + slack * np.tanh((distance - longest) / slack)
    distance = np.where(distance > longest, beyond, distance)
    hinge = unit(hinge - np.sum(hinge * along, axis=-1, keepdims=True) * along)
    towards = np.cross(hinge, -along)
    foot_point = (distance**2 + upper**2 - lower**2) / (2 * distance)
    height = np.sqrt(np.maximum(upper**2 - foot_point**2, 0.0))
    return start + foot_point * along + height * towards, start + distance * along


def frames_from(x: np.ndarray, y: np.ndarray) -> Rotation:
    """The rotations whose axis Y points along y exactly, and X as nearly along x as possible."""
    y = unit(y)
    x = unit(x - np.sum(x * y, axis=-1, keepdims=True) * y)
    return Rotation.from_matrix(np.stack([x, y, np.cross(x, y)], axis=-1))
