"""The three matrices: what they compute, and that they save what they are for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from numpy_cae.fast.blocks import block_length, blocks, overlap_add, overlapping


@given(taps=st.integers(1, 25), frames=st.integers(1, 60), seed=st.integers(0, 2**32 - 1))
def test_one_block_is_a_correlation(taps, frames, seed):
    """y[t] = Σ_k x[t + k] w[k], against NumPy's own."""
    rng = np.random.default_rng(seed)
    matrices = blocks(taps, frames)
    x, w = rng.normal(size=matrices.points), rng.normal(size=taps)
    y = matrices.c @ ((matrices.a @ x) * (matrices.g @ w))
    np.testing.assert_allclose(y, np.correlate(x, w, mode="valid"), atol=1e-11)


@given(frames=st.integers(1, 1000), longest=st.integers(2, 60).map(lambda half: 2 * half))
def test_blocks_hold_every_frame_and_waste_less_than_two_a_block(frames, longest):
    length, count = block_length(frames, longest)
    assert length % 2 == 0
    assert length <= longest
    assert frames <= length * count < frames + 2 * count


@given(taps=st.integers(1, 20), frames=st.integers(1, 12), count=st.integers(1, 6))
def test_overlap_add_is_the_adjoint_of_overlapping(taps, frames, count):
    rng = np.random.default_rng(taps)
    matrices = blocks(taps, frames)
    padded = rng.normal(size=(count * frames + taps - 1, 3))
    parts = rng.normal(size=(count, matrices.points, 3))
    out = np.full_like(padded, np.nan)
    overlap_add(parts, matrices, out)
    cut = overlapping(padded, matrices, count)
    assert np.vdot(cut, parts) == pytest.approx(np.vdot(padded, out), abs=1e-10)
