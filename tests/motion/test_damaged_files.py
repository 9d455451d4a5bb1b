"""Whatever happened to a motion file: it is read, all finite, or refused with its file and line.

    pytest -m thorough tests/motion/test_damaged_files.py

mutates 100,000 files in 100 parts and cuts each format after every byte. A part that has been
counted is not repeated until the code changes, so that an interrupted run is resumed by the same
command; `pytest --cache-clear` begins anew.
"""

import hashlib
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from acclaim_files import AMC, ASF
from mutations import mutated
from plain_bvh import HIERARCHY

import numpy_cae.motion
from numpy_cae.motion import MotionFileError, load_motion

ROW = "1 2 3 4 5 6 7 8 9\n"
BVH = f"{HIERARCHY}MOTION\nFrames: 3\nFrame Time: 0.025\n{3 * ROW}"
TXT = "".join(",".join(f".{n}{column}" for column in range(99)) + "\n" for n in range(3))
FILES = {"a.bvh": BVH, "02.asf": ASF, "02_01.amc": AMC, "a.txt": TXT}
TIMES_SIZE, BYTES_BESIDES, SECONDS = 80, 3e6, 5.0
"""A file may take TIMES_SIZE of its size in memory (its text, numbers of eight bytes for digits of
two, quaternions) and BYTES_BESIDES, and SECONDS to read."""


def write(folder, name, data):
    """A file with this content, a whole one beside it where it needs one; the file to load."""
    for whole in ("02.asf", "02_01.amc") if name.startswith("02") else ():
        (folder / whole).write_text(FILES[whole])
    (folder / name).write_bytes(data)
    return folder / ("02_01.amc" if name == "02.asf" else name)


