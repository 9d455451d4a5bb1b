"""Reading many files: the same takes in parallel and from the cache, which knows content alone."""

from __future__ import annotations

import numpy as np
import pytest
from acclaim_files import write_acclaim

from data_synth import make_take
from numpy_cae.motion import Coordinates, load_body, load_motion, write_bvh
from numpy_cae.motion.io.cache import read_bodies


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
    (other,) = read_bodies([moved], coordinates=Coordinates(unit=0.02), cache=cache)
    np.testing.assert_allclose(other.positions, 2 * first.positions)
    moved.write_bytes(moved.read_bytes() + b"\n")
    list(read_bodies([moved], cache=cache))
    assert len(list(cache.iterdir())) == 3


def test_a_damaged_cache_and_one_that_cannot_be_written(paths, tmp_path):
    cache = tmp_path / "cache"
    (first,) = read_bodies(paths[:1], cache=cache)
    (file,) = cache.iterdir()
    data = file.read_bytes()
    for damaged in (b"", data[: len(data) // 2], data[:3000] + b"xxxxxxxx" + data[3008:]):
        file.write_bytes(damaged)
        (again,) = read_bodies(paths[:1], cache=cache)
        np.testing.assert_array_equal(first.positions, again.positions)
    (tmp_path / "file").write_text("")
    (again,) = read_bodies(paths[:1], cache=tmp_path / "file")
    np.testing.assert_array_equal(first.positions, again.positions)
