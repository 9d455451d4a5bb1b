"""An orthographic camera, and the lines of bones."""

import numpy as np


def camera_view(points: np.ndarray, azimuth: float = 30.0, elevation: float = 8.0) -> np.ndarray:
    """Project points to the picture of an orthographic camera that looks at the origin.

    Parameters
    ----------
    points : (…, 3) array of float
        Y up.
    azimuth : float
        Degrees about Y from which the camera looks: 0 sees a body that faces +Z from the front.
    elevation : float
        Degrees above the horizon.

    Returns
    -------
    (…, 2) array of float64
        To the right and up, in the unit of the points.
    """
    a, e = np.radians([azimuth, elevation])
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    up = np.array([-np.sin(e) * np.sin(a), np.cos(e), -np.sin(e) * np.cos(a)])
    return np.stack([points @ right, points @ up], axis=-1)


def bones(points: np.ndarray, parents: tuple[int, ...]) -> np.ndarray:
    """The line from each joint's parent to the joint: (J, D) to (bones, 2, D).

    A root with a single child is a point on the floor, as in Bandai's files, and has no bone.
    """
    on_floor = 0 if parents.count(0) == 1 and len(parents) > 2 else -1
    ends = [joint for joint, parent in enumerate(parents) if parent > on_floor]
    starts = [parents[joint] for joint in ends]
    return np.stack([points[starts], points[ends]], axis=1)
