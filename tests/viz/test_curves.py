"""Curves and bars show the numbers that they were given."""

import numpy as np

from numpy_cae.viz import Curve, bars_figure, curves_figure


def test_a_curve_is_drawn_through_its_numbers_and_named():
    figure = curves_figure(
        [Curve([0, 1], [2.0, 3.0], "a", "#112233", "--"), Curve([0, 1], [1, 1], "b")], "x", "y, cm"
    )
    first, second = figure.axes[0].lines
    np.testing.assert_array_equal(first.get_ydata(), [2, 3])
    assert (first.get_color(), first.get_linestyle(), second.get_label()) == ("#112233", "--", "b")
    assert (figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()) == ("x", "y, cm")


def test_bars_of_a_group_stand_side_by_side_at_their_name():
    figure = bars_figure(["p", "q"], [("a", [1, 2], None), ("b", [3, 4], "#445566")], "cm")
    bars = figure.axes[0].patches
    assert [bar.get_height() for bar in bars] == [1, 2, 3, 4]
    centres = np.array([bar.get_x() + bar.get_width() / 2 for bar in bars]).reshape(2, 2)
    np.testing.assert_allclose(centres.mean(axis=0), [0, 1])
    assert np.all(centres[0] < centres[1])
