"""Commands on a full disk and a small machine: one sentence, nothing lost, no part of a file."""

import os
import resource
import subprocess
import sys

import pytest

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.mocap import write_bvh

COMMANDS = {
    "repair": "repair walk.bvh -o out.bvh --html --findings found.json --project",
    "in place": "repair walk.bvh -o walk.bvh --overwrite --project",
    "fill": "fill walk.bvh -o out.bvh --joint left_wrist --frames 5 20 --html",
    "interpolate": "interpolate walk.bvh second.bvh -o out.bvh --html",
    "compare": "compare walk.bvh second.bvh -o out.csv --picture out.png",
    "sample": "sample -o out.bvh --seconds 1 --html",
    "rig": "rig walk.bvh -o out.json",
    "show": "show walk.bvh -o out.html",
    "train": "train motions -o out.npz --epochs 1 --filters 4 --window 16 --quiet",
    "lessons": "lessons student --only 03",
    "release": "lessons --release out.zip 03",
}


@pytest.fixture
def place(tmp_path):
    """Two motions, and a folder that has one."""
    (tmp_path / "motions").mkdir()
    for seed, name in enumerate(("walk.bvh", "second.bvh", "motions/third.bvh")):
        write_bvh(make_take("walk", seed, seconds=2.0, rate=30.0).motion, tmp_path / name, 0.01)
    return tmp_path


def run_limited(place, command, kind, most, **environment):
    """The status of a command with a limit, and the lines of its errors."""

    def limit():
        resource.setrlimit(kind, (most, most))

    ended = subprocess.run(
        [sys.executable, "-m", "numpy_cae", *command.split()],
        cwd=place,
        capture_output=True,
        text=True,
        preexec_fn=limit,
        env=os.environ | environment,
        timeout=600,
    )
    return ended.returncode, ended.stderr.strip().splitlines()


def contents(place):
    return {path: path.read_bytes() for path in place.rglob("*") if path.is_file()}


@pytest.mark.thorough
@pytest.mark.parametrize("name", list(COMMANDS))
@pytest.mark.parametrize("most", [0, 100])
def test_a_full_disk_is_said_and_nothing_is_lost(name, most, place):
    before = contents(place)
    status, said = run_limited(place, COMMANDS[name], resource.RLIMIT_FSIZE, most)
    assert status == 2
    assert said[-1].startswith("numpy-cae ")
    assert not any("Traceback" in line for line in said)
    assert {path: data for path, data in contents(place).items() if path in before} == before
    assert not list(place.rglob(".*.part*"))


@pytest.mark.thorough
@pytest.mark.parametrize("name", list(COMMANDS))
@pytest.mark.parametrize("megabytes", [512, 900])
def test_little_memory_is_said_and_nothing_is_lost(name, megabytes, place):
    before = contents(place)
    status, said = run_limited(
        place, COMMANDS[name], resource.RLIMIT_AS, megabytes << 20, OPENBLAS_NUM_THREADS="1"
    )
    assert status in (0, 2, 3, 4)
    assert not any("Traceback" in line for line in said)
    if status == 2:
        assert {path: data for path, data in contents(place).items() if path in before} == before


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        ImportError("_core.so: failed to map segment from shared object"),
        RuntimeError("can't start new thread"),
        ValueError("Maximum allowed dimension exceeded"),
    ],
)
def test_errors_that_come_from_little_memory_say_so(error, monkeypatch, error_of):
    def fail(args):
        raise error

    monkeypatch.setattr("numpy_cae.cli.commands.rig.run", fail)
    assert error_of("rig", "walk.bvh").startswith("numpy-cae rig: not enough memory.")


def test_other_errors_of_an_import_are_not_hidden(monkeypatch):
    def fail(args):
        raise ImportError("no such module")

    monkeypatch.setattr("numpy_cae.cli.commands.rig.run", fail)
    with pytest.raises(ImportError, match="no such module"):
        main(["rig", "walk.bvh"])


@pytest.mark.thorough
@pytest.mark.parametrize("name", list(COMMANDS))
def test_no_home_is_needed(name, place):
    home = {"HOME": "/proc/none", "MPLCONFIGDIR": "", "XDG_CACHE_HOME": "/proc/none"}
    status, said = run_limited(place, COMMANDS[name], resource.RLIMIT_CORE, 0, **home)
    assert status in (0, 3, 4)
    assert not any("Traceback" in line for line in said)
