"""Values over time, interpolated between those that are known."""

import numpy as np


def interpolated(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Values interpolated over time through those that are known, each column by itself.

    The curve is PCHIP, a monotone cubic that does not overshoot. Before the first and after the
    last known value of a column this value is repeated. A column without a known value is zero: in
    a normalised motion the mean pose.

    Parameters
    ----------
    x : (B, T, C) array of float
    known : (B, T, C) array of bool

    Returns
    -------
    (B, T, C) array of the dtype of x

    References
    ----------
    Fritsch and Butland, "A method for constructing local monotone piecewise cubic interpolants",
    1984. `scipy.interpolate.PchipInterpolator` is the same for one column; with a mask of its own
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
    """The slope of the curve at each known value; those of a column follow one another."""
    joined = np.concatenate([[False], np.diff(column) == 0, [False]])
    width = np.where(joined, np.concatenate([[1], np.diff(key), [1]]), 1)
    secant = np.concatenate([[0], np.diff(value), [0]]) / width
    w0 = width[:-1]
    w1 = width[1:]
    d0 = secant[:-1]
    d1 = secant[1:]
    same = d0 * d1 > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = 3 * (w0 + w1) / ((2 * w1 + w0) / d0 + (w1 + 2 * w0) / d1)
    slope = np.where(same & joined[:-1] & joined[1:], mean, 0.0)
    starts = np.flatnonzero(~joined[:-1] & joined[1:])
    ends = np.flatnonzero(joined[:-1] & ~joined[1:])
    slope[starts] = _end_slopes(joined, width, secant, starts + 1, 1)
    slope[ends] = _end_slopes(joined, width, secant, ends, -1)
    return slope


def _end_slopes(
    joined: np.ndarray, width: np.ndarray, secant: np.ndarray, interval: np.ndarray, inwards: int
) -> np.ndarray:
    """The slopes at the outer ends of the first or last intervals of columns: that of the parabola
    through three values, limited so that the curve stays monotone."""
    beyond = np.clip(interval + inwards, 0, len(joined) - 1)
    w0 = width[interval]
    w1 = width[beyond]
    d0 = secant[interval]
    d1 = secant[beyond]
    slope = ((2 * w0 + w1) * d0 - w0 * d1) / (w0 + w1)
    slope = np.where(slope * d0 <= 0, 0.0, slope)
    slope = np.where((d0 * d1 <= 0) & (np.abs(slope) > 3 * np.abs(d0)), 3 * d0, slope)
    return np.where(joined[beyond], slope, d0)
