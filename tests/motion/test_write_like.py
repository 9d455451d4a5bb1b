"""A changed motion is written as the text of its file, with only the changed numbers replaced."""

import logging
import re
from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import write_acclaim
from scipy.spatial.transform import Rotation

from data_synth import make_take
from numpy_cae.motion import MotionFileError, load_motion, write_bvh, write_like

HIERARCHY = """HIERARCHY
ROOT Hips {
\tOFFSET 0 0 0
\tCHANNELS 6 Yrotation Xrotation Zrotation Zposition Yposition Xposition
\tJOINT Knee
\t{
\t\tOFFSET 0 -40.5 0
\t\tCHANNELS 6 Xposition Yposition Zposition Xrotation Zrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 -40 0
\t\t}
\t}
}
MOTION
Frames:\t12
Frame Time: .0333333
"""


def odd_file(path):
    """Several separators, CRLF, a blank line, a wrap from 179 to -179 in frame 6."""
    rows = [
        f"\t{(170 + 3 * n + 180) % 360 - 180:.3f}  -{n}.250 1.000 {n}.5 90.000 0.125"
        f"\t0.000 -40.500 0 {10 + n}.125 20.000 -0.000 "
        for n in range(12)
    ]
    text = HIERARCHY + "\n".join(rows[:7]) + "\n\n" + "\n".join(rows[7:]) + "\n"
    path.write_bytes(text.replace("\n", "\r\n").encode())


def turned(motion, joint, frames, angle=0.2):
    rotations = motion.rotations.copy()
    more = Rotation.from_rotvec([0.0, angle, angle / 2])
    rotations[frames, joint] = (Rotation.from_quat(rotations[frames, joint]) * more).as_quat()
    return replace(motion, rotations=rotations)


def words(path):
    return [re.split(r"(\s+)", line) for line in path.read_bytes().decode().split("MOTION")[1:]]


def test_an_unchanged_bvh_file_is_written_byte_for_byte(tmp_path):
    odd_file(tmp_path / "odd.bvh")
    motion = load_motion(tmp_path / "odd.bvh", unit=0.01)
    write_like(tmp_path / "odd.bvh", motion, motion, tmp_path / "same.bvh")
    assert (tmp_path / "same.bvh").read_bytes() == (tmp_path / "odd.bvh").read_bytes()


def test_only_the_numbers_of_changed_rotations_and_translations_differ(tmp_path):
    odd_file(tmp_path / "odd.bvh")
    motion = load_motion(tmp_path / "odd.bvh", unit=0.01)
    after = turned(motion, 1, slice(3, 5))
    after = replace(after, translations=motion.translations.copy())
    after.translations[4, 0, 1] += 0.05
    write_like(tmp_path / "odd.bvh", motion, after, tmp_path / "new.bvh")
    (old,), (new,) = words(tmp_path / "odd.bvh"), words(tmp_path / "new.bvh")
    assert len(old) == len(new)
    # Six words before the first frame: Frames:, 12, Frame, Time:, .0333333.
    changed = [divmod(place // 2 - 6, 12) for place in range(len(old)) if old[place] != new[place]]
    assert changed == [(3, 9), (3, 10), (3, 11), (4, 4), (4, 9), (4, 10), (4, 11)]
    again = load_motion(tmp_path / "new.bvh", unit=0.01)
    np.testing.assert_allclose(again.positions(), after.positions(), atol=1e-5)


def test_angles_jump_only_where_those_of_the_file_do(tmp_path):
    odd_file(tmp_path / "odd.bvh")
    motion = load_motion(tmp_path / "odd.bvh", unit=0.01)
    write_like(tmp_path / "odd.bvh", motion, turned(motion, 0, slice(2, 9)), tmp_path / "new.bvh")
    for path in ("odd.bvh", "new.bvh"):
        lines = (tmp_path / path).read_text().split(".0333333")[1].split("\n")
        table = np.array([line.split() for line in lines if line.strip()], dtype=float)
        angles = table[:, [0, 1, 2, 9, 10, 11]]
        assert np.argwhere(np.abs(np.diff(angles, axis=0)) > 90).tolist() == [[3, 0]]


def test_an_acclaim_file_is_written_as_one(tmp_path, caplog):
    take = make_take("walk", 1, seconds=0.5, rate=30.0).motion
    source = tmp_path / "one.amc"
    write_acclaim(take, source)
    source.write_text("# by hand\n" + source.read_text().replace("\nlfemur", "  # hips\nlfemur", 3))
    motion = load_motion(source)
    write_like(source, motion, motion, tmp_path / "same.amc")
    assert (tmp_path / "same.amc").read_bytes() == source.read_bytes()

    femur, tibia = (motion.skeleton.index(name) for name in ("lfemur", "ltibia"))
    after = turned(turned(motion, femur, [4, 5]), tibia, [5])
    write_like(source, motion, after, tmp_path / "new.amc")
    lines = zip(source.open(), (tmp_path / "new.amc").open(), strict=True)
    changed = [one.split()[0] for one, other in lines if one != other]
    assert changed == ["lfemur", "lfemur", "ltibia"]
    again = load_motion(tmp_path / "new.amc")
    np.testing.assert_allclose(again.positions(), after.positions(), atol=1e-6)

    skeleton = tmp_path / "one.asf"
    before, tibia_on = skeleton.read_text().split("name ltibia")
    limited = tibia_on.replace(
        "dof rx ry rz", "dof rx ry rz\n limits (-180 180)\n (-2 2)\n (-2 2)", 1
    )
    skeleton.write_text(f"{before}name ltibia{limited}")
    with caplog.at_level(logging.WARNING):
        write_like(source, motion, after, tmp_path / "limited.amc")
    assert "do not allow: ltibia" in caplog.text
    row = next(
        line
        for line in (tmp_path / "limited.amc").read_text().split("\n6\n")[1].split("\n")
        if line.startswith("ltibia")
    )
    assert np.all(np.abs(np.array(row.split()[2:], dtype=float)) <= 2)


def test_another_suffix_gives_bvh_and_a_source_that_changed_is_refused(tmp_path):
    motion = make_take("walk", 1, seconds=0.5, rate=30.0).motion
    write_bvh(motion, tmp_path / "a.bvh")
    motion = load_motion(tmp_path / "a.bvh")
    short = motion.at(slice(0, 10))
    write_like(tmp_path / "a.bvh", motion, short, tmp_path / "short.bvh")
    assert len(load_motion(tmp_path / "short.bvh")) == 10
    with pytest.raises(MotionFileError, match="has changed since it was read"):
        write_like(tmp_path / "a.bvh", short, short, tmp_path / "b.bvh")
    assert not (tmp_path / "b.bvh").exists()
