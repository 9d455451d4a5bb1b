"""Interpolation of two motions on the manifold (holden2015, section 7, "Motion Interpolation").

    X̂_s = Φ†((1 - s) Φ(X_0) + s Φ(X_1))

Hidden units lie within [-1, 1], and so do all points between them.
"""

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import POSITIONS, TURN, VELOCITY, trajectory_of

TRANSITION = "transition"
"""The share that grows from 0 at the first frame to 1 at the last."""


def shares(share: float | str, steps: int) -> np.ndarray:
    """s at each of `steps` steps, (steps, 1): a constant, or 0 to 1 for `TRANSITION`."""
    if share == TRANSITION:
        return np.linspace(0.0, 1.0, steps)[:, None]
    if isinstance(share, str) or not 0 <= share <= 1:
        raise ValueError(f"share is {share!r}, expected 0 to 1 or {TRANSITION!r}")
    return np.full((steps, 1), float(share))


def interpolate(
    manifold: MotionManifold, first: np.ndarray, second: np.ndarray, share: float | str = 0.5
) -> np.ndarray:
    """The motion on the manifold between two, which start together; the longer is truncated.

    Parameters
    ----------
    manifold : MotionManifold
    first, second : (F, 63), (G, 63) arrays of float
        Features on the manifold's mean skeleton, at thirty frames a second.
    share : float or "transition"
        Weight of the second motion: 0 is the projection of the first, 1 that of the second; a
        transition goes from the first to the second.

    Returns
    -------
    (min(F, G), 63) array of float64

    Raises
    ------
    ValueError
        If a motion has no frames, or `share` is something else.

    Examples
    --------
    The mean speed of the hips on the floor, m/s, in a walk, half way between, and in a run:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import interpolate, starter
    >>> from numpy_cae.mocap import body_of
    >>> manifold = starter()
    >>> walk, run = (
    ...     manifold.features(body_of(make_take(kind, 0, seconds=2.0, rate=30.0).motion))[0]
    ...     for kind in ("walk", "run")
    ... )
    >>> between = interpolate(manifold, walk, run, share=0.5)
    >>> motions = np.stack([walk, between, run])
    >>> (30 * np.linalg.norm(motions[..., 60:62], axis=-1)).mean(axis=1).round(1)
    array([1.4, 2.2, 2.6])
    """
    frames = min(len(first), len(second))
    if frames == 0:
        raise ValueError("a motion has no frames to interpolate")
    y_0 = manifold.encode(first[:frames])
    y_1 = manifold.encode(second[:frames])
    # A hidden frame is made from 8 frames; the first begins `receptive_radius` before the clip.
    middles = (np.arange(len(y_0)) + 0.5) * manifold.stride - 0.5 - manifold.receptive_radius
    nearest = np.clip(middles.round().astype(int), 0, frames - 1)
    s = shares(share, frames)[nearest].astype(y_0.dtype)
    return manifold.decode((1 - s) * y_0 + s * y_1, frames)


def with_path(
    between: np.ndarray, first: np.ndarray, second: np.ndarray, share: float | str
) -> np.ndarray:
    """An interpolated motion on a path between those of the two motions.

    The velocity and the turn of the body, and where the hips are above the path, are those of the
    two motions, weighted by the share: what the network decodes varies more from frame to frame.
    In a transition the weight is `share_of_path`. Arguments as in `interpolate`.
    """
    frames = len(between)
    first = first[:frames]
    second = second[:frames]
    s = share_of_path(first, second) if share == TRANSITION else shares(share, frames)
    on_path = between.copy()
    pose = on_path[:, POSITIONS].reshape(frames, -1, 3)
    hips = (1 - s) * first[:, :3] + s * second[:, :3]
    pose[..., ::2] += (hips - on_path[:, :3])[:, None, ::2]
    on_path[:, POSITIONS] = pose.reshape(frames, -1)
    for part in (VELOCITY, TURN):
        on_path[:, part] = (1 - s) * first[:, part] + s * second[:, part]
    return on_path


def share_of_path(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """s of a transition's path at each frame, (F, 1): it grows where the motions accelerate little.

    With a_i the acceleration of the hips on the floor at frame i, that of the first motion at the
    start and of the second at the end, and A the largest of both motions:

        s_{i+1} - s_i = (A - a_i) / Σ_j (A - a_j)

    While s grows, the hips accelerate by a_i and by (s_{i+1} - s_i) |v' - v| in addition, where v
    and v' are the velocities of the two motions. Both together stay below A, except in a clip so
    short that Σ_j (A - a_j) is less than |v' - v|, or in turns.

    Parameters
    ----------
    first, second : (F, 63) arrays of float
        Features of the two motions.
    """
    if len(first) < 3:
        return shares(TRANSITION, len(first))
    paths = [trajectory_of(features)[0] for features in (first, second)]
    a_first, a_second = np.linalg.norm(np.diff(paths, 2, axis=1), axis=-1)
    even = np.linspace(0.0, 1.0, len(a_first))
    largest = max(a_first.max(), a_second.max()) + 1e-9  # s grows evenly if nothing accelerates
    growth = largest - (1 - even) * a_first - even * a_second
    return np.concatenate([[0.0], np.cumsum(growth) / growth.sum(), [1.0]])[:, None]
