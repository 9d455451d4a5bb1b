"""Drawing: what the camera sees, and pictures that appear whole or not at all."""

import numpy as np
import pytest
from PIL import Image

from numpy_cae.errors import FileError
from numpy_cae.motion import JOINTS, PARENTS
from numpy_cae.viz import Actor, save_figure, save_gif, strip_figure
from numpy_cae.viz.camera import bones, seen


def actor(frames=30, label=""):
    rng = np.random.default_rng(0)
    return Actor(rng.uniform(0, 1.7, size=(frames, len(JOINTS), 3)), PARENTS, label)


def test_the_camera_in_front_sees_the_left_hand_on_its_right_and_up_as_up():
    left, up, near = np.eye(3)
    assert seen(left, azimuth=0, elevation=0) == pytest.approx([1, 0])
    assert seen(up, azimuth=0, elevation=0) == pytest.approx([0, 1])
    assert seen(near, azimuth=0, elevation=0) == pytest.approx([0, 0])


def test_the_camera_at_ninety_degrees_looks_along_x():
    assert seen(np.array([5.0, 2.0, 1.0]), azimuth=90, elevation=0) == pytest.approx([-1, 2])


def test_a_higher_camera_sees_what_is_near_lower():
    assert seen(np.array([0.0, 0.0, 1.0]), azimuth=0, elevation=30)[1] == pytest.approx(-0.5)


def test_a_bone_for_each_joint_but_the_root():
    points = np.arange(60.0).reshape(20, 3)
    lines = bones(points, PARENTS)
    assert lines.shape == (19, 2, 3)
    np.testing.assert_array_equal(lines[0], [points[PARENTS[1]], points[1]])


def test_a_root_on_the_floor_has_no_bone():
    assert len(bones(np.zeros((4, 2)), (-1, 0, 1, 1))) == 2


def test_a_strip_has_a_row_a_motion_and_shows_every_pose_once():
    figure = strip_figure([actor(label="one"), actor(label="two")], rate=30, poses=5)
    assert len(figure.axes) == 2
    for axes in figure.axes:
        assert len(axes.collections) == 5
        times = [text.get_text() for text in axes.texts if text.get_text().endswith(" s")]
        assert times == ["0.0 s", "0.2 s", "0.5 s", "0.7 s", "1.0 s"]


def test_nothing_drawn_is_cut_off():
    figure = strip_figure([actor()], rate=30, poses=4)
    axes = figure.axes[0]
    points = np.concatenate([line for c in axes.collections for line in c.get_segments()])
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert left < points[:, 0].min() and points[:, 0].max() < right
    assert low < points[:, 1].min() and points[:, 1].max() < high


def test_a_motion_of_one_frame_makes_a_strip_of_one_pose():
    assert len(strip_figure([actor(frames=1)], rate=30).axes[0].collections) == 1


def test_a_gif_has_the_asked_frames(tmp_path):
    file = tmp_path / "a.gif"
    save_gif([actor(), actor()], file, rate=30, fps=15)
    with Image.open(file) as picture:
        assert picture.n_frames == 15
        assert picture.info["duration"] in (60, 67, 70)
    assert list(tmp_path.iterdir()) == [file]


def test_a_picture_that_cannot_be_written_leaves_nothing(tmp_path):
    with pytest.raises(FileError, match="no folder"):
        save_figure(strip_figure([actor()], 30), tmp_path / "no" / "a.png")
    assert not list(tmp_path.iterdir())


def test_an_animation_is_as_wide_as_a_body_that_lies_down(tmp_path):
    lying = np.zeros((2, len(JOINTS), 3))
    lying[:, -1, 0] = 1.3
    for name, positions in (("narrow", 0.5 * lying), ("wide", lying)):
        save_gif([Actor(positions, PARENTS)], tmp_path / f"{name}.gif", rate=30, azimuth=0)
    widths = [Image.open(tmp_path / f"{name}.gif").size[0] for name in ("narrow", "wide")]
    assert widths[1] == pytest.approx(widths[0] * 1.4 / 0.9, abs=2)
