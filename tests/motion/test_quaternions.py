"""The quick rotations are SciPy's."""

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from numpy_cae.motion.quaternions import from_euler, product

ORDERS = ["".join(order) for n in (1, 2, 3) for order in permutations("XYZ", n)]


@pytest.mark.parametrize("axes", ORDERS + [order.lower() for order in ORDERS])
@pytest.mark.parametrize("degrees", [True, False])
def test_euler_angles(axes, degrees):
    angles = np.random.default_rng(0).uniform(-400, 400, size=(5, 7, len(axes)))
    expected = Rotation.from_euler(axes, angles.reshape(35, -1), degrees=degrees).as_matrix()
    turned = from_euler(axes, angles, degrees)
    assert turned.shape == (5, 7, 4)
    found = Rotation.from_quat(turned.reshape(35, 4)).as_matrix()
    np.testing.assert_allclose(found, expected, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(turned, axis=-1), 1, atol=1e-12)


def test_products_of_many_and_of_one_with_many():
    rng = np.random.default_rng(1)
    one, many = Rotation.random(rng=rng), Rotation.random(9, rng=rng)
    found = product(one.as_quat(), many.as_quat())
    expected = (one * many).as_quat()
    np.testing.assert_allclose(np.abs((found * expected).sum(axis=-1)), 1, atol=1e-12)
