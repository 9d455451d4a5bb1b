"""Forward derivatives, second derivatives, and operations of complex numbers."""

import numpy as np
import pytest
from failing_properties import failing

from numpy_cae import verify

RNG = np.random.default_rng(0)
X = RNG.normal(size=(2, 3))
W = RNG.normal(size=(3, 4))


def product(x, w):
    return x @ w, lambda dy: (dy @ w.T, x.T @ dy)


def product_doubled(x, w):
    return x @ w, lambda dy: (dy @ w.T, 2 * x.T @ dy)


def forward(x, w):
    return x @ w, lambda dx, dw: dx @ w + x @ dw


def forward_with_wrong_sign(x, w):
    return x @ w, lambda dx, dw: dx @ w - x @ dw


def second(x, w, dy):
    def pullback(of_gradients):
        for_dx, for_dw = of_gradients
        return dy @ for_dw.T, for_dx.T @ dy, for_dx @ w + x @ for_dw

    return pullback


def second_doubled(x, w, dy):
    def pullback(of_gradients):
        for_dx, for_dw = of_gradients
        return dy @ for_dw.T, 2 * for_dx.T @ dy, for_dx @ w + x @ for_dw

    return pullback


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_right_forward_derivative_passes(dtype):
    verify.check_jvp(product, forward, X.astype(dtype), W.astype(dtype))


def test_a_wrong_forward_derivative_is_refused_by_differences():
    with pytest.raises(AssertionError, match="along w is not that of differences"):
        verify.check_jvp(product, forward_with_wrong_sign, X, W)


def test_a_pullback_that_disagrees_with_forward_mode_is_refused():
    with pytest.raises(AssertionError, match="pullback disagrees with forward mode along w"):
        verify.check_jvp(product_doubled, forward, X, W)


def test_another_value_of_forward_mode_is_refused():
    with pytest.raises(AssertionError, match="another value"):
        verify.check_jvp(product, lambda x, w: (x @ w + 1, forward(x, w)[1]), X, W)


def test_right_second_derivatives_pass():
    verify.check_second_derivatives(product, second, X, W)


def test_wrong_second_derivatives_are_refused():
    with pytest.raises(AssertionError, match="of the gradients of f: the gradient for w"):
        verify.check_second_derivatives(product, second_doubled, X, W)


def test_the_hessian_of_a_loss_is_checked():
    def loss(x):
        return np.mean(x**4), lambda dloss=1.0: float(dloss) * 4 * x**3 / x.size

    def hessian(x, dloss):
        return lambda v: (dloss * 12 * x**2 / x.size * v, np.sum(4 * x**3 / x.size * v))

    verify.check_second_derivatives(loss, hessian, X)


PAIRS = {"a": "n 2", "b": "n 2"}


def test_a_product_of_complex_numbers_has_every_property():
    def multiply(a, b):
        return a * b, lambda dy: (np.conj(b) * dy, np.conj(a) * dy)

    assert failing(verify.of_complex(multiply), PAIRS) == []


def test_a_conjugate_that_is_missing_is_found():
    def multiply(a, b):
        return a * b, lambda dy: (b * dy, np.conj(a) * dy)

    assert "gradient for a" in failing(verify.of_complex(multiply), PAIRS)


def test_real_and_complex_arguments_may_be_mixed():
    def scale(s, z):
        return s * z, lambda dy: (np.real(np.conj(z) * dy), s * dy)

    scaled = verify.of_complex(scale, real_arguments=[0])
    verify.check_gradients(scaled, np.array([1.0, 2.0]), X[:, :2])


def test_a_real_value_of_complex_numbers_stays_real():
    def modulus(z):
        size = np.abs(z)
        return size, lambda dy: dy * z / size

    verify.check_gradients(verify.of_complex(modulus), X[:, :2])
