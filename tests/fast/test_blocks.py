"""Blocks of frames and their constant matrices give the convolution of the definition."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.fast.blocks import block_length, blocks, overlap_add, overlapping


@settings(max_examples=100)
@given(
    frames=st.integers(1, 60),
    taps=st.integers(0, 12).map(lambda half: 2 * half + 1),
    seed=st.integers(0, 2**32 - 1),
)
def test_the_three_matrices_correlate_frames_with_taps(frames, taps, seed):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=frames + taps - 1)
    w = rng.normal(size=taps)
    matrices = blocks(taps, frames)
    y = matrices.c @ ((matrices.a @ x) * (matrices.g @ w))
    np.testing.assert_allclose(y, np.correlate(x, w, "valid"), atol=1e-12)


@given(taps=st.integers(0, 12).map(lambda half: 2 * half + 1), frames=st.integers(1, 60))
def test_three_products_for_two_points(taps, frames):
    points = frames + taps - 1
    assert blocks(taps, frames).products <= 3 * points / 2 + 1


def test_the_matrices_of_a_cache_cannot_be_written():
    matrices = blocks(5, 8)
    assert not any(matrix.flags.writeable for matrix in (matrices.a, matrices.g, matrices.c))


@given(count=st.integers(1, 5), half=st.integers(1, 8), taps=st.integers(1, 9))
def test_adding_blocks_up_is_the_adjoint_of_cutting_them(count, half, taps):
    rng = np.random.default_rng(0)
    matrices = blocks(taps, 2 * half)
    rows = count * matrices.frames + taps - 1
    x = rng.normal(size=(rows, 3))
    parts = rng.normal(size=(count, matrices.points, 3))
    added = np.empty_like(x)
    overlap_add(parts, matrices, added)
    assert np.isclose(np.sum(overlapping(x, matrices, count) * parts), np.sum(x * added))


@given(frames=st.integers(1, 1000), longest=st.integers(2, 60).map(lambda half: 2 * half))
def test_blocks_hold_every_frame_and_waste_less_than_two_a_block(frames, longest):
    length, count = block_length(frames, longest)
    assert length in range(0, longest + 1, 2)
    assert frames <= length * count < frames + 2 * count
