"""A file that is cut off after any of its bytes is refused, or only its last number is another."""

import numpy as np
import pytest
from acclaim_files import BONE, HEADER
from plain_bvh import HIERARCHY

from numpy_cae.motion import MotionFileError, load_motion

BVH = f"""{HIERARCHY}MOTION
Frames: 6
Frame Time: 0.0083333
""" + "".join(f"{n} 2 3 4 5 6 7 8 {n}1\n" for n in range(6))
BONES = HEADER.format("0 0 0") + BONE.format("a", "0 1 0").replace("rx ry rz", "rx")
ASF = f"{BONES}:hierarchy\n  begin\n    root a\n  end\n"
AMC = ":DEGREES\n" + "".join(f"{n}\nroot {n} 0 0 0 0 0\na {n}1\n" for n in range(1, 7))
TXT = "".join(",".join(f".{n}{column}" for column in range(99)) + "\n" for n in range(3))
FILES = {"bvh": {"a.bvh": BVH}, "amc": {"a.amc": AMC, "a.asf": ASF}, "txt": {"a.txt": TXT}}
FILES["asf"] = {"a.asf": ASF, "a.amc": AMC}


@pytest.mark.parametrize("max_rate", [None, 30.0])
@pytest.mark.parametrize("kind", FILES)
def test_cut_after_every_byte(tmp_path, kind, max_rate, counted):
    files = FILES[kind]
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    cut, motion = tmp_path / f"a.{kind}", next(name for name in files if name != "a.asf")
    whole = load_motion(tmp_path / motion, max_rate=max_rate)
    data, read = cut.read_bytes(), 0
    for length in range(len(data)):
        cut.write_bytes(data[:length])
        try:
            found = load_motion(tmp_path / motion, max_rate=max_rate)
        except MotionFileError as refused:
            assert str(cut) in str(refused) and "cannot be read: " not in str(refused), length
            continue
        read += 1
        # Only BVH states its number of frames.
        assert len(found) == len(whole) or kind in ("amc", "txt"), length
        last = len(found) - 1
        np.testing.assert_array_equal(found.rotations[:last], whole.rotations[:last])
    counted(f"{kind}, {max_rate}: cut after each of {len(data)} bytes, {read} read")
    assert read < 40


def test_a_cut_in_a_bone_without_values_is_named(tmp_path):
    (tmp_path / "a.asf").write_text(ASF)
    (tmp_path / "a.amc").write_text("1\nroot 0 0 0 0 0 0\na 1\n2\nroot 0 0 0 0 0 0\na ")
    for rate in (None, 30.0):
        with pytest.raises(MotionFileError, match=r"a\.amc:6: bone 'a' has 0 values"):
            load_motion(tmp_path / "a.amc", max_rate=rate)