DAMAGES = [
    # file, what is replaced, by what, the line of the error, words of its message
    ("a.bvh", ROW, "1 2 3\n", 19, "3 values, expected 9"),
    ("a.bvh", ROW, "1 2 nan 4 5 6 7 8 9\n", 19, "'nan' is not a number, expected a finite"),
    ("a.bvh", 3 * ROW, "", 17, "says 3, but no line of values follows"),
    ("a.bvh", "Frames: 3", "Frames: many", 17, "'many', expected a whole number"),
    ("a.bvh", "  JOINT", "  scale { 1 }\n  JOINT", 6, "expected } or JOINT or End Site in 'Hips'"),
    ("a.bvh", "Frames: 3\n", "", 17, "expected Frames: and a number"),
    ("a.bvh", "Frame Time: 0.025\n", "", 18, "expected Frame Time: and seconds"),
    ("a.bvh", "0.025", "0", 18, "Frame Time: 0, expected seconds, 0.0001 to 1"),
    ("a.bvh", "0.025", "1e9", 18, "expected seconds, 0.0001 to 1"),
    ("a.bvh", "0.025", "1e-6", 18, "expected seconds, 0.0001 to 1"),
    ("a.bvh", "HIERARCHY\n", "", 1, "expected HIERARCHY"),
    ("a.bvh", BVH[BVH.index("MOTION") :], "", 15, "ends without MOTION"),
    ("a.bvh", BVH[BVH.index("    End") :], "", 9, "ends in 'Leg' (line 6) without MOTION"),
    ("a.bvh", BVH[BVH.index("Frames") :], "", 16, "ends below MOTION, expected Frames:"),
    ("a.bvh", "}\nMOTION", "MOTION", 15, "in 'Hips' (line 2), found 'MOTION'"),
    ("a.bvh", "    OFFSET 0 -40 0\n", "", 13, "expected OFFSET or JOINT in 'Leg' (line 6)"),
    ("a.bvh", "OFFSET 0 -40 0", "OFFSET 0 -40", 8, "OFFSET has 2 values, expected 3 numbers"),
    ("a.bvh", "Xposition", "Xscale", 5, "different names of Xposition, Yposition"),
    ("a.bvh", "3 Zrotation X", "3 Yrotation X", 9, "the number of channels and"),
    ("a.bvh", "CHANNELS 3", "CHANNELS 2", 9, "expected the number of channels"),
    ("a.bvh", "-45 0\n", "-45 0\nCHANNELS 1 Xrotation\n", 13, "expected } in 'End Site of Leg'"),
    ("a.bvh", "JOINT Leg", "JOINT a:Hips", 6, "expected a name that is unique"),
    ("a.bvh", BVH, "", None, "the file is empty"),
    ("a.bvh", BVH, "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", None, "binary file, expected plain text"),
    ("02_01.amc", "\n2\n", "\n3\n", 8, "'3', expected the number of frame 2"),
    ("02_01.amc", "tibia 70\n", "", 4, "frame 1 has no values for tibia"),
    ("02_01.amc", "tibia 70\n", 2 * "tibia 70\n", 8, "'tibia' with 1 values, expected it once"),
    ("02_01.amc", "tibia 70", "tail 70", 7, "'tail 70', expected the number of frame 2 or a bone"),
    ("02_01.amc", "40 50 60", "40 50", 6, "'femur' with 2 values, expected it once in each frame"),
    ("02_01.amc", "\n1\n", "\n", 4, "expected it once"),
    ("02_01.amc", ":DEGREES", ":SAMPLES-PER-SECOND 0", 3, "expected 1 to 10000"),
    ("02.asf", ASF, "HIERARCHY\nROOT hips\n", 2, "no .asf file?"),
    ("02.asf", ASF[ASF.index(":hierarchy") :], "", 49, "and :hierarchy: is the file cut off"),
    ("02.asf", ASF[ASF.index("    femur") :], "", 34, "'tibia' is not below the root"),
    ("02.asf", "length 0.45", "length 0", 6, "length 0, expected a number above 0"),
    ("02.asf", "angle deg", "angle grad", 7, "'grad', expected deg or rad"),
    ("02.asf", "     direction 1 0 0\n", "", 16, "has no direction"),
    ("02.asf", "length 7.5", "length 1e308", 27, "expected a finite number"),
    ("02.asf", "dof rx\n", "dof rx l\n", 40, "'rx l', expected each of rx ry rz at most once"),
    ("02.asf", "axis 10 20 30  XYZ", "axis 10 20 30 XYX", 28, "'XYX', expected X, Y and Z"),
    ("02.asf", "  end\n  begin\n     id 2", "  begin\n     id 2", 22, "end of the bone on line 16"),
    ("02.asf", "name femur", "name hip", 23, "'hip' appears a second time"),
    ("02.asf", "root hip stump", "root hip tail", 52, "'tail': expected bones of :bonedata"),
    ("02.asf", "hip femur", "hip femur stump", 53, "'stump': expected bones"),
    ("02.asf", "root hip stump", "root hip", 43, "'stump' is not below the root"),
    ("a.txt", ".00,", "", 1, "98 values, expected 117 (CMU) or 99"),
    ("a.txt", ".10,", "", 2, "98 values, expected 99: as in the first line"),
    ("a.txt", ".10,", ",", 2, "'' is not a number"),
]


@pytest.mark.parametrize(("name", "old", "new", "line", "words"), DAMAGES)
def test_damage_is_refused_with_its_file_and_line(tmp_path, name, old, new, line, words):
    assert old in FILES[name]
    path = write(tmp_path, name, FILES[name].replace(old, new, 1).encode())
    with pytest.raises(MotionFileError) as refused:
        load_motion(path)
    message = str(refused.value)
    assert (refused.value.path, refused.value.line) == (tmp_path / name, line), message
    assert message.startswith(str(tmp_path / name) + ("" if line is None else f":{line}: "))
    assert words in message and len(message) < 400 + len(str(path)), message


