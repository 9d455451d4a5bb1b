"""Quaternions agree with SciPy's rotations; resampling of a motion."""

from itertools import permutations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from numpy_cae.motion import Motion, Skeleton, quaternions

ONE, OTHER = (Rotation.random(50, random_state=seed) for seed in (1, 2))
P, Q = ONE.as_quat(), OTHER.as_quat()
VECTORS = np.random.default_rng(3).normal(size=(50, 3))


def assert_same(q: np.ndarray, expected: Rotation) -> None:
    assert (Rotation.from_quat(q).inv() * expected).magnitude().max() < 1e-14


def test_product_inverse_and_rotated_vectors():
    assert_same(quaternions.product(P, Q), ONE * OTHER)
    assert_same(quaternions.inverse(P), ONE.inv())
    np.testing.assert_allclose(quaternions.rotate(P, VECTORS), ONE.apply(VECTORS), atol=1e-14)
    np.testing.assert_allclose(quaternions.rotate(P[0], VECTORS), ONE[0].apply(VECTORS), atol=1e-14)


def test_rotation_vectors_of_either_sign_and_of_no_rotation():
    vectors = np.vstack([VECTORS, np.zeros(3), [0, 0, 1e-9]])
    assert_same(quaternions.from_vector(vectors), Rotation.from_rotvec(vectors))
    for sign in (1, -1):
        np.testing.assert_allclose(quaternions.to_vector(sign * P), ONE.as_rotvec(), atol=1e-14)
        np.testing.assert_allclose(quaternions.angle(sign * P), ONE.magnitude(), atol=1e-14)
    np.testing.assert_array_equal(quaternions.to_vector(quaternions.IDENTITY), 0)


def test_slerp_takes_the_shorter_way():
    for p, q in zip(P, Q, strict=True):
        expected = Slerp([0, 1], Rotation.from_quat([p, q]))([0, 0.3, 1])
        assert_same(quaternions.slerp(p, -q, np.array([0, 0.3, 1])), expected)


def test_the_nearest_rotation_to_a_matrix_is_no_reflection():
    assert_same(quaternions.nearest(ONE.as_matrix()), ONE)
    matrices = np.random.default_rng(4).normal(size=(50, 3, 3))
    u, _, vt = np.linalg.svd(matrices)
    u[:, :, 2] *= np.linalg.det(u @ vt)[:, None]
    rotations = Rotation.from_quat(quaternions.nearest(matrices)).as_matrix()
    np.testing.assert_allclose(rotations, u @ vt, atol=1e-12)


@pytest.mark.parametrize("order", ["".join(order) for order in permutations("XYZ")])
def test_angles_about_three_axes_and_at_a_pole(order):
    np.testing.assert_allclose(quaternions.to_angles(order, P), ONE.as_euler(order), atol=1e-14)
    angles = 1.5 * VECTORS
    assert_same(quaternions.from_angles(order, angles), Rotation.from_euler(order, angles))
    for pole in (np.pi / 2, -np.pi / 2):
        angles[:, 1] = pole
        turned = quaternions.from_angles(order, angles)
        angles = quaternions.to_angles(order, turned)
        np.testing.assert_array_equal(angles[:, 2], 0)
        assert_same(turned, Rotation.from_euler(order, angles))


RATES = [(120, 30, 4), (1 / 0.0083333, 30, 4), (120, 50, 2.4), (24, 30, 0.8), (29.97, 30, 1)]


@pytest.mark.parametrize(("rate", "new", "step"), RATES)
def test_resampling_sub_samples_and_interpolates(rate, new, step):
    """`step` is the number of frames between two of the result; a rounded rate is the same rate."""
    frames = np.arange(13.0)
    turns = Rotation.from_rotvec(0.1 * frames[:, None] * [0.0, 1.0, 0.0]).as_quat()
    leg = Skeleton(("hip", "knee"), (-1, 0), np.zeros((2, 3)))
    translations = frames[:, None, None] * np.ones((1, 2, 3))
    motion = Motion(leg, rate, np.repeat(turns[:, None], 2, axis=1), translations)
    resampled = motion.resampled(new)
    times = step * np.arange(len(resampled))
    assert resampled.rate == new and 12 - step < times[-1] <= 12
    np.testing.assert_allclose(resampled.translations[:, 1, 0], times, atol=1e-12)
    np.testing.assert_allclose(2 * np.arcsin(resampled.rotations[:, 1, 1]), 0.1 * times, atol=1e-12)
