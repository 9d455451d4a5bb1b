"""Values over time, interpolated between those that are known."""

import numpy as np

WIDE = 12
"""WIDE: beside a gap of more than this many frames the curve is limited, so that it does not
overshoot. Chosen on takes of CMU and synthetic ones (docs/lab_book/filling.md)."""


def interpolated(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Values interpolated over time through those that are known, each column by itself.

    The curve is the natural cubic spline. With the known values v_i at the frames t_i, the widths
    h_i = t_{i+1} - t_i, the slopes d_i = (v_{i+1} - v_i) / h_i of the chords and the slopes s_i of
    the curve, its curvature is continuous, and zero at both ends:

        s_{i-1} / h_{i-1} + 2 s_i (1 / h_{i-1} + 1 / h_i) + s_{i+1} / h_i
            = 3 d_{i-1} / h_{i-1} + 3 d_i / h_i

    where terms of a neighbour that is not there are left out. At both ends of a gap with h_i >
    `WIDE`, s is then limited to between 0 and 3 d_i: in the gap the curve rises or falls with its
    chord. Before the first and after the last known value of a column this value is repeated. A
    column without a known value is zero: in a normalised motion the mean pose.

    Parameters
    ----------
    x : (B, T, C) array of float
    known : (B, T, C) array of bool

    Returns
    -------
    (B, T, C) array of the dtype of x

    References
    ----------
    Fritsch and Carlson, "Monotone piecewise cubic interpolation", 1980, for the limit.
    `scipy.interpolate.CubicSpline` is the same without it for one column; with a mask of its own
    for each of thousands of columns it takes minutes.

    Examples
    --------
    >>> x = np.array([0.0, 9.0, 2.0, 9.0, 9.0, 5.0, 9.0]).reshape(1, 7, 1)
    >>> interpolated(x, x < 9).ravel().round(3).tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0]
    """
    columns = x.swapaxes(1, 2).reshape(-1, x.shape[1])
    mask = known.swapaxes(1, 2).reshape(columns.shape)
    column, key = np.nonzero(mask)
    if len(key) == 0:
        return np.zeros_like(x)
    value = columns[mask]
    slope = _slopes(column, key, value)
    # The known values before or at each frame, of all columns together, and the next one:
    count = np.cumsum(mask, axis=1)
    first = np.concatenate([[0], np.cumsum(count[:, -1])[:-1]])[:, None]
    last = first + count[:, -1:] - 1
    some = count[:, -1:] > 0
    before = np.where(some, np.clip(first + count - 1, first, last), 0)
    after = np.where(some, np.minimum(first + count, last), 0)
    width = np.maximum(key[after] - key[before], 1)
    s = np.clip((np.arange(x.shape[1]) - key[before]) / width, 0, 1).astype(x.dtype)
    curve = (1 + 2 * s) * (1 - s) ** 2 * value[before] + s * s * (3 - 2 * s) * value[after]
    curve += width * s * (1 - s) * ((1 - s) * slope[before] - s * slope[after])
    filled = np.where(mask, columns, np.where(some, curve, 0))
    return filled.astype(x.dtype).reshape(x.swapaxes(1, 2).shape).swapaxes(1, 2)


def _slopes(column: np.ndarray, key: np.ndarray, value: np.ndarray) -> np.ndarray:
    """The slope of the curve at each known value; those of a column follow one another, and the
    equations of all columns are solved together."""
    from scipy.linalg import solve_banded  # slow to import

    joined = np.concatenate([[False], np.diff(column) == 0, [False]])
    width = np.where(joined, np.concatenate([[1], np.diff(key), [1]]), 1)
    chord = np.where(joined, np.concatenate([[0], np.diff(value), [0]]) / width, 0.0)
    weight = joined / width
    right = 3 * weight * chord
    diagonal = 2 * (weight[:-1] + weight[1:])
    diagonal[diagonal == 0] = 1.0  # a column with one known value
    # Above and below the diagonal of key j are the intervals before and after it.
    band = np.stack([weight[:-1], diagonal, weight[1:]])
    slope = solve_banded((1, 1), band, right[:-1] + right[1:])
    wide = joined & (width > WIDE)
    least = np.where(wide, np.minimum(3 * chord, 0), -np.inf)
    most = np.where(wide, np.maximum(3 * chord, 0), np.inf)
    slope = np.maximum(slope, np.maximum(least[:-1], least[1:]))
    return np.minimum(slope, np.minimum(most[:-1], most[1:]))
