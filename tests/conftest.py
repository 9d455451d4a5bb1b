"""Fixtures and settings of all tests."""

import json
import os
import sys
from pathlib import Path
from subprocess import PIPE, Popen
from threading import Lock

import pytest
from hypothesis import settings

for library in ("OPENBLAS", "OMP", "MKL"):
    # Processes of `pytest -n 2` share the processors. NumPy, imported later, reads this.
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

settings.register_profile("quick", max_examples=20, deadline=None)
settings.register_profile("thorough", max_examples=1000, deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "quick"))


@pytest.fixture
def counted(capsys):
    """Print what a thorough test has tried, whether or not output is captured."""

    def counted(text: str) -> None:
        with capsys.disabled():
            print(f"\n{text}")

    return counted


@pytest.fixture(scope="session")
def grader():
    """A process with one thread, which has imported the course and forks for each file.

    The tests' own process may not be forked: where another thread is in the middle of a product of
    matrices, the lock that this thread holds stays closed in the copy.
    """
    from numpy_cae.verify.grading.student_file import ONE_THREAD

    command = [sys.executable, str(Path(__file__).with_name("grader_process.py"))]
    environment = os.environ | ONE_THREAD
    with Popen(command, stdin=PIPE, stdout=PIPE, text=True, env=environment) as process:
        yield process
        process.stdin.close()


@pytest.fixture
def most_cases():
    """On so many cases a grader tries each property, where the grading itself is tested; all cases
    if it is None."""
    return 4


@pytest.fixture
def forked_grading(tmp_path, monkeypatch, grader, most_cases):
    """Grade in a process that is forked from one that runs, which saves starting Python."""
    from numpy_cae.verify.grading import student_file

    free = Lock()  # the command grades several files at once

    def run(request):
        with free:
            print(json.dumps([str(tmp_path), request, most_cases]), file=grader.stdin, flush=True)
            return json.loads(grader.stdout.readline())

    monkeypatch.setattr(student_file, "run", run)


@pytest.fixture(scope="session")
def graded_contents():
    """The grader's replies, as JSON, by what was graded."""
    return {}


@pytest.fixture
def shared_grading(forked_grading, graded_contents, monkeypatch):
    """Grade files of the same content once, for tests of what is made from the grader's replies.

    The content and the request decide on a reply; the name of the file may not be in it.
    """
    from numpy_cae.verify.grading import student_file

    grade_in_fork = student_file.run
    free = Lock()

    def run(request):
        path = Path(request["path"])
        graded = path.suffix, path.read_bytes(), json.dumps(request | {"path": ""}, sort_keys=True)
        with free:
            if graded not in graded_contents:
                reply = json.dumps(grade_in_fork(request))
                assert path.name not in reply
                graded_contents[graded] = reply
            return json.loads(graded_contents[graded])

    monkeypatch.setattr(student_file, "run", run)


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder of real motion files that NUMPY_CAE_DATA names; the test is skipped without it."""
    folder = Path(os.environ.get("NUMPY_CAE_DATA", ""))
    if not (folder / "bandai").is_dir():
        pytest.skip("set NUMPY_CAE_DATA to a folder of real motion files")
    return folder


@pytest.fixture(scope="session")
def walk_takes():
    """Fourteen walks, (F, 20, 3) each."""
    from data_synth import make_take
    from numpy_cae.mocap import body_of

    return [body_of(make_take("walk", seed, 2.0, 30.0).motion) for seed in range(14)]


@pytest.fixture(scope="session")
def walk_manifold(walk_takes):
    """A small manifold trained on them."""
    from numpy_cae.manifold import learn_manifold
    from numpy_cae.training import Schedule, Stage

    schedule = Schedule(layer=Stage(epochs=8), fine_tuning=Stage(epochs=12, rate=0.1, alpha=0.0))
    return learn_manifold(walk_takes, schedule, window=32, overlap=16, filters=(16, 24), taps=5)


@pytest.fixture(scope="session")
def tiny_manifolds():
    """A manifold of each kind, trained for an epoch, and the motion that they are learned from."""
    from data_synth import make_take
    from numpy_cae.manifold import learn_manifold, learn_sequences
    from numpy_cae.mocap import angles_of, body_of
    from numpy_cae.training import Schedule, SequenceSchedule, Stage

    motion = make_take("walk", 0, seconds=2.0, rate=50.0).motion
    stages = Schedule(Stage(epochs=1), Stage(epochs=1, rescaled=True))
    conv = learn_manifold([body_of(motion)], stages, window=16, overlap=8, filters=(4, 6), taps=5)
    short = SequenceSchedule(epochs=1, steps=2, batch=4, directions=4)
    sizes = {"hidden": 6, "latent": 3, "frames": 30}
    sequence = learn_sequences([angles_of(motion)], short, **sizes)
    return {"conv": conv, "sequence": sequence}, motion


@pytest.fixture(scope="session")
def untrained_manifold():
    """A manifold of random weights about the mean pose of one walk."""
    import numpy as np

    from data_synth import make_take
    from numpy_cae.manifold import MotionManifold
    from numpy_cae.mocap import body_of
    from numpy_cae.models import ConvAutoencoder
    from numpy_cae.motion import bone_lengths

    body = body_of(make_take("walk", 0, 2.0, 30.0).motion)
    network = ConvAutoencoder(filters=(8, 8), taps=5, rng=np.random.default_rng(0))
    manifold = MotionManifold(network, np.zeros(63), np.full(63, 0.25), bone_lengths(body))
    manifold.mean_pose = manifold.features(body)[0].mean(axis=0)
    return manifold


@pytest.fixture(scope="session")
def run():
    """Run a command that must succeed."""
    from numpy_cae.cli import main

    def run(*words):
        assert main([str(word) for word in words]) == 0

    return run


@pytest.fixture
def error_of(capsys):
    """Run a command that must fail; return its one line on standard error."""
    from numpy_cae.cli import main

    def error_of(*words):
        assert main([str(word) for word in words]) == 2
        lines = capsys.readouterr().err.strip().splitlines()
        assert lines[-1].startswith(f"numpy-cae {words[0]}: ")
        assert not any("Traceback" in line for line in lines)
        return lines[-1]

    return error_of
