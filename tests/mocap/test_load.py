"""Supported files, found and read, one or many, and errors for all others; windows of a folder."""

from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import FILES, write_acclaim

from data_synth import make_take
from numpy_cae.mocap import MotionFileError, load_windows, write_bvh
from numpy_cae.mocap.bodies import read_body, read_files
from numpy_cae.mocap.load import find_motion_files, load_body, load_motion
from numpy_cae.motion import Motion

BVH = (FILES / "leg.bvh").read_text()


def test_motion_files_are_found_in_order_at_any_depth(tmp_path):
    (tmp_path / "b" / "deep").mkdir(parents=True)
    (tmp_path / "folder.bvh").mkdir()
    paths = [tmp_path / name for name in ("a.bvh", "b/deep/c.BVH", "b/z.amc", "damaged.txt")]
    for path in [*paths, tmp_path / "02.asf", tmp_path / "._a.bvh", tmp_path / "notes.txt"]:
        path.write_text(BVH)
    paths[-1].write_text(",".join(["0"] * 116))  # a row of numbers is motion, words are not
    assert find_motion_files(tmp_path) == paths
    assert load_motion(str(paths[1]), unit=1.0).rate == 40


@pytest.mark.parametrize(
    ("read", "name", "message"),
    [
        (load_motion, "take.bvh", "no such file"),
        (load_motion, "take.fbx", r"not supported; supported are .bvh .* .amc"),
        (load_motion, "file", "a file without suffix is not supported"),
        (load_motion, "", "is a folder, expected one motion file"),
        (find_motion_files, "", "holds no motion file"),
        (find_motion_files, "none", "no such folder"),
        (find_motion_files, "file", "is a file, expected a folder"),
    ],
)
def test_missing_files_folders_and_other_kinds_are_refused(tmp_path, read, name, message):
    for existing in ("file", "take.fbx"):
        (tmp_path / existing).touch()
    with pytest.raises(MotionFileError, match=message):
        read(tmp_path / name)


def test_windows_of_all_files_of_a_pattern_and_of_some_minutes(tmp_path):
    for seed, kind in enumerate(["walk", "walk", "run"]):
        take = make_take(kind, seed, seconds=3.0, rate=30.0)
        write_bvh(take.motion, tmp_path / f"{kind}_{seed}.bvh", unit=0.01)
    windows = load_windows(tmp_path, length=32, overlap=16)
    assert windows.features.shape == (len(windows.takes), 32, 63)
    assert windows.real.all() and set(windows.takes) == {0, 1, 2}
    assert set(load_windows(tmp_path, "walk*", length=32, overlap=16).takes) == {0, 1}
    assert set(load_windows(tmp_path, minutes=0.01, length=32, overlap=16).takes) == {0}
    with pytest.raises(MotionFileError, match="no motion file matches"):
        load_windows(tmp_path, "swim*")


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("many")
    for seed, rate in enumerate((120.0, 50.0)):
        motion = make_take("walk", seed, seconds=1.0, rate=rate).motion
        write_bvh(motion, folder / f"{seed}.bvh", unit=0.01)
    write_acclaim(make_take("run", 3, seconds=1.0, rate=120.0).motion, folder / "9.amc")
    (folder / "bad.bvh").write_text("HIERARCHY\n")
    return sorted(path for path in folder.iterdir() if path.suffix != ".asf")


def test_frames_that_are_left_out_change_nothing_of_the_others(paths):
    for path, body in zip(paths, read_files(paths, read_body), strict=True):
        if path.name != "bad.bvh":
            positions, motion = load_body(path)
            np.testing.assert_array_equal(body[0], positions)
            assert body[1] == motion.notes
    sparse = load_motion(paths[0], max_rate=30.0)
    assert (len(sparse), sparse.rate) == (30, 30.0)


def test_processes_read_the_same(paths):
    in_one_process, in_two = (list(read_files(paths, read_body, processes)) for processes in (1, 2))
    *good, bad = zip(in_one_process, in_two, strict=True)
    assert str(bad[0]) == str(bad[1]) and "bad.bvh" in str(bad[0])
    for (positions, notes), (other_positions, other_notes) in good:
        assert notes == other_notes
        np.testing.assert_array_equal(positions, other_positions)


def test_bodies_that_are_no_persons_and_jumps_are_named(paths, tmp_path):
    motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    joint = motion.skeleton.index("lfemur")

    def changed(factor: float, joints: slice) -> Motion:
        offsets, translations = motion.skeleton.offsets.copy(), motion.translations.copy()
        offsets[joints] *= factor
        translations[:, joints] *= factor
        skeleton = replace(motion.skeleton, offsets=offsets)
        return replace(motion, skeleton=skeleton, translations=translations)

    jump = motion.translations.copy()
    jump[10, 0] += 1e9
    for name, take, message in (
        ("hip", changed(0.0, slice(joint - 1, joint + 1)), "bone to left_hip has no length"),
        ("giant", changed(1e5, slice(None)), "expected 0.05 to 20 m; is the unit another"),
        ("jump", replace(motion, translations=jump), "(at 30 a second)"),
    ):
        write_bvh(take, tmp_path / f"{name}.bvh", unit=0.01)
        (problem,) = read_files([tmp_path / f"{name}.bvh"], read_body)
        assert f"{name}.bvh: " in str(problem) and message in str(problem)


def test_an_unexpected_exception_names_the_file_and_the_others_are_read(paths, monkeypatch):
    def broken(path, *_):
        raise IndexError("index 7 is out of bounds")

    monkeypatch.setattr("numpy_cae.mocap.load.read_bvh", broken)
    read = list(read_files(paths, read_body))
    assert sum(isinstance(body, tuple) for body in read) == 1
    assert "0.bvh: cannot be read: IndexError: index 7" in str(read[0])
