"""Reading many files: the same takes from one process and from several, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import write_acclaim

from data_synth import make_take
from numpy_cae.motion import Motion, load_body, load_motion, write_bvh
from numpy_cae.motion.read.many import read_bodies


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("many")
    for seed, rate in enumerate((120.0, 50.0, 30.0)):
        motion = make_take("walk", seed, seconds=1.0, rate=rate).motion
        write_bvh(motion, folder / f"{seed}.bvh", unit=0.01)
    write_acclaim(make_take("run", 3, seconds=1.0, rate=120.0).motion, folder / "9.amc")
    (folder / "bad.bvh").write_text("HIERARCHY\n")
    return sorted(path for path in folder.iterdir() if path.suffix != ".asf")


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


def test_processes_read_the_same(paths):
    one, other = list(read_bodies(paths)), list(read_bodies(paths, processes=2))
    assert [(each.path, each.note, str(each.problem)) for each in one] == [
        (each.path, each.note, str(each.problem)) for each in other
    ]
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)


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
