"""Whatever happened to a motion file: it is read, all finite, or refused as a MotionFileError; in
bounded time, and in memory that is a small multiple of the file's size.

The seeds are real files where there are some, cut to a few frames, else synthetic ones.
"""

import os
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from acclaim_files import write_acclaim
from mutations import mutated, stiff_joints_and_short_lines

from data_synth import make_take
from numpy_cae.motion import MotionFileError, load_motion, write_bvh

KINDS = ["bvh", "asf", "amc", "txt"]
TIMES_SIZE = 80
"""Of a file: the text, its lines, numbers of eight bytes for digits of two, quaternions."""
BESIDES = 3e6
SECONDS = 5.0


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    """Bytes of a whole, short file of each kind."""
    folder = Path(os.environ.get("NUMPY_CAE_DATA", Path(__file__).parents[3] / "shared" / "data"))
    if (folder / "bandai").is_dir():
        bvh = (folder / "bandai" / "dataset-2_walk_normal_001.bvh").read_bytes()
        asf = (folder / "cmu" / "asfamc" / "02" / "02.asf").read_bytes()
        amc = (folder / "cmu" / "asfamc" / "02" / "02_01.amc").read_bytes()
        txt = (folder / "cmu" / "expmap" / "walking" / "walking_1.txt").read_bytes()
    else:
        motion = make_take("walk", 0, seconds=0.5, rate=30.0).motion
        out = tmp_path_factory.mktemp("seeds")
        write_bvh(motion, out / "a.bvh")
        write_acclaim(motion, out / "a.amc")
        bvh, asf, amc = ((out / f"a.{kind}").read_bytes() for kind in ("bvh", "asf", "amc"))
        txt = b"".join(
            b",".join(b"%.7f" % value for value in row) + b"\n"
            for row in np.random.default_rng(0).normal(size=(6, 117))
        )
    amc = amc.replace(b"\r", b"")
    head, _, rows = bvh.partition(b"MOTION")
    frames = rows.splitlines()[3:9]
    return {
        "bvh": b"\n".join([head + b"MOTION", b"Frames: 6", b"Frame Time: .0333", *frames, b""]),
        "asf": asf,
        "amc": amc[: amc.index(b"\n5\n") + 1],
        "txt": b"".join(txt.splitlines(keepends=True)[:6]),
    }


def write(folder: Path, seeds: dict[str, bytes], kind: str, data: bytes) -> Path:
    """The mutated file, and where it needs another beside it a good one."""
    if kind == "asf":
        (folder / "02_01.amc").write_bytes(seeds["amc"])
    elif kind == "amc":
        (folder / "02.asf").write_bytes(seeds["asf"])
    names = {"bvh": "a.bvh", "asf": "02.asf", "amc": "02_01.amc", "txt": "a.txt"}
    (folder / names[kind]).write_bytes(data)
    return folder / ("02_01.amc" if kind == "asf" else names[kind])


def read_or_refuse(path: Path, size: int, what: object) -> bool:
    tracemalloc.start()
    begun = time.process_time()
    try:
        motion = load_motion(path).resampled(30.0)
        positions = motion.positions()
    except MotionFileError as refused:
        assert len(str(refused)) < 1500, what
        assert "\n" not in str(refused), what
        motion = None
    except Exception as error:
        raise AssertionError(f"{what}: {error!r}") from error
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    if motion is not None:
        assert len(motion) > 0, what
        assert np.isfinite(positions).all(), what
    assert peak < TIMES_SIZE * size + BESIDES, (what, peak, size)
    assert time.process_time() - begun < SECONDS, what
    return motion is not None


def mutate_many(folder: Path, seeds: dict[str, bytes], kind: str, count: int, seed: int) -> int:
    read = 0
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        data, names = mutated(seeds[kind], rng)
        path = write(folder, seeds, kind, data)
        size = len(data) + len(seeds["asf"]) + len(seeds["amc"])
        read += read_or_refuse(path, size, (kind, seed, number, names))
    # Some mutations are harmless and some are not, or this test would test nothing.
    assert 0 < read < count
    return read


@pytest.mark.parametrize("kind", KINDS)
def test_a_few_mutated_files(tmp_path, seeds, kind):
    assert read_or_refuse(write(tmp_path, seeds, kind, seeds[kind]), 10**6, "the seed")
    mutate_many(tmp_path, seeds, kind, 15, seed=0)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", KINDS)
def test_a_hundred_thousand_mutated_files(tmp_path, seeds, kind, counted):
    read = mutate_many(tmp_path, seeds, kind, 25_000, seed=1)
    counted(f"25000 mutated .{kind} files: {read} read, {25_000 - read} refused")


def test_stiff_joints_and_short_lines_fill_no_memory(tmp_path):
    for number in range(4):
        data = stiff_joints_and_short_lines(b"", np.random.default_rng(number))
        path = write(tmp_path, {}, "bvh", data)
        read_or_refuse(path, len(data), ("stiff", number))


def test_a_small_file_may_not_become_large_when_it_is_resampled(tmp_path):
    joints = b"".join(b"JOINT s%d\n{\nOFFSET 0 1 0\n}\n" % i for i in range(7))
    head = b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + joints + b"}\nMOTION\n"
    data = head + b"Frames: 20000\nFrame Time: 1\n" + b"0\n" * 20_000
    path = write(tmp_path, {}, "bvh", data)
    assert not read_or_refuse(path, len(data), "slow")
    with pytest.raises(MotionFileError, match=r"4800000 poses at 30 a second .* expected at most"):
        load_motion(path)


BILLION = [
    ("bvh", b"Frames: 6", b"Frames: 1000000000"),
    ("bvh", b"CHANNELS 6", b"CHANNELS 1000000000"),
    ("bvh", b"Frame Time: .0333", b"Frame Time: 1000000000"),
    ("bvh", b"Frame Time: .0333", b"Frame Time: 0.000000000000001"),
    ("bvh", b"Frame Time: .0333", b"Frame Time: -1"),
    ("amc", b"\n2\n", b"\n1000000000\n"),
    ("asf", b"length", b"length 1e308 #"),
]


@pytest.mark.parametrize("kind,old,new", BILLION)
def test_a_header_that_claims_the_sky(tmp_path, seeds, kind, old, new):
    data = seeds[kind].replace(old, new, 1)
    assert data != seeds[kind]
    assert not read_or_refuse(write(tmp_path, seeds, kind, data), len(data) + 10**5, (kind, new))
