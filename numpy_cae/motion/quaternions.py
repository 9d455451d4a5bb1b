"""Rotations as unit quaternions (x, y, z, w), arrays (…, 4); q and -q are the same rotation.

A quaternion is a vector u = a sin(α/2) and a number w = cos(α/2), for a rotation by α about the
unit vector a. `scipy.spatial.transform` has the same operations. Here a product takes a twentieth
of its time, and a command need not wait a quarter of a second until SciPy is imported.
"""

from itertools import permutations

import numpy as np

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def product(second: np.ndarray, first: np.ndarray) -> np.ndarray:
    """The rotation `first` and then `second`, the Hamilton product

    (u, w) (u', w') = (w u' + w' u + u × u',  w w' - u · u')
    """
    a, b, c, d = second[..., 0], second[..., 1], second[..., 2], second[..., 3]
    x, y, z, w = first[..., 0], first[..., 1], first[..., 2], first[..., 3]
    return _stacked(
        d * x + a * w + b * z - c * y,
        d * y + b * w + c * x - a * z,
        d * z + c * w + a * y - b * x,
        d * w - a * x - b * y - c * z,
    )


def _stacked(*components: np.ndarray) -> np.ndarray:
    """Arrays of one shape as the last axis of one array."""
    # np.moveaxis and np.stack take longer than the arithmetic of a few frames.
    stacked = np.empty((*components[0].shape, len(components)), components[0].dtype)
    for place, component in enumerate(components):
        stacked[..., place] = component
    return stacked


def inverse(q: np.ndarray) -> np.ndarray:
    """The opposite rotation, (-u, w)."""
    return q * [-1.0, -1.0, -1.0, 1.0]


