"""Retrieval computed by hand."""

import numpy as np
import pytest

from numpy_cae.evaluation.retrieval import average_precision, precision_at_1

# Ranked: 1 (alike), 3 (not), 0 (alike), 2 (not); and 2 (not), 0 (not), 3 (alike), 1 (alike).
DISTANCES = np.array([[3.0, 1.0, 4.0, 2.0], [2.0, 9.0, 1.0, 3.0]])
ALIKE = np.array([[True, True, False, False], [False, True, False, True]])


def test_precision_at_1_by_hand():
    np.testing.assert_array_equal(precision_at_1(DISTANCES, ALIKE), [1.0, 0.0])


def test_average_precision_by_hand():
    # Ranks 1 and 3: (1/1 + 2/3) / 2. Ranks 3 and 4: (1/3 + 2/4) / 2.
    np.testing.assert_allclose(average_precision(DISTANCES, ALIKE), [5 / 6, 5 / 12])


def test_an_infinite_distance_leaves_a_motion_out():
    itself = DISTANCES.copy()
    itself[0, 1] = np.inf
    # Ranked: 3 (not), 0 (alike), 2 (not); only one is left to be found, at rank 2.
    assert precision_at_1(itself, ALIKE)[0] == 0
    assert average_precision(itself, ALIKE)[0] == pytest.approx(1 / 2)
    alone = np.array([[np.inf, 1.0]])
    with pytest.raises(ValueError, match="nothing in the gallery is like query 0"):
        average_precision(alone, np.array([[True, False]]))
