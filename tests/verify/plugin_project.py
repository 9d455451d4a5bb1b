"""A project that tests its operations with the plugin; test_plugin copies it as a test file."""

import numpy as np
import pytest

from numpy_cae import verify

BEGUN = []


class Proxy:
    """As flask's current_app outside of an application: whoever looks inside gets an error."""

    @property
    def __dict__(self):
        raise RuntimeError("Working outside of application context")


proxy = Proxy()


@pytest.fixture(autouse=True)
def begun():
    BEGUN.append(1)


@pytest.fixture
def two():
    return 2.0


class Linear:
    """Its constructor draws weights, and it adds to its gradients."""

    def __init__(self):
        self.w = np.random.randn(3, 2)  # noqa: NPY002 -- as layers are written
        self.gradients = {"w": 0.0}

    def forward(self, x):
        self.x = x
        return x @ self.w

    def backward(self, dy):
        self.gradients["w"] = self.gradients["w"] + self.x.T @ dy
        return dy @ self.w.T


@pytest.mark.parametrize("factor", [1.0, 3.0])
@verify.operation_test(shapes={"x": "batch"}, marks={"dtype": pytest.mark.xfail})
def test_scaled(factor, x, two):
    assert BEGUN
    scale = np.array([factor * two])  # makes float64 of float32
    return scale * x, lambda dy: scale * dy


class TestLayers:
    @verify.operation_test(shapes={"x": "batch channels", "w": "channels features"})
    def test_layer(self, x, w):
        return verify.of_layer(Linear, x, weights={"w": w}, gradients=["gradients.w"])

    @staticmethod
    @verify.operation_test(shapes={"x": "batch", "scale": "batch"}, skip=["dtype"])
    def test_static(x, scale):
        return scale * x**3, lambda dy: (dy * scale * 3 * x**2, np.full_like(x, np.mean(dy * x**3)))


@verify.operation_test(shapes={"x": "n"})
def test_crash(x):
    raise KeyError("lost")


@verify.operation_test(shapes={"x": "..."}, values={"x": (-1e4, 1.0)})
def test_sigmoid(x):
    y = 1 / (1 + np.exp(-x))
    return y, lambda dy: dy * y * (1 - y)


@pytest.mark.skip
@verify.operation_test(shapes={"x": "..."})
def test_square(x):
    return x * x, lambda dy: dy * x
