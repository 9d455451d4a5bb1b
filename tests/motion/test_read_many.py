"""Reading many files: the same takes in parallel and from the cache, which knows content alone."""

import os
import sys
from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import write_acclaim

from data_synth import make_take
from numpy_cae.array_file import save_arrays
from numpy_cae.motion import Coordinates, Motion, load_body, load_motion, write_bvh
from numpy_cae.motion.read.many import VERSION, default_cache, read_bodies


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("many")
    for seed, rate in enumerate((120.0, 50.0, 30.0)):
        motion = make_take("walk", seed, seconds=1.0, rate=rate).motion
        write_bvh(motion, folder / f"{seed}.bvh", unit=0.01)
    write_acclaim(make_take("run", 3, seconds=1.0, rate=120.0).motion, folder / "9.amc")
    (folder / "bad.bvh").write_text("HIERARCHY\n")
    return sorted(path for path in folder.iterdir() if path.suffix != ".asf")


def same(one, other):
    assert [each.path for each in one] == [each.path for each in other]
    assert [each.note for each in one] == [each.note for each in other]
    for a, b in zip(one, other, strict=True):
        assert (a.positions is None) == (b.positions is None)
        if a.positions is None:
            assert str(a.problem) == str(b.problem)
        else:
            np.testing.assert_array_equal(a.positions, b.positions)


def test_frames_that_are_left_out_change_nothing_of_the_others(paths):
    for body in read_bodies(paths):
        if body.problem is None:
            positions, motion = load_body(body.path)
            np.testing.assert_array_equal(body.positions, positions)
            assert body.note == motion.unit_note
        else:
            assert body.path.name == "bad.bvh"
    sparse = load_motion(paths[0], max_rate=30.0)
    assert (len(sparse), sparse.rate) == (30, 30.0)


def test_in_parallel_and_from_the_cache(paths, tmp_path):
    plain = list(read_bodies(paths))
    same(plain, list(read_bodies(paths, cache=tmp_path / "new" / "cache", processes=2)))
    kept = sorted((tmp_path / "new" / "cache").iterdir())
    assert len(kept) == 4
    times = [path.stat().st_mtime_ns for path in kept]
    same(plain, list(read_bodies(paths, cache=tmp_path / "new" / "cache")))
    assert [path.stat().st_mtime_ns for path in kept] == times


def test_the_cache_knows_content_and_settings(paths, tmp_path):
    moved = tmp_path / "moved.bvh"
    moved.write_bytes(paths[0].read_bytes())
    cache = tmp_path / "cache"
    (first,) = read_bodies(paths[:1], cache=cache)
    (second,) = read_bodies([moved], cache=cache)
    np.testing.assert_array_equal(first.positions, second.positions)
    assert len(list(cache.iterdir())) == 1
    known = Coordinates(unit=0.02, up="-y", floor=0.0)
    (other,) = read_bodies([moved], coordinates=known, cache=cache)
    np.testing.assert_allclose(other.positions, 2 * first.positions * [1, -1, -1], atol=1e-12)
    moved.write_bytes(moved.read_bytes() + b"\n")
    list(read_bodies([moved], cache=cache))
    assert len(list(cache.iterdir())) == 3


def test_an_entry_that_is_damaged_or_poisoned_is_not_used(paths, tmp_path, caplog):
    cache = tmp_path / "cache"
    (first,) = read_bodies(paths[:1], cache=cache)
    (file,) = cache.iterdir()
    data, good = file.read_bytes(), {"format": np.array(VERSION), "note": np.array("")}
    wrong = ("text", first.positions * 1j, first.positions * 1e300, first.positions[:, :19])
    for poison in (b"", data[: len(data) // 2], data[:3000] + b"xxxxxxxx" + data[3008:], *wrong):
        if isinstance(poison, bytes):
            file.write_bytes(poison)
        else:
            save_arrays(good | {"positions": np.array(poison)}, file)
        (again,) = read_bodies(paths[:1], cache=cache)
        np.testing.assert_array_equal(first.positions, again.positions)
        assert "this entry of the cache is not used" in caplog.records[-1].getMessage()
    file.unlink()
    os.mkfifo(file)
    (again,) = read_bodies(paths[:1], cache=cache)
    assert "is not a regular file" in caplog.records[-1].getMessage()
    assert file.is_file()


def test_a_cache_of_another_user_or_that_cannot_be_written_is_not_used(
    paths, tmp_path, caplog, monkeypatch
):
    (tmp_path / "file").write_text("")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "others").mkdir()
    monkeypatch.setattr(os, "getuid", lambda: (tmp_path / "others").stat().st_uid + 1)
    for name in ("file", "pipe", "others"):
        (body,) = read_bodies(paths[:1], cache=tmp_path / name)
        assert body.positions is not None
        assert "this cache is not used" in caplog.records[-1].getMessage()
    assert not list((tmp_path / "others").iterdir())


@pytest.fixture(params=["platformdirs", None])
def _with_and_without_platformdirs(request, monkeypatch):
    if request.param:
        pytest.importorskip("platformdirs", reason="needs the extra cache")
    else:
        monkeypatch.setitem(sys.modules, "platformdirs", None)


@pytest.mark.usefixtures("_with_and_without_platformdirs")
@pytest.mark.skipif(sys.platform != "linux", reason="other systems have other cache folders")
def test_the_default_cache_is_in_the_cache_folder_of_the_user(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert default_cache() == tmp_path / ".cache" / "numpy_cae"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "elsewhere"))
    assert default_cache() == tmp_path / "elsewhere" / "numpy_cae"


@pytest.mark.usefixtures("_with_and_without_platformdirs")
def test_without_a_home_there_is_no_cache(monkeypatch):
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)  # as without HOME and a user
    assert default_cache() is None


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
        ("jump", replace(motion, translations=jump), "of 30 a second"),
    ):
        write_bvh(take, tmp_path / f"{name}.bvh", unit=0.01)
        (body,) = read_bodies([tmp_path / f"{name}.bvh"])
        assert f"{name}.bvh: " in str(body.problem) and message in str(body.problem)


def test_an_unexpected_exception_names_the_file_and_the_others_are_read(paths, monkeypatch):
    def broken(path, *_):
        raise IndexError("index 7 is out of bounds")

    monkeypatch.setattr("numpy_cae.motion.read.load.read_bvh", broken)
    problems = [body.problem for body in read_bodies(paths)]
    assert sum(problem is None for problem in problems) == 1
    assert "0.bvh: cannot be read: IndexError: index 7" in str(problems[0])
