"""The up axis and the floor of a file are found, changed to Y and 0, and restored by the writer."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data_synth import make_take
from data_synth.kinds import KINDS
from numpy_cae.mocap import body_positions
from numpy_cae.mocap.coordinates import TO_Y_UP, require_coordinates, turn_as_in_file, turn_y_up
from numpy_cae.mocap.formats.amc import read_amc
from numpy_cae.mocap.formats.read_bvh import read_bvh
from numpy_cae.mocap.formats.rewriting import rewrite_numbers
from numpy_cae.mocap.formats.write_bvh import write_bvh
from numpy_cae.mocap.load import find_motion_files, load_motion
from numpy_cae.motion import Skeleton, positions_to_features


def in_file(motion, up, floor):
    """The motion as a file with this axis up and this floor has it."""
    return turn_as_in_file(replace(motion, up=up, floor=floor))


@pytest.fixture(scope="module")
def walk():
    """A walk of four seconds, which no test changes."""
    return make_take("walk", 1, 4.0, 30.0).motion


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_y_up_on_a_floor_at_0_stays_the_same_object(kind):
    motion = make_take(kind, 3, 4.0, 30.0).motion
    unchanged = turn_y_up(motion)
    assert unchanged.rotations is motion.rotations and unchanged.translations is motion.translations
    assert (unchanged.up, unchanged.floor, unchanged.note) == ("y", 0.0, motion.note)


@pytest.mark.parametrize("up", TO_Y_UP)
@pytest.mark.parametrize("floor", [0.0, 1.0, -0.9, 0.27])
def test_a_walk_of_any_axis_and_floor_is_read_and_written_as_it_was(walk, up, floor, tmp_path):
    path, again = tmp_path / "a.bvh", tmp_path / "b.bvh"
    write_bvh(in_file(walk, up, floor), path)
    motion = load_motion(path, unit=walk.unit)
    assert motion.up == up and motion.floor == pytest.approx(floor, abs=0.06)
    moved = motion.positions() - walk.positions() - [0, floor - motion.floor, 0]
    assert np.abs(moved).max() < 1e-5
    write_bvh(motion, again)
    same, plain = read_bvh(again, unit=walk.unit), read_bvh(path, unit=walk.unit)
    assert np.abs(same.positions() - plain.positions()).max() < 1e-5
    stated = load_motion(path, unit=walk.unit, up=up, floor=floor)
    assert np.abs(stated.positions() - walk.positions()).max() < 1e-5


def test_a_changed_file_of_another_axis_keeps_the_text_of_its_other_frames(tmp_path):
    path, out = tmp_path / "a.bvh", tmp_path / "b.bvh"
    write_bvh(in_file(make_take("walk", 1, 2.0, 30.0).motion, "z", 1.0), path, unit=0.01)
    motion = load_motion(path)
    translations = motion.translations.copy()
    translations[20:30, 0] += [0.1, 0.2, 0.3]
    rewrite_numbers(path, motion, replace(motion, translations=translations), out)
    lines = path.read_text().splitlines()[-60:]
    new_lines = out.read_text().splitlines()[-60:]
    assert [n for n, line in enumerate(lines) if new_lines[n] != line] == list(range(20, 30))
    moved = load_motion(out, up="z", floor=motion.floor).positions() - motion.positions()
    np.testing.assert_allclose(moved[20:30], np.tile([0.1, 0.2, 0.3], (10, 31, 1)), atol=1e-5)


def test_a_floor_above_and_below_stairs_stays():
    walk = make_take("walk", 1, 8.0, 30.0).motion
    for rise in (1.5, -1.5):
        translations = walk.translations.copy()
        translations[len(walk) // 2 :, 0, 1] += rise
        assert turn_y_up(replace(walk, translations=translations)).floor == 0


def test_a_body_that_hangs_in_most_frames_is_turned():
    """A pose estimator whose image axis points down, and which loses the body for some frames."""
    hung = in_file(make_take("walk", 1, 4.0, 30.0).motion, "-y", 0.0)
    hung.rotations[10:45, 0] = [1.0, 0.0, 0.0, 0.0]
    assert turn_y_up(hung).up == "-y"


def laid_down(motion, standing, about):
    """A motion that falls after a share of its time, about an axis, and stays on the floor."""
    first = int(standing * len(motion))
    angle = np.interp(np.arange(len(motion)), [first, first + 15], [0.0, 90.0])
    turn = Rotation.from_euler(about, angle[:, None], degrees=True)
    rotations = motion.rotations.copy()
    rotations[:, 0] = (turn * Rotation.from_quat(rotations[:, 0])).as_quat()
    fallen = replace(motion, rotations=rotations, translations=motion.translations.copy())
    fallen.translations[:, 0, 1] -= fallen.positions()[..., 1].min(axis=1) - 0.03
    return fallen


@pytest.mark.parametrize("up", ["y", "z", "-y"])
@pytest.mark.parametrize("about", ["x", "z"])
@pytest.mark.parametrize("standing", [0.5, 0.2, 0.08])
def test_people_who_fall_and_stay_there_keep_their_axis(up, about, standing):
    fallen = laid_down(make_take("idle", 2, 10.0, 30.0).motion, standing, about)
    assert turn_y_up(in_file(fallen, up, 0.0)).up == up


def test_people_who_crawl_keep_their_axis():
    crawling = laid_down(make_take("walk", 1, 8.0, 30.0).motion, 0.0, "x")
    assert turn_y_up(crawling).up == "y"
    assert turn_y_up(in_file(crawling, "y", 0.0)).up == "y"


def test_an_axis_against_the_rest_pose_is_said_to_be_in_doubt(walk):
    assert "Z up (detected; the rest pose has Y up: --up y" in turn_y_up(in_file(walk, "z", 0)).note
    assert "Z up (as given)" in turn_y_up(in_file(walk, "z", 0), "z").note


def test_a_file_whose_rest_pose_is_z_up_at_the_origin():
    """A body that stands at 0 rests on both axes' floors; the rest pose decides."""
    idle = make_take("idle", 2, 4.0, 30.0).motion
    turned = in_file(idle, "z", 0.0)
    matrix = np.transpose(TO_Y_UP["z"])
    offsets = idle.skeleton.offsets @ matrix.T
    names, parents = idle.skeleton.names, idle.skeleton.parents
    rest = Skeleton(names, parents, offsets, idle.skeleton.end_sites)
    assert turn_y_up(replace(turned, skeleton=rest)).up == "z"


