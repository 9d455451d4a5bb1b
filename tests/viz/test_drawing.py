"""Strips and curves, also one that grows while a loop runs: the means of blocks."""

import numpy as np
import pytest

from numpy_cae.motion import JOINTS, PARENTS
from numpy_cae.training.state import HELD_OUT
from numpy_cae.viz import Actor, LiveCurve, losses_figure, matrix_figure, strip_figure
from numpy_cae.viz.figures import bones, camera_view


def actor(frames=30, label=""):
    rng = np.random.default_rng(0)
    return Actor(rng.uniform(0, 1.7, size=(frames, len(JOINTS), 3)), PARENTS, label)


@pytest.mark.parametrize(
    ("point", "azimuth", "elevation", "expected"),
    [
        ([1, 0, 0], 0, 0, [1, 0]),  # from the front the left hand is on the right
        ([0, 1, 0], 0, 0, [0, 1]),
        ([0, 0, 1], 0, 0, [0, 0]),
        ([5, 2, 1], 90, 0, [-1, 2]),
        ([0, 0, 1], 0, 30, [0, -0.5]),
    ],
)
def test_the_camera(point, azimuth, elevation, expected):
    assert camera_view(np.array(point), azimuth, elevation) == pytest.approx(expected)


def test_a_bone_for_each_joint_but_the_root():
    points = np.arange(60.0).reshape(20, 3)
    lines = bones(points, PARENTS)
    assert len(lines) == 19 and np.all(lines[0] == [points[PARENTS[1]], points[1]])


def test_a_strip_has_a_row_for_each_motion_and_cuts_nothing_off():
    figure = strip_figure([actor(label="one"), actor(label="two")], rate=30, poses=5)
    assert len(figure.axes) == 2
    for axes in figure.axes:
        assert len(axes.collections) == 5
        times = [text.get_text() for text in axes.texts if text.get_text().endswith(" s")]
        assert times == ["0.0 s", "0.2 s", "0.5 s", "0.7 s", "1.0 s"]

    axes = strip_figure([actor(frames=1)], rate=30).axes[0]
    assert len(axes.collections) == 1
    points = np.concatenate([line for c in axes.collections for line in c.get_segments()])
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert left < points[:, 0].min() and points[:, 0].max() < right
    assert low < points[:, 1].min() and points[:, 1].max() < high


def test_losses_are_drawn_by_epoch():
    """The error on held-out takes, in cm, is in a plot of its own."""
    losses, errors = losses_figure({"a": [2.0, 3.0], "b": [1.0], HELD_OUT: [4.0]}).axes
    first, second = losses.lines
    np.testing.assert_array_equal(first.get_xydata(), [[1, 2], [2, 3]])
    assert second.get_label() == "b"
    assert [line.get_label() for line in errors.lines] == [HELD_OUT]


def test_no_two_curves_have_the_same_line():
    losses = losses_figure({name: [2.0, 1.0] for name in "abcdef"}).axes[0].lines
    assert len({str(line._dash_pattern) for line in losses}) == len(losses) == 6


def test_a_matrix_names_its_rows():
    """Similar motions are neighbours: here a, c, e and b, d, at places on a line."""
    places = np.array([0.0, 9.0, 1.0, 7.0, 2.0])
    axes = matrix_figure(np.abs(places[:, None] - places), list("abcde")).axes[0]
    shown = "".join(label.get_text() for label in axes.get_yticklabels())
    assert shown in ("acedb", "bdeca")
    first = [0, 1, 2, 7, 9] if shown[0] == "a" else [0, 2, 7, 8, 9]
    assert axes.images[0].get_array()[0].tolist() == first
    many = matrix_figure(np.zeros((100, 100)), list(map(str, range(100)))).axes[0]
    assert len(many.get_yticklabels()) == 34


class Display(list):
    """In place of IPython's display and its handle: the points of each figure displayed."""

    def update(self, figure, display_id=None):
        self.append(figure.axes[0].lines[0].get_xydata().tolist())
        return self

    __call__ = update


def test_the_last_drawing_of_a_live_curve_has_every_value(monkeypatch):
    ipython = pytest.importorskip("IPython.display")
    shown = Display()
    monkeypatch.setattr(ipython, "display", shown)
    with LiveCurve("loss", block=2, seconds=1e9) as curve:
        assert not shown
        for value in (4, 2, 1, 3, 5):
            curve.add(value)
    assert shown == [[[1, 4]], [[2, 3], [4, 2], [5, 5]]]
