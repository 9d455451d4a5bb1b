"""Completing a motion of which some values are missing.

holden2015, section 7, "Filling in Missing Data", projects a motion whose missing values are zero.
Which values are missing is known, or visible: a measured value is hardly ever zero to the last
digit. So the motion starts as an interpolation I of the known values over time. It is projected,
P = Φ†(Φ(X)), and what the projection misses at the known values is interpolated too:

    X_0     = I(X)
    X_{n+1} = X where it is known,    P(X_n) + I(X - P(X_n)) elsewhere

until n + 1 = N - 1, or ‖X_{n+1} - X_n‖ < SETTLED ‖X_1 - X_0‖. In one more step, the last, P is
averaged over all shifts of the pooling grid, which takes as long as eight projections; averaged in
every step it makes no better result (docs/lab_book/completion.md). The known values never change,
and at their neighbours there is no jump.

`interpolate_gaps` is I. Where an unknown share of the values was lost (holden2015, section 7),
`zeroed_fraction` estimates that share from the motion. `project_shifted` averages projections over
all shifts of the pooling grid.
"""

from collections.abc import Callable

import numpy as np

from numpy_cae.models import ConvAutoencoder

WINDOWS_AT_ONCE = 64
"""At most this many windows are projected together, to bound memory."""


def zeroed_fraction(x: np.ndarray) -> np.ndarray:
    """p̂, the share of values that are exactly zero, of each window.

    A measured value is hardly ever equal to the mean pose to the last digit. Features that are zero
    in every frame are not counted: two always are (the hips' x and z in the body's frame), and a
    marker that is missing throughout a clip is another kind of damage.

    Normalised windows (B, T, C), in which zero is the mean pose, give an array (B, 1, 1) in [0, 1).
    """
    zero = x == 0
    counted = ~zero.all(axis=1, keepdims=True)
    share = (zero & counted).sum(axis=(1, 2)) / np.maximum(x.shape[1] * counted.sum(axis=(1, 2)), 1)
    return share[:, None, None].astype(x.dtype)


def project_shifted(
    network: ConvAutoencoder, x: np.ndarray, average_shifts: bool = False
) -> np.ndarray:
    """Φ†(Φ(X)) averaged over all shifts of the pooling grid.

        mean_s  S_s⁻¹ Φ†(Φ(S_s X)),   S_s: shift by s frames,   s = 0 … stride - 1

    Pooling pairs frames (0, 1), (2, 3), …, so the projection of a motion shifted by one frame
    differs a little. The errors of the different shifts partly cancel in their mean.

    S_s X has s frames of zeros before X and stride - s after it, as the convolution's own padding;
    S_0 X is X. A clip is first lengthened by repeating its ends (`MotionManifold.pad`), and then
    shifted as a whole.

    Normalised windows (B, T, C) give an array of that shape. Unless `average_shifts` it is the
    plain projection, s = 0.
    """
    shifts = network.stride if average_shifts else 1
    at_once = WINDOWS_AT_ONCE // shifts
    parts = [x[start : start + at_once] for start in range(0, len(x), at_once)]
    return np.concatenate([_mean_projection(network, part, shifts) for part in parts])


def _mean_projection(network: ConvAutoencoder, x: np.ndarray, shifts: int) -> np.ndarray:
    total = network.project(x)
    frames = x.shape[1]
    if shifts == 1:
        return total
    shifted = []
    for shift in range(1, shifts):
        # Zeros, as the convolution's own padding, to a whole number of hidden frames.
        shifted.append(np.pad(x, ((0, 0), (shift, network.stride - shift), (0, 0))))
    projected = np.split(network.project(np.concatenate(shifted)), shifts - 1)
    for shift, part in enumerate(projected, start=1):
        total += part[:, shift : shift + frames]
    return total / shifts


WIDE = 12
"""Beside a gap of more than this many frames the curve is limited, so that it does not overshoot.
Chosen on takes of CMU and synthetic ones (docs/lab_book/completion.md)."""


def interpolate_gaps(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Interpolate unknown values over time through those that are known, each column by itself.

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
    >>> interpolate_gaps(x, x < 9).ravel().round(3).tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0]
    """
    columns = x.swapaxes(1, 2).reshape(-1, x.shape[1])
    mask = known.swapaxes(1, 2).reshape(columns.shape)
    # The known values of all columns, one column after the other: column, frame and value of each.
    column, key = np.nonzero(mask)
    if len(key) == 0:
        return np.zeros_like(x)
    value = columns[mask]
    slope = _slopes(column, key, value)
    before, after = _neighbours(mask)
    width = np.maximum(key[after] - key[before], 1)
    s = np.clip((np.arange(x.shape[1]) - key[before]) / width, 0, 1).astype(x.dtype)
    curve = (1 + 2 * s) * (1 - s) ** 2 * value[before] + s * s * (3 - 2 * s) * value[after]
    curve += width * s * (1 - s) * ((1 - s) * slope[before] - s * slope[after])
    has_values = mask.any(axis=1, keepdims=True)
    interpolated = np.where(mask, columns, np.where(has_values, curve, 0))
    return interpolated.astype(x.dtype).reshape(x.swapaxes(1, 2).shape).swapaxes(1, 2)


def _neighbours(mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For every frame of columns (N, T), the known value before it or at it, and the next one.

    Both are given by their number among the known values of all columns, one column after the
    other. Before the first and after the last one of a column both are this one; where a column has
    none, both are 0, which is not used.
    """
    count = np.cumsum(mask, axis=1)
    counts = count[:, -1:]
    first = np.cumsum(counts)[:, None] - counts
    last = first + counts - 1
    before = np.where(counts > 0, np.clip(first + count - 1, first, last), 0)
    after = np.where(counts > 0, np.minimum(first + count, last), 0)
    return before, after


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


Interpolate = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Values over time, and a mask of those that are known, to values that are all known."""

PROJECTIONS = 5
"""N is at most this."""
SETTLED = 0.1
"""The last projection follows one that changes the unknown values by less than this share of what
the first one changed (root mean squares)."""


def complete(
    x: np.ndarray,
    known: np.ndarray,
    project: Callable[[np.ndarray, bool], np.ndarray],
    interpolate: Interpolate = interpolate_gaps,
    start: np.ndarray | None = None,
    projections: int = PROJECTIONS,
) -> np.ndarray:
    """The last X_n of the module's equation.

    Parameters
    ----------
    x : array of float
        X; what is unknown in it is ignored, but has to be finite.
    known : array of bool
        Of the shape of x.
    project : function (values, averaged) -> values
        P, averaged over all shifts or not.
    interpolate : function (values, known) -> values
        I.
    start : array of float, optional
        X_0; I(X) where None.
    projections : int
        N, at least 1.

    Returns
    -------
    array of the shape of x
    """

    def next_of(x_n: np.ndarray, averaged: bool = False) -> np.ndarray:
        projected = project(x_n, averaged)
        missed = interpolate(np.where(known, x - projected, 0.0), known)
        return np.where(known, x, projected + missed)

    if known.all():
        return x.copy()
    if start is None:
        start = interpolate(x, known)
    x_n = np.where(known, x, start)
    first_change = 0.0
    for _ in range(projections - 1):
        before = x_n
        x_n = next_of(before)
        change = float(np.linalg.norm(x_n - before))
        first_change = first_change or change
        if change < SETTLED * first_change:
            break
    return next_of(x_n, averaged=True)
