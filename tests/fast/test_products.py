"""Products in pieces equal whole products, with and without a remainder."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from numpy_cae.fast import products
from numpy_cae.fast.products import multiply_columns, multiply_rows

LENGTH = st.integers(0, 40)


@pytest.fixture(autouse=True)
def small_pieces(monkeypatch):
    monkeypatch.setattr(products, "MAX_UNPACKED", 300)
    monkeypatch.setattr(products, "MAX_UNPACKED_TRANSPOSED", 30)


@given(count=st.integers(0, 4), rows=LENGTH, inner=LENGTH, columns=LENGTH, transposed=st.booleans())
def test_groups_of_rows(count, rows, inner, columns, transposed):
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(count, rows, inner)), rng.normal(size=(count, inner, columns))
    if transposed:
        b = b.transpose(0, 2, 1).copy().transpose(0, 2, 1)
    out = np.full((count, rows, columns), np.nan)
    multiply_rows(a, b, out)
    np.testing.assert_allclose(out, a @ b, atol=1e-12)


@given(count=st.integers(0, 4), rows=LENGTH, inner=LENGTH, width=st.integers(0, 100))
def test_groups_of_columns(count, rows, inner, width):
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(rows, inner)), rng.normal(size=(count, inner, width + 3))[..., :width]
    out = np.full((count, rows, width + 5), np.nan)
    multiply_columns(a, b, out[..., :width])
    np.testing.assert_allclose(out[..., :width], a @ b, atol=1e-12)
    assert np.isnan(out[..., width:]).all()
