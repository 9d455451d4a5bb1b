"""`train` killed at any moment: the last good checkpoint and model are there and can be read."""

import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from numpy_cae.cli import main

TINY = "--epochs 3 --rate 0.05 --window 32 --filters 6 8 --batch 4 --quiet".split()
SEQUENTIAL = (
    "--model sequential --hidden 6 --latent 3 --epochs 4 --steps 12 --batch 4 --quiet".split()
)


def trained(walks, folder, options):
    """The model of an uninterrupted run."""
    file = folder / "m.npz"
    assert main(["train", str(walks), "-o", str(file), *options]) == 0
    return file


@pytest.fixture(scope="module")
def whole(walks, tmp_path_factory):
    return trained(walks, tmp_path_factory.mktemp("whole"), TINY)


def started(walks, out, options):
    return subprocess.Popen(
        [sys.executable, "-m", "numpy_cae", "train", str(walks), "-o", str(out), *options],
        cwd=Path(__file__).parents[2],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
    )


def same(one, other):
    return one.read_bytes() == other.read_bytes()


def wait_for_a_state(process, state):
    """Until the run has kept a state newer than any before it; what comes earlier is reading."""
    before = state.stat().st_mtime_ns if state.exists() else 0
    while process.poll() is None:
        # The run moves another file into this place at any moment, and removes it at its end.
        with suppress(FileNotFoundError):
            if state.stat().st_mtime_ns > before:
                return
        time.sleep(0.002)


def test_two_trainings_with_one_seed_write_the_same_bytes(walks, whole, tmp_path):
    assert same(whole, trained(walks, tmp_path, TINY))


def test_two_trainings_on_sequences_write_the_same_bytes(walks, tmp_path_factory):
    first, second = (trained(walks, tmp_path_factory.mktemp("run"), SEQUENTIAL) for _ in range(2))
    assert same(first, second)


@pytest.mark.parametrize(
    ("options", "times"),
    [
        (TINY, 2),
        pytest.param(TINY, 100, marks=pytest.mark.thorough),
        pytest.param(SEQUENTIAL, 100, marks=pytest.mark.thorough),
    ],
)
def test_killed_at_random_moments(walks, whole, tmp_path, options, times):
    """Each run goes on from what the one before left."""
    (tmp_path / "whole").mkdir()
    whole = whole if options is TINY else trained(walks, tmp_path / "whole", options)
    out, rng, kept = tmp_path / "out" / "m.npz", np.random.default_rng(0), 0
    out.parent.mkdir()
    state = out.with_name("m.checkpoint.npz")
    for number in range(times):
        process = started(walks, out, [*options, "--resume"])
        if number % 4 == 3:
            time.sleep(rng.uniform(0, 3))
            process.send_signal(rng.choice([signal.SIGKILL, signal.SIGTERM]))
        else:
            wait_for_a_state(process, state)
            time.sleep(rng.uniform(0, 0.02))
            process.send_signal(rng.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT]))
        assert "Traceback" not in process.communicate()[1]
        kept += state.exists()
        if out.exists():
            assert same(out, whole)
            out.unlink()
            out.with_suffix(".png").unlink(missing_ok=True)
    assert main(["train", str(walks), "-o", str(out), *options, "--resume"]) == 0
    assert same(out, whole)
    # What killed runs left is removed; the picture is that of the losses.
    assert sorted(os.listdir(out.parent)) == ["m.npz", "m.png"]
    assert kept > times / 10


def test_a_run_that_diverges_keeps_the_model_that_was_there(walks, whole, tmp_path, error_of):
    out = tmp_path / "m.npz"
    out.write_bytes(whole.read_bytes())
    message = error_of("train", walks, "-o", out, *TINY, "--rate", "1e20", "--overwrite")
    assert message.startswith("numpy-cae train: layer 1, epoch 1")
    assert all(word in message for word in ("at rate ", "no state has been saved", "--rate"))
    assert out.read_bytes() == whole.read_bytes()


def test_resuming_a_complete_training_changes_nothing(walks, whole, capsys, run):
    before = whole.read_bytes()
    run("train", walks, "-o", whole, *TINY, "--resume")
    assert "is complete" in capsys.readouterr().out
    assert whole.read_bytes() == before


def test_a_bad_file_is_listed_and_left_out(walks, tmp_path, capsys, run):
    motions, out = tmp_path / "motions", tmp_path / "m.npz"
    shutil.copytree(walks, motions)
    (motions / "bad.bvh").write_text("HIERARCHY\nnonsense\n")
    run("train", motions, "-o", out, *TINY)
    printed = capsys.readouterr().err
    assert f"left out: {motions / 'bad.bvh'}:2: " in printed
    assert "4 takes to train on" in printed
