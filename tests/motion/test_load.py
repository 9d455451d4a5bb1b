"""Supported files, found and read, errors for all others; the windows of a folder."""

import pytest
from plain_bvh import HIERARCHY

from data_synth import make_take
from numpy_cae.motion import (
    MotionFileError,
    find_motion_files,
    load_motion,
    load_windows,
    write_bvh,
)

BVH = f"{HIERARCHY}MOTION\nFrames: 1\nFrame Time: 0.04\n0 0 0 0 0 0 0 0 0\n"


def test_suffixes_in_capitals_are_known(tmp_path):
    path = tmp_path / "TAKE.BVH"
    path.write_text(BVH)
    assert load_motion(str(path), unit=1.0).rate == 25


@pytest.mark.parametrize("name", ["take.fbx", "take", "take.csv"])
def test_other_kinds_are_refused_with_what_is_supported(tmp_path, name):
    (tmp_path / name).write_text(BVH)
    with pytest.raises(MotionFileError, match=r"not supported; supported are .bvh .* .amc"):
        load_motion(tmp_path / name)


def test_only_text_that_begins_with_a_long_row_is_motion(tmp_path):
    (tmp_path / "licence.txt").write_text("Terms, conditions, and so on, in words.")
    (tmp_path / "walk.txt").write_text(",".join(["0"] * 117))
    (tmp_path / "damaged.txt").write_text(",".join(["0"] * 116))
    found = [path.name for path in find_motion_files(tmp_path)]
    assert found == ["damaged.txt", "walk.txt"]


def test_motion_files_are_found_in_order_at_any_depth(tmp_path):
    (tmp_path / "b" / "deep").mkdir(parents=True)
    (tmp_path / "folder.bvh").mkdir()
    wanted = [tmp_path / name for name in ("a.bvh", "b/deep/c.AMC", "b/z.bvh")]
    for path in [*wanted, tmp_path / "02.asf", tmp_path / "._a.bvh", tmp_path / "notes.txt"]:
        path.touch()
    assert find_motion_files(tmp_path) == wanted


@pytest.mark.parametrize(
    ("read", "name", "message"),
    [
        (load_motion, "take.bvh", "no such file"),
        (load_motion, "", "is a folder, expected one motion file"),
        (find_motion_files, "", "holds no motion file"),
        (find_motion_files, "none", "no such folder"),
        (find_motion_files, "file", "is a file, expected a folder"),
    ],
)
def test_missing_files_and_folders_are_refused(tmp_path, read, name, message):
    (tmp_path / "file").touch()
    with pytest.raises(MotionFileError, match=message):
        read(tmp_path / name)


def test_windows_of_all_files_of_a_pattern_and_of_some_minutes(tmp_path):
    for seed, kind in enumerate(["walk", "walk", "run"]):
        take = make_take(kind, seed, seconds=3.0, rate=30.0)
        write_bvh(take.motion, tmp_path / f"{kind}_{seed}.bvh", unit=0.01)
    windows = load_windows(tmp_path, length=32, overlap=16)
    assert windows.features.shape[1:] == (32, 63)
    assert len(windows.features) == len(windows.real) == len(windows.takes)
    assert sorted(set(windows.takes)) == [0, 1, 2]
    assert windows.real.all()
    assert set(load_windows(tmp_path, "walk*", length=32, overlap=16).takes) == {0, 1}
    assert set(load_windows(tmp_path, minutes=0.01, length=32, overlap=16).takes) == {0}
    with pytest.raises(MotionFileError, match="no motion file matches"):
        load_windows(tmp_path, "swim*")
