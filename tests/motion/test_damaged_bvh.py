"""Every damage to a BVH file is refused, with its line and what was expected there."""

import re

import pytest
from plain_bvh import HIERARCHY

from numpy_cae.motion import MotionFileError, read_bvh

WHOLE = f"""{HIERARCHY}MOTION
Frames: 3
Frame Time: 0.025
1 2 3 4 5 6 7 8 9
1 2 3 4 5 6 7 8 9
1 2 3 4 5 6 7 8 9
"""
ROW = "1 2 3 4 5 6 7 8 9"
LAST = f"{ROW}\n{ROW}\n{ROW}\n"


def swap(old: str, new: str) -> str:
    assert old in WHOLE
    return WHOLE.replace(old, new, 1)


DAMAGES = {
    # what is wrong: (text, line, words of the message)
    "too few values": (swap(LAST, f"{ROW}\n1 2 3\n{ROW}\n"), 20, ["3 values", "expected 9"]),
    "too many values": (swap(LAST, f"{ROW} 10\n{ROW}\n{ROW}\n"), 19, ["10 values", "expected 9"]),
    "a frame cut off": (swap(LAST, f"{ROW}\n{ROW}\n1 2 3 4"), 21, ["4 values", "expected 9"]),
    "a thousand million frames": (swap("Frames: 3", "Frames: 1000000000"), 17, ["says 1000000000",
         "3 lines"]),
    "frames of too many digits": (swap("Frames: 3", "Frames: " + "9" * 5000), 17, ["whole number"]),
    "no frames said": (swap("Frames: 3", "Frames: 0"), 17, ["'0'", "above 0"]),
    "no Frames line": (swap("Frames: 3\n", ""), 17, ["expected Frames:", "Frame Time"]),
    "no Frame Time line": (swap("Frame Time: 0.025\n", ""), 18, ["expected Frame Time:", ROW]),
    "frame time zero": (swap("0.025", "0"), 18, ["Frame Time: 0", "above 0"]),
    "frame time not a number": (swap("0.025", "fast"), 18, ["'fast'", "number"]),
    "NaN": (swap(LAST, f"{ROW}\n{ROW}\n1 2 nan 4 5 6 7 8 9\n"), 21, ["'nan'", "finite"]),
    "not a number": (swap(LAST, f"1 2 3 4 x 6 7 8 9\n{ROW}\n{ROW}"), 19, ["'x'", "number"]),
    "missing HIERARCHY": (swap("HIERARCHY\n", ""), 1, ["expected HIERARCHY", "ROOT Hips"]),
    "missing MOTION": (WHOLE[: WHOLE.index("MOTION")], 15, ["ends without MOTION"]),
    "MOTION line lost": (swap("MOTION\n", ""), 16, ["'Frames: 3'", "MOTION"]),
    "cut off in the hierarchy": (WHOLE[: WHOLE.index("    End")], 9, ["'Leg'", "MOTION"]),
    "cut off below MOTION": (WHOLE[: WHOLE.index("Frames")], 16, ["ends below MOTION", "Frames:"]),
    "a brace too few": (swap("}\nMOTION", "MOTION"), 15, ["'Hips'", "1 '}' missing"]),
    "a brace too many": (swap("}\nMOTION", "}\n}\nMOTION"), 16, ["'}' closes nothing"]),
    "missing OFFSET": (swap("    OFFSET 0 -40 0\n", ""), 6, ["'Leg'", "no OFFSET"]),
    "two OFFSETs": (swap("-40 0\n", "-40 0\nOFFSET 1 1 1\n"), 9, ["second OFFSET", "'Leg'"]),
    "unknown channel": (swap("Xposition", "Xscale"), 5, ["'Xscale'", "Xposition"]),
    "more channels than said": (swap("CHANNELS 3", "CHANNELS 2"), 9, ["'2'", "names 3"]),
    "a channel twice": (swap("3 Zrotation X", "3 Yrotation X"), 9, ["twice", "Yrotation"]),
    "CHANNELS in an End Site": (swap("-45 0\n", "-45 0\nCHANNELS 1 Xrotation\n"), 13, ["End Site",
         "no CHANNELS"]),
    "no channels anywhere": (re.sub(r" *CHANNELS.*\n", "", WHOLE).replace(ROW, ""), 14,
         ["no joint has CHANNELS"]),
    "a name twice": (swap("JOINT Leg", "JOINT Hips"), 6, ["'Hips'", "second time", "line 2"]),
    "two roots": (swap("}\nMOTION", "}\nROOT Other\n{\n}\nMOTION"), 16, ["second ROOT",
         "skeletons"]),
    "a joint in an End Site": (swap("      OFFSET 0 -45 0\n", "OFFSET 0 -45 0\nJOINT Toe\n{\n}\n"),
         13, ["'Toe'", "inside the End Site of joint 'Leg'"]),
    "something else": (swap("  JOINT Leg", "  LIMB Leg"), 6, ["'LIMB Leg'", "JOINT"]),
    "empty": ("", None, ["empty"]),
    "binary": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", None, ["binary", "plain text"]),
    "binary without zeros": (bytes(range(128, 256)), 1, ["expected HIERARCHY"]),
}  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_is_refused_with_its_line(tmp_path, damage):
    text, line, words = DAMAGES[damage]
    path = tmp_path / "take.bvh"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(MotionFileError) as refused:
        read_bvh(path)
    message = str(refused.value)
    assert refused.value.line == line, message
    assert refused.value.path == path
    assert message.startswith(str(path) if line is None else f"{path}:{line}: ")
    for word in words:
        assert word in message
    assert len(message) < 400 + len(str(path))


def test_the_undamaged_file_is_read(tmp_path):
    path = tmp_path / "take.bvh"
    path.write_text(WHOLE)
    assert len(read_bvh(path)) == 3


@pytest.mark.parametrize("line", range(WHOLE.count("\n")))
def test_a_file_that_lost_any_line_is_refused(tmp_path, line):
    path = tmp_path / "take.bvh"
    lines = WHOLE.splitlines(keepends=True)
    path.write_text("".join(lines[:line] + lines[line + 1 :]))
    with pytest.raises(MotionFileError):
        read_bvh(path)
