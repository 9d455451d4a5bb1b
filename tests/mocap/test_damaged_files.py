"""Whatever happened to a motion file: it is read, all finite, or refused with its file and line.

    pytest -m thorough tests/mocap/test_damaged_files.py

mutates 100,000 files in 100 parts and cuts each format after every byte.
"""

import json
import time
import tracemalloc

import numpy as np
import pytest
from acclaim_files import AMC, ASF
from acclaim_files import FILES as FOLDER
from mutations import mutated

from numpy_cae.mocap import MotionFileError, load_motion

BVH = (FOLDER / "leg.bvh").read_text()
TXT = "".join(",".join(f".{n}{column}" for column in range(99)) + "\n" for n in range(3))
FILES = {"a.bvh": BVH, "02.asf": ASF, "02_01.amc": AMC, "a.txt": TXT}
TIMES_SIZE, BYTES_BESIDES, SECONDS = 80, 3e6, 5.0
"""A file may take TIMES_SIZE of its size in memory (its text, numbers of eight bytes for digits of
two, quaternions) and BYTES_BESIDES, and SECONDS to read."""


def write(folder, name, data):
    """A file with this content, a whole one beside it where it needs one; the file to load."""
    for file in ("02.asf", "02_01.amc") if name.startswith("02") else ():
        (folder / file).write_text(FILES[file])
    (folder / name).write_bytes(data)
    return folder / ("02_01.amc" if name == "02.asf" else name)


DAMAGES = json.loads((FOLDER / "damages.json").read_text(encoding="utf-8"))
"""File, the text that is replaced (with … at its end: to the end of the file), by what, the line of
the error, and words of its message."""


@pytest.mark.parametrize(("name", "old", "new", "line", "words"), DAMAGES)
def test_damage_is_refused_with_its_file_and_line(tmp_path, name, old, new, line, words):
    text = FILES[name]
    start, rest = text.index(old.rstrip("…")), "" if old.endswith("…") else text.partition(old)[2]
    path = write(tmp_path, name, f"{text[:start]}{new}{rest}".encode())
    with pytest.raises(MotionFileError) as refused:
        load_motion(path)
    message = str(refused.value)
    assert (refused.value.path, refused.value.line) == (tmp_path / name, line), message
    assert message.startswith(str(tmp_path / name) + ("" if line is None else f":{line}: "))
    assert words in message and len(message) < 400 + len(str(path)), message


@pytest.mark.parametrize("step", [2, pytest.param(1, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("name", FILES)
def test_of_a_file_that_is_cut_off_the_last_number_may_be_another(tmp_path, name, step, counted):
    data = FILES[name].encode()
    rates = None, 30.0
    complete = [load_motion(write(tmp_path, name, data), max_rate=rate) for rate in rates]
    read = 0
    lengths = range(0, len(data), 5 if name == "a.txt" and step > 1 else step)
    for length in lengths:
        path, which = write(tmp_path, name, data[:length]), length // 2 % 2
        try:
            motion = load_motion(path, max_rate=rates[which])
        except MotionFileError as refused:
            assert refused.path == tmp_path / name and "cannot be read: " not in str(refused)
            continue
        read += 1
        # Only BVH states its number of frames.
        missing = name == "a.bvh" and len(motion) < len(complete[which])
        assert ("lines of values follow" in motion.note) >= missing, length
        last = len(motion) - 1
        np.testing.assert_array_equal(motion.rotations[:last], complete[which].rotations[:last])
    assert read < 60 / step
    counted(f"{len(lengths)} cuts of {name}: {read} read, {len(lengths) - read} refused")


def read_or_refuse(path, name, size, mutations, measured=True):
    """Whether a file can be read; no other error, in bounded time and, if `measured`, memory.

    Measuring takes three times as long as reading.
    """
    if measured:
        tracemalloc.start()
    begun, positions = time.process_time(), np.zeros(1)
    try:
        motion = load_motion(path)
        positions = motion.sampled(len(motion)).resampled(30.0).positions()  # without lost values
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


PARTS, PART, MEASURED = 25, 1000, 8
"""Parts of each format, files in a part; memory is measured of every MEASURED-th file."""


THOROUGH = [pytest.param(part, marks=pytest.mark.thorough) for part in range(PARTS)]


@pytest.mark.parametrize("part", [None, *THOROUGH])
@pytest.mark.parametrize("name", FILES)
def test_mutated_files(tmp_path, name, part, counted):
    numbers = range(25) if part is None else range(PART * part, PART * (part + 1))
    read = 0
    for number in numbers:
        data, mutations = mutated(FILES[name].encode(), np.random.default_rng([1, number]))
        size = len(data) + len(ASF) + len(AMC)
        which, measured = (name, number, mutations), part is None or number % MEASURED == 0
        read += read_or_refuse(write(tmp_path, name, data), name, size, which, measured)
    # Some mutations are harmless and some are not, or this test would test nothing.
    count = len(numbers)
    assert 0 < read < count
    counted(f"{name}, part {part}: {count} mutations, {read} read, {count - read} refused")


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


def test_a_skeleton_of_10_000_joints_is_refused(tmp_path):
    joints = "".join(f"JOINT s{i}\n{{\nOFFSET 0 1 0\n" for i in range(10_000))
    text = f"HIERARCHY\nROOT a\n{{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n{joints}"
    with pytest.raises(MotionFileError, match="the skeleton has more than 5000 joints"):
        load_motion(write(tmp_path, "a.bvh", text.encode()))
