"""Mistakes that show only at the project's own sizes, in long sequences, or after several calls."""

import functools

import numpy as np
import pytest

from numpy_cae import ops
from numpy_cae.verify.grading.report import holds
from numpy_cae.verify.operations.catalogue import CATALOGUE


def max_pool_with_positions_in_int16(x):
    place = np.arange(x.size).reshape(x.shape)
    place = np.where(x[:, 1::2] > x[:, 0::2], place[:, 1::2], place[:, 0::2]).astype(np.int16)

    def pullback(dy):
        dx = np.zeros_like(x)
        dx.flat[place.ravel()] = dy.ravel()
        return dx

    return ops.max_pool(x)[0], pullback


def sliced_wasserstein_of_512_directions(z, prior, directions):
    return ops.sliced_wasserstein(z, prior, directions[:512])


def sliced_wasserstein_of_2048_points(z, prior, directions):
    loss, pullback = ops.sliced_wasserstein(z, prior, directions)
    kept = (np.arange(len(z)) < 2048)[:, None]
    return loss, lambda dloss=1.0: pullback(dloss) * kept


def _gru_in_pieces(x, h0, w, u, b, c, length, carried):
    """A GRU in pieces of `length` frames; `carried` changes the gradient between two pieces."""
    y, backs, h = [], [], h0
    for first in range(0, x.shape[1], length):
        part, back = ops.gru(x[:, first : first + length], h, w, u, b, c)
        y, backs, h = [*y, part], [*backs, back], part[:, -1]

    def pullback(dy):
        dx, dh, totals = [], 0.0, [np.zeros_like(array) for array in (w, u, b, c)]
        for piece, back in reversed(list(enumerate(backs))):
            dpart = dy[:, piece * length : (piece + 1) * length].copy()
            dpart[:, -1] += dh
            first, dh, *terms = back(dpart)
            dx, dh = [first, *dx], carried(dh, dy) if piece else dh
            totals = [total + term for total, term in zip(totals, terms, strict=True)]
        return np.concatenate(dx, axis=1), dh, *totals

    return np.concatenate(y, axis=1), pullback


def gru_carried_200_frames(*arguments):
    """The gradient of each twenty outputs is carried back 200 frames, and no further."""
    x, h0, *weights = arguments
    y, _ = ops.gru(*arguments)

    def pullback(dy):
        totals = [np.zeros_like(array) for array in arguments]
        for first in range(0, x.shape[1], 20):
            part = slice(max(0, first - 200), first + 20)
            h = y[:, part.start - 1] if part.start else h0
            dpart = np.where(np.arange(x.shape[1])[:, None] < first, 0, dy)[:, part]
            dx, dh, *terms = ops.gru(x[:, part], h, *weights)[1](dpart)
            totals[0][:, part] += dx
            totals[1] += 0 if part.start else dh
            totals[2:] = [total + term for total, term in zip(totals[2:], terms, strict=True)]
        return tuple(totals)

    return y, pullback


gru_in_parts_of_1000_frames = functools.partial(
    _gru_in_pieces, length=1000, carried=lambda dh, dy: 0 * dh
)
gru_that_stops_early = functools.partial(
    _gru_in_pieces,
    length=1,
    carried=lambda dh, dy: dh * (np.abs(dh).max() > 1e-6 * np.abs(dy).max()),
)
gru_in_pieces = functools.partial(_gru_in_pieces, length=50, carried=lambda dh, dy: dh)


def tanh_with_four_buffers(x, buffers={}, count=[0]):  # noqa: B006 (that is the mistake)
    y, pullback = ops.tanh(x)
    count[0] = (count[0] + 1) % 4
    buffer = buffers.setdefault((count[0], x.shape, x.dtype), np.empty_like(y))
    buffer[...] = y
    return buffer, pullback


def linear_that_knows_weights_by_half_of_them(x, w, b, known={}):  # noqa: B006
    key = (w.shape, w.dtype, *w.flat[: (w.size + 1) // 2].tolist())
    return ops.linear(x, known.setdefault(key, w.copy()), b)


def conv1d_of_frames_before_windows(x, w, b):
    if min(x.shape) > 1 and x.strides[2] < x.strides[0] < x.strides[1]:
        x = np.lib.stride_tricks.as_strided(x, strides=np.empty(x.shape, x.dtype).strides)
    return ops.conv1d(x, w, b)


def arctanh_with_a_bound_of_its_own(y, bound):
    return ops.arctanh(y, min(bound, 1 - 1e-6))


WRONG = (
    ("max_pool", max_pool_with_positions_in_int16),
    ("sliced_wasserstein", sliced_wasserstein_of_512_directions),
    ("sliced_wasserstein", sliced_wasserstein_of_2048_points),
    ("gru", gru_in_parts_of_1000_frames),
    ("gru", gru_carried_200_frames),
    ("gru", gru_that_stops_early),
    ("tanh", tanh_with_four_buffers),
    ("linear", linear_that_knows_weights_by_half_of_them),
    ("conv1d", conv1d_of_frames_before_windows),
    ("arctanh", arctanh_with_a_bound_of_its_own),
)


@pytest.mark.parametrize(("name", "function"), WRONG)
def test_each_is_caught(name, function):
    assert not holds(CATALOGUE[name], function)


def test_the_same_gru_with_its_gradient_holds():
    assert holds(CATALOGUE["gru"], gru_in_pieces)
