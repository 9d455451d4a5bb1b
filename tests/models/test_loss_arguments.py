"""The optional arguments of the loss, and dtypes."""

import numpy as np
import pytest

from numpy_cae.models import ConvAutoencoder

RNG = np.random.default_rng(0)
MODEL = ConvAutoencoder(3, (4, 5), taps=3, rng=RNG, dtype=np.float64)
X, CORRUPTED = RNG.normal(scale=0.3, size=(2, 2, 8, 3))


@pytest.mark.parametrize("options", [{}, {"alpha": 0.3}, {"alpha": 0.3, "first": [None, None]}])
def test_the_loss_is_equation_3(options):
    loss, _ = MODEL.loss_and_gradients(X, CORRUPTED, **options)
    y = MODEL.encode(CORRUPTED)
    sparsity = options.get("alpha", 0.0) * np.mean(np.abs(y))
    expected = np.mean((MODEL.decode(y) - X) ** 2) + sparsity
    assert loss == pytest.approx(expected, rel=1e-12)


def test_each_mask_is_used_by_its_own_layer():
    masks = [RNG.random((2, 4, 4)) < 0.5, RNG.random((2, 2, 5)) < 0.5]
    loss, _ = MODEL.loss_and_gradients(X, CORRUPTED, first=masks)
    lower, upper = MODEL.layers
    below = upper.decode_with_pullback(MODEL.encode(CORRUPTED), masks[1])[0]
    x_hat = lower.decode_with_pullback(below, masks[0])[0]
    assert loss == pytest.approx(np.mean((x_hat - X) ** 2), rel=1e-12)
    evenly, _ = MODEL.loss_and_gradients(X, CORRUPTED)
    assert abs(loss - evenly) > 1e-3


def test_a_mask_of_numbers_is_named_with_its_dtype():
    masks = [np.ones((2, 4, 4), dtype=bool), np.ones((2, 2, 5), dtype=np.int8)]
    with pytest.raises(ValueError, match=r"first\[1\] has dtype int8, expected bool"):
        MODEL.loss_and_gradients(X, CORRUPTED, first=masks)


def test_float32_stays_float32():
    model = ConvAutoencoder(3, (4, 5), taps=3)
    x = X.astype(np.float32)
    y, encode_back = model.layers[0].encode_with_pullback(x)
    for first in (None, np.ones(y.shape, dtype=bool)):
        decoded, decode_back = model.layers[0].decode_with_pullback(y, first)
        arrays = [y, decoded, *encode_back(y), *decode_back(decoded)]
        assert {array.dtype for array in arrays} == {np.dtype(np.float32)}
    _, gradients = model.loss_and_gradients(x, x, 0.1)
    assert {g.dtype for pair in gradients for g in pair} == {np.dtype(np.float32)}
