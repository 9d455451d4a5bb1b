"""Operations of one's own, each wrong in one property, and as they should be."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

BUFFERS: dict = {}
"""The arrays that `one_buffer` returns again, unless it is fixed."""


@dataclass(frozen=True)
class OwnOperation:
    """An operation that computes wrongly unless `fixed`.

    Parameters
    ----------
    function : (*arrays, fixed) -> (value, pullback)
    shapes : dict of argument to its shape
    failing : str
        The property that the wrong version has not.
    mistake : str
    """

    function: Callable
    shapes: dict[str, str]
    failing: str
    mistake: str

    def version(self, fixed: bool) -> Callable:
        """The operation, wrong or fixed."""
        return lambda *arrays: self.function(*arrays, fixed=fixed)


def blocks_of_64(x, *, fixed):
    y = np.cumsum(x, axis=1)

    def pullback(dy):
        dx = np.cumsum(dy[:, ::-1], axis=1)[:, ::-1].copy()
        if not fixed:
            dx[:, 63::64] = 0
        return dx

    return y, pullback


def clipped(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    y = e / e.sum(axis=-1, keepdims=True)

    def pullback(dy):
        if not fixed:
            dy = np.clip(dy, -7, 7)
        return y * (dy - np.sum(dy * y, axis=-1, keepdims=True))

    return y, pullback


def in_float64(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    y = e / e.sum(axis=-1, keepdims=True)

    def pullback(dy):
        if fixed:
            return y * (dy - np.sum(dy * y, axis=-1, keepdims=True))
        else:
            return (y * (dy - np.sum(dy * y, axis=-1, keepdims=True))).astype(float)

    return y, pullback


def maximum_ties(a, b, *, fixed):
    def pullback(dy):
        if fixed:
            return dy * (a >= b), dy * (b > a)
        else:
            return dy * (a >= b), dy * (b >= a)

    return np.maximum(a, b), pullback


def one_buffer(x, *, fixed):
    def pullback(dy):
        if fixed:
            dx = np.empty(x.shape, x.dtype)
        else:
            dx = BUFFERS.setdefault((x.shape, x.dtype), np.empty(x.shape, x.dtype))
        dx[...] = 2 * dy * x
        return dx

    return x * x, pullback


def one_frame_left(x, scale, *, fixed):
    y = x * scale[:, None]

    def pullback(dy):
        frames = x.shape[1]
        if not fixed and frames > 64 and frames % 32 == 1:
            frames -= 1
        return dy * scale[:, None], np.sum((dy * x)[:, :frames], axis=1)

    return y, pullback


def pool_ties(x, *, fixed):
    earlier, later = x[:, ::2], x[:, 1::2]
    y = np.maximum(earlier, later)

    def pullback(dy):
        dx = np.empty_like(x)
        dx[:, ::2] = dy * (earlier == y)
        if fixed:
            dx[:, 1::2] = dy * (earlier < y)
        else:
            dx[:, 1::2] = dy * (later == y)
        return dx

    return y, pullback


def transposed(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    y = e / e.sum(axis=-1, keepdims=True)

    def pullback(dy):
        if not fixed:
            dy = dy.ravel(order="K").reshape(x.shape)
        return y * (dy - np.sum(dy * y, axis=-1, keepdims=True))

    return y, pullback


def value_is_nan(x, *, fixed):
    if fixed:
        y = np.sqrt(np.abs(x) + 1)
    else:
        y = np.sqrt(x)

    def pullback(dy):
        return dy * np.sign(x) / (2 * y)

    return y, pullback


def without_the_sum(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    y = e / e.sum(axis=-1, keepdims=True)

    def pullback(dy):
        if fixed:
            return y * (dy - np.sum(dy * y, axis=-1, keepdims=True))
        else:
            return y * dy

    return y, pullback


OWN_OPERATIONS = [
    OwnOperation(
        blocks_of_64,
        {"x": "batch frames channels"},
        "gradient for x",
        "The last frame of a full block of 64 gets no gradient.",
    ),
    OwnOperation(clipped, {"x": "... classes"}, "linearity", "The upstream gradient is clipped."),
    OwnOperation(in_float64, {"x": "... classes"}, "dtype", "The gradient is float64."),
    OwnOperation(
        maximum_ties,
        {"a": "batch", "b": "batch"},
        "ties",
        "Where both arguments are equal, both get the whole gradient.",
    ),
    OwnOperation(
        one_buffer,
        {"x": "... classes"},
        "independence",
        "The next call changes what one returned: it is kept in one array or list.",
    ),
    OwnOperation(
        one_frame_left,
        {"x": "batch steps", "scale": "batch"},
        "gradient for scale",
        "A last block of one frame, of blocks of 32, is left out of the sum.",
    ),
    OwnOperation(
        pool_ties, {"x": "batch 2*frames"}, "ties", "Both entries of a tie get the whole gradient."
    ),
    OwnOperation(
        transposed,
        {"x": "... classes"},
        "strides",
        "The upstream gradient is read in the order of its memory.",
    ),
    OwnOperation(
        value_is_nan, {"x": "batch"}, "gradient for x", "The square root of a negative number."
    ),
    OwnOperation(
        without_the_sum,
        {"x": "... classes"},
        "gradient for x",
        "The sum over the classes is missing.",
    ),
]