def rotate(q: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """The vectors v (…, 3), rotated: v + w t + u × t with t = 2 u × v."""
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    a, b, c = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    i = 2 * (y * c - z * b)
    j = 2 * (z * a - x * c)
    k = 2 * (x * b - y * a)
    return _stacked(
        a + w * i + y * k - z * j,
        b + w * j + z * i - x * k,
        c + w * k + x * j - y * i,
    )


def angle(q: np.ndarray) -> np.ndarray:
    """α in radians, 0 to π."""
    return 2 * np.arctan2(np.linalg.norm(q[..., :3], axis=-1), np.abs(q[..., 3]))


def from_vector(vectors: np.ndarray) -> np.ndarray:
    """The quaternions of rotation vectors α a, (…, 3) in radians."""
    half = np.linalg.norm(vectors, axis=-1, keepdims=True) / 2
    return np.concatenate([np.sinc(half / np.pi) / 2 * vectors, np.cos(half)], axis=-1)


def to_vector(q: np.ndarray) -> np.ndarray:
    """The rotation vectors α a, (…, 3) in radians, not longer than π."""
    q = np.where(q[..., 3:] < 0, -q, q)
    return q[..., :3] / (np.sinc(angle(q) / (2 * np.pi)) / 2)[..., None]


def slerp(start: np.ndarray, end: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Spherical interpolation: a share (…) of the rotation that leads from `start` to `end`."""
    way = to_vector(product(inverse(start), end))
    return product(start, from_vector(share[..., None] * way))


def nearest(matrices: np.ndarray) -> np.ndarray:
    """The rotation R that is nearest to a matrix M (…, 3, 3), which maximises tr RᵀM.

    tr RᵀM is a quadratic form in the quaternion of R, whose maximum is the eigenvector of the
    largest eigenvalue (Horn 1987).
    """
    m = matrices
    t = np.trace(m, axis1=-2, axis2=-1)
    form = np.empty((*t.shape, 4, 4))
    form[..., :3, :3] = m + m.swapaxes(-1, -2) - t[..., None, None] * np.eye(3)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        form[..., i, 3] = form[..., 3, i] = m[..., k, j] - m[..., j, k]
    form[..., 3, 3] = t
    return np.linalg.eigh(form)[1][..., -1]


def from_angles(order: str, angles: np.ndarray) -> np.ndarray:
    """Quaternions of angles (…, N) in radians about the joint's own axes in an order such as "ZXY",
    or about fixed axes in an order such as "yxz".

    Multiplied on the right by a rotation of 2α about axis i, a quaternion q becomes (j and k are
    the axes that follow i in the cycle x, y, z)

        q_i cos α + q_w sin α,   q_j cos α + q_k sin α,   q_k cos α - q_j sin α,
        q_w cos α - q_i sin α
    """
    if order.islower():  # fixed axes in this order are own axes in reverse order
        return from_angles(order[::-1].upper(), angles[..., ::-1])
    sines = np.sin(angles / 2)
    cosines = np.cos(angles / 2)
    q = [*np.zeros((3, *angles.shape[:-1])), np.ones(angles.shape[:-1])]
    for place, axis in enumerate(order):
        i = "XYZ".index(axis)
        j, k = (i + 1) % 3, (i + 2) % 3
        sin = sines[..., place]
        cos = cosines[..., place]
        q[i], q[3] = q[i] * cos + q[3] * sin, q[3] * cos - q[i] * sin
        q[j], q[k] = q[j] * cos + q[k] * sin, q[k] * cos - q[j] * sin
    return _stacked(*q)


def to_angles(order: str, q: np.ndarray) -> np.ndarray:
    """Angles (F, 3) in radians about the joint's own three axes; at a pole, ±90° of the middle
    angle, the last is 0 (Bernardes and Viollet 2022)."""
    k, j, i = ("XYZ".index(axis) for axis in order)
    sign = (i - j) * (j - k) * (k - i) // 2
    a = q[:, 3] - q[:, j]
    b = q[:, i] + sign * q[:, k]
    c = q[:, 3] + q[:, j]
    d = sign * q[:, k] - q[:, i]
    middle = 2 * np.arctan2(np.hypot(c, d), np.hypot(a, b))
    total = np.arctan2(b, a)
    difference = np.arctan2(d, c)
    low = middle < 1e-7
    high = middle > np.pi - 1e-7
    last = np.where(low | high, 0.0, total - difference)
    first = np.where(low, 2 * total, np.where(high, 2 * difference, total + difference))
    angles = _stacked(sign * first, middle - np.pi / 2, last)
    return angles - 2 * np.pi * np.round(angles / (2 * np.pi))


def continuous_angles(angles: np.ndarray, before: np.ndarray | None = None) -> np.ndarray:
    """Angles of the same rotations as `angles` (F, 1 to 3), without avoidable jumps from frame to
    frame. All are in radians; the first ones are near the angles `before` (N,)."""
    before = angles[0] if before is None else before
    if angles.shape[1] == 3:
        # (a + π, π - b, c + π) is the same rotation as (a, b, c). Where it is nearer to the frame
        # before, it is used, and from there on the two change their roles.
        equivalent = angles * [1, -1, 1] + np.pi
        previous = np.vstack([before, angles[:-1]])
        is_nearer = _distance(previous, equivalent) < _distance(previous, angles)
        if is_nearer.any():
            use_equivalent = np.cumsum(is_nearer) % 2 == 1
            angles = np.where(use_equivalent[:, None], equivalent, angles)
    steps = np.diff(np.vstack([before, angles]), axis=0)
    turns = np.round(steps / (2 * np.pi))
    return angles - 2 * np.pi * np.cumsum(turns, axis=0) if turns.any() else angles


def _distance(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The largest of three differences of angles (F, 3), apart from whole turns: (F,)."""
    turns = (start - end) / (2 * np.pi)
    first, second, third = np.abs(turns - np.round(turns)).T
    return 2 * np.pi * np.maximum(np.maximum(first, second), third)  # faster than max(axis=-1)


def nearest_angles(rotations: np.ndarray, order: str) -> np.ndarray:
    """The angles (F, N) in radians about the axes of `order` whose rotations are nearest.

    If these are fewer than three, the rotations are decomposed about every sequence of three axes
    that contains them in this order. The angles about the other axes are dropped, and in each frame
    the nearest result is returned.
    """
    if order.islower():
        return nearest_angles(rotations, order[::-1].upper())[:, ::-1]
    if len(order) == 3:
        return to_angles(order, rotations)
    nearest_so_far = np.zeros((len(rotations), len(order)))
    if not order:
        return nearest_so_far
    least = np.full(len(rotations), np.inf)
    for axes in permutations("XYZ"):
        places = [axes.index(axis) for axis in order]
        if places != sorted(places):
            continue
        angles = to_angles("".join(axes), rotations)[:, places]
        miss = angle(product(inverse(from_angles(order, angles)), rotations))
        is_nearer = miss < least
        nearest_so_far[is_nearer] = angles[is_nearer]
        least = np.minimum(least, miss)
    return nearest_so_far
