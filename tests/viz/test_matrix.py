"""The clustered matrix: neighbours in the tree stand side by side, and every name is there."""

import numpy as np
import pytest

from numpy_cae.viz.matrix import matrix_figure


def test_what_is_near_stands_side_by_side():
    places = np.array([0.0, 10.0, 0.5, 10.2, 0.1])
    figure = matrix_figure(np.abs(places[:, None] - places), ["a", "B", "c", "D", "e"])
    matrix = figure.axes[1]
    shown = [label.get_text() for label in matrix.get_yticklabels()]
    assert sorted(shown) == ["B", "D", "a", "c", "e"]
    letters = "".join(shown)
    assert "BD" in letters or "DB" in letters
    drawn = matrix.images[0].get_array()
    np.testing.assert_array_equal(drawn, drawn.T)


def test_one_motion_is_no_matrix():
    with pytest.raises(ValueError, match="two motions"):
        matrix_figure(np.zeros((1, 1)), ["alone"])