@pytest.mark.parametrize("step", [2, pytest.param(1, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("name", FILES)
def test_a_file_that_is_cut_off_is_refused_or_only_its_last_number_is_another(
    tmp_path, name, step, counted
):
    data = FILES[name].encode()
    rates = None, 30.0
    whole = [load_motion(write(tmp_path, name, data), max_rate=rate) for rate in rates]
    read = 0
    lengths = range(0, len(data), 5 if name == "a.txt" and step > 1 else step)
    for length in lengths:
        path, which = write(tmp_path, name, data[:length]), length // 2 % 2
        try:
            found = load_motion(path, max_rate=rates[which])
        except MotionFileError as refused:
            assert refused.path == tmp_path / name and "cannot be read: " not in str(refused)
            continue
        read += 1
        # Only BVH states its number of frames.
        missing = name == "a.bvh" and len(found) < len(whole[which])
        assert ("lines of values follow" in found.unit_note) >= missing, length
        last = len(found) - 1
        np.testing.assert_array_equal(found.rotations[:last], whole[which].rotations[:last])
    assert read < 60 / step
    counted(f"{len(lengths)} cuts of {name}: {read} read, {len(lengths) - read} refused")


def read_or_refuse(path, name, size, mutations):
    """Whether a file can be read; no other error, in bounded time and memory."""
    tracemalloc.start()
    begun, positions = time.process_time(), np.zeros(1)
    try:
        positions = load_motion(path).resampled(30.0).positions()
        return True
    except MotionFileError as refused:
        assert refused.path.name in (name, path.name), mutations
        assert len(str(refused)) < 1500 and "\n" not in str(refused), mutations
        return False
    except Exception as error:
        raise AssertionError(f"{mutations}: {error!r}") from error
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert len(positions) > 0 and np.isfinite(positions).all(), mutations
        assert peak < TIMES_SIZE * size + BYTES_BESIDES, (mutations, peak, size)
        assert time.process_time() - begun < SECONDS, mutations


PARTS, PART = 25, 1000


def code() -> str:
    """A digest of the code that reads motions, and of the mutations."""
    paths = [*sorted(Path(numpy_cae.motion.__file__).parent.rglob("*.py")), Path(__file__)]
    paths.append(Path(__file__).with_name("mutations.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]


@pytest.mark.parametrize(
    "part", [None, *(pytest.param(n, marks=pytest.mark.thorough) for n in range(PARTS))]
)
@pytest.mark.parametrize("name", FILES)
def test_mutated_files(tmp_path, name, part, counted, request):
    numbers = range(25) if part is None else range(PART * part, PART * (part + 1))
    cache, key = getattr(request.config, "cache", None), f"mutations/{code()}/{name}/{part}"
    if part is not None and cache and (before := cache.get(key, None)):
        counted(f"{before}, in an earlier run")
        return
    read = 0
    for number in numbers:
        data, mutations = mutated(FILES[name].encode(), np.random.default_rng([1, number]))
        size = len(data) + len(ASF) + len(AMC)
        read += read_or_refuse(write(tmp_path, name, data), name, size, (name, number, mutations))
    # Some mutations are harmless and some are not, or this test would test nothing.
    count = len(numbers)
    assert 0 < read < count
    text = f"{name}, part {part}: {count} mutations, {read} read, {count - read} refused"
    counted(text)
    if part is not None and cache:
        cache.set(key, text)


@pytest.mark.parametrize("joints,frames,seconds", [(7, 20_000, "1"), (1000, 20_000, "0.0333333")])
def test_a_small_file_cannot_ask_for_much_memory(tmp_path, joints, frames, seconds):
    """Joints without channels, and frames that become many when they are resampled."""
    stiff = "".join(f"JOINT s{i}\n{{\nOFFSET 0 1 0\n}}\n" for i in range(joints))
    head = f"HIERARCHY\nROOT a\n{{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n{stiff}}}\nMOTION\n"
    rows = "0\n" * frames
    data = f"{head}Frames: {frames}\nFrame Time: {seconds}\n{rows}".encode()
    path = write(tmp_path, "a.bvh", data)
    assert not read_or_refuse(path, "a.bvh", len(data), joints)
    with pytest.raises(MotionFileError, match=r"\d+ joint rotations at 30 a second .* at most"):
        load_motion(path)
