"""The closed form against the normal equations over all masks, and in special cases."""

import numpy as np
import pytest

from numpy_cae.evaluation import LinearDenoiser, Moments
from numpy_cae.evaluation.linear_denoiser import contexts

TAPS, C = 5, 3


@pytest.fixture(scope="module")
def windows():
    """Smooth and correlated, like motion: sums of slow waves."""
    rng = np.random.default_rng(0)
    t = np.arange(40) / 40
    waves = np.stack([np.sin(2 * np.pi * (k * t + rng.random((30, 1)))) for k in (1, 2, 3)], -1)
    return waves @ rng.normal(size=(3, C)) + 0.3 * rng.normal(size=(30, 40, C))


def everywhere(windows):
    return np.ones(windows.shape[:2], dtype=bool)


def test_the_weights_solve_the_normal_equations_over_all_masks(windows):
    """The normal equations summed over all 2^6 masks of six values, each by its probability, have
    the analytic solution."""
    x = windows[:, :, :2]
    moments = Moments.of(x, everywhere(x), taps=3)
    z, p, size = contexts(x, 3).reshape(-1, 6), 0.3, 6
    m, b = np.zeros((size, size)), np.zeros((size, 2))
    for bits in range(2**size):
        mask = np.array([bits >> i & 1 for i in range(size)])
        chance = (1 - p) ** mask.sum() * p ** (size - mask.sum()) / len(z)
        m += chance * (mask * z).T @ (mask * z)
        b += chance * (mask * z).T @ x.reshape(-1, 2)
    solved = moments.solve(1 - p, ridge=0).weights.reshape(size, 2)
    np.testing.assert_allclose(solved, np.linalg.solve(m, b), atol=1e-12)


def test_a_missing_feature_is_the_regression_on_the_others(windows):
    z = contexts(windows, TAPS).reshape(-1, TAPS, C)
    others = z[:, :, 1:].reshape(len(z), -1)
    target = windows.reshape(-1, C)[:, 0]
    by_hand = others @ np.linalg.lstsq(others, target)[0]
    kept = np.array([0.0, 1.0, 1.0])
    filled = (
        Moments.of(windows, everywhere(windows), TAPS).solve(kept, 1e-12).repair(windows * kept)
    )
    np.testing.assert_allclose(filled.reshape(-1, C)[:, 0], by_hand, atol=1e-6)


def test_padded_frames_do_not_count(windows):
    real = everywhere(windows)
    real[:, 30:] = False
    changed = windows.copy()
    changed[:, 30 + TAPS // 2 :] = 100.0
    ours, theirs = (Moments.of(x, real, TAPS).second for x in (windows, changed))
    np.testing.assert_array_equal(ours, theirs)


def test_repair_pads_with_zeros():
    weights = np.zeros((3, 1, 1))
    weights[:, 0, 0] = [100, 10, 1]
    repaired = LinearDenoiser(weights).repair(np.array([1.0, 2.0, 3.0]).reshape(1, 3, 1))
    assert repaired.ravel().tolist() == [12, 123, 230]