def test_coordinates_that_are_none():
    wrong = [("up", "w", "up is 'w', expected one of y, z"), ("floor", np.nan, "floor is nan")]
    wrong += [("unit", unit, "unit is") for unit in (0, -1, np.nan, np.inf)]
    for name, value, message in wrong:
        with pytest.raises(ValueError, match=message):
            require_coordinates(**dict.fromkeys(("unit", "up", "floor")) | {name: value})


READERS = {".amc": read_amc, ".bvh": read_bvh}


@pytest.mark.parametrize("step", [48, pytest.param(1, marks=pytest.mark.thorough)])
def test_real_files_are_y_up_with_the_floor_at_0_and_found_so_when_turned(data_folder, step):
    paths = [path for path in find_motion_files(data_folder) if path.suffix in READERS]
    for path in paths[::step]:
        plain = READERS[path.suffix](path, max_rate=30.0)
        motion = load_motion(path, max_rate=30.0)
        np.testing.assert_array_equal(plain.rotations, motion.rotations)
        np.testing.assert_array_equal(plain.translations, motion.translations)
        if len(plain) < 10:
            continue  # a pose at the origin rests on two floors
        features, _ = positions_to_features(body_positions(plain), 30.0)
        for up in TO_Y_UP:
            in_y_up = turn_y_up(in_file(plain, up, 0.0))
            assert (in_y_up.up, in_y_up.floor) == (up, 0.0), path
            turned, _ = positions_to_features(body_positions(in_y_up), 30.0)
            np.testing.assert_allclose(turned, features, atol=1e-9)
