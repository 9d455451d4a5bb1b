"""The fast convolution equals the definition, value and gradients, with any shape."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae import fast, ops
from numpy_cae.fast.blocks import block_length

SIZES = {
    "batch": st.integers(1, 5),
    "frames": st.one_of(st.integers(1, 20), st.integers(1, 130)),
    "channels": st.integers(1, 9),
    "filters": st.integers(1, 9),
    "taps": st.integers(0, 12).map(lambda half: 2 * half + 1),
    "seed": st.integers(0, 2**32 - 1),
}


def drawn(rng, batch, frames, channels, filters, taps, dtype=np.float64):
    """Arguments and an upstream gradient, none of them ones or zeros."""
    shapes = [(batch, frames, channels), (taps, channels, filters), (filters,)]
    x, w, b = (rng.normal(size=shape).astype(dtype) for shape in shapes)
    return x, w, b, rng.normal(size=(batch, frames, filters)).astype(dtype)


def both(x, w, b, dy):
    """Value and gradients, by the definition and by the fast form."""
    for conv1d in (ops.conv1d, fast.conv1d):
        y, pullback = conv1d(x, w, b)
        yield y, *pullback(dy)


def assert_equal(expected, found, tolerance):
    """Every array within `tolerance` of the expected one, as a share of its largest value."""
    for name, a, b in zip(("y", "dx", "dw", "db"), expected, found, strict=True):
        assert a.shape == b.shape, name
        assert a.dtype == b.dtype, name
        atol = tolerance * max(1.0, np.abs(a).max())
        np.testing.assert_allclose(b, a, rtol=0, atol=atol, err_msg=name)


@pytest.mark.parametrize("shape", [(4, 160, 63, 64, 15), (2, 80, 64, 128, 15)])
def test_float32_is_as_exact_as_the_direct_form(shape):
    """Both against float64: the fast form's error is at most three times the direct form's."""
    arguments = drawn(np.random.default_rng(0), *shape, dtype=np.float32)
    exact = next(both(*(argument.astype(np.float64) for argument in arguments)))
    for truth, direct, quick in zip(exact, *both(*arguments), strict=True):
        error_direct, error_quick = (np.abs(a - truth).std() for a in (direct, quick))
        assert quick.dtype == np.float32
        assert error_quick <= 3 * error_direct
        assert error_quick < 2e-6 * np.abs(truth).max()


@settings(max_examples=100)
@given(**SIZES)
def test_equal_in_float64_with_any_strides_and_arguments_left_alone(seed, **sizes):
    arguments = drawn(np.random.default_rng(seed), **sizes)
    assert_equal(*both(*arguments), tolerance=1e-10)
    strided = []
    for array in arguments:
        wide = np.full((*(2 * length for length in array.shape[::-1]),), np.nan)
        view = wide[tuple(slice(None, None, 2) for _ in wide.shape)].T[::-1]
        view[...] = array
        strided.append(view)
    assert_equal(*both(*strided), tolerance=1e-10)
    for view, array in zip(strided, arguments, strict=True):
        np.testing.assert_array_equal(view, array)


@pytest.mark.parametrize(
    ("x", "w", "b", "message"),
    [
        ((2, 8, 4), (3, 3, 5), (5,), r"x has shape \(2, 8, 4\), expected \(batch, frames, 3\)"),
        ((2, 8, 3), (3, 3, 5), (4,), r"b has shape \(4,\), expected \(5,\)"),
        ((2, 8, 3), (4, 3, 5), (5,), "must be odd, got 4"),
        ((2, 8, 3), (3, 3, 5), (5,), "dy has shape"),
    ],
)
def test_a_wrong_shape_names_the_argument(x, w, b, message):
    with pytest.raises(ValueError, match=message):
        fast.conv1d(np.zeros(x), np.zeros(w), np.zeros(b))[1](np.zeros((2, 8, 3)))


@given(frames=st.integers(1, 1000), longest=st.integers(2, 60).map(lambda half: 2 * half))
def test_blocks_hold_every_frame_and_waste_less_than_two_a_block(frames, longest):
    length, count = block_length(frames, longest)
    assert length in range(0, longest + 1, 2)
    assert frames <= length * count < frames + 2 * count
