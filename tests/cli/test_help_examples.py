"""Every example of every --help runs, in a folder that has the files which the help names."""

import ast
import re
import shlex
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

import data_synth.__main__
from data_synth import make_take
from numpy_cae.cli import SUBCOMMANDS, commands, main
from numpy_cae.cli.commands import demo, download
from numpy_cae.mocap import write_bvh

SHORTER = {
    "--minutes 20": "--minutes 1",
    "--minutes 2 ": "--minutes 0.5 ",
    "--recipe best": "--recipe best --epochs 1",
}
"""What the test does less of than an example."""
STATUSES = {"verify": (0, 1)}
"""Exit statuses of examples; 1 of `verify` says that an exercise is not solved yet."""


def examples_of(name):
    """The commands in the last part of a subcommand's help."""
    path = Path(commands.__file__).with_name(f"{name}.py")
    _, _, examples = ast.get_docstring(ast.parse(path.read_text("utf-8"))).partition("\n\nexample")
    found = re.findall(r"^.*?((?:numpy-cae|python -m data_synth) .*)$", examples, re.MULTILINE)
    return [re.split(r"\s{2,}", command)[0] for command in found if "`" not in command]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """What `numpy-cae demo`, `numpy-cae lessons student/` and a class leave."""
    folder = tmp_path_factory.mktemp("examples")
    (folder / "demo").mkdir()
    true = make_take("walk", 0, seconds=5.0, rate=30.0).motion
    rotations = true.rotations.copy()
    for joint, frames in (("lradius", slice(40, 42)), ("rtibia", slice(90, 93))):
        rotations[frames, true.skeleton.index(joint)] = (0.6, 0.0, 0.0, 0.8)
    damaged = replace(true, rotations=rotations)
    for name, motion in {"true": true, "damaged": damaged, "repaired": true}.items():
        write_bvh(motion, folder / "demo" / f"{name}.bvh", unit=0.01)
    assert main(["lessons", str(folder / "student"), "--only", "03"]) == 0
    handed_in = folder / "moodle" / "Ann Lee_8811_assignsubmission_file_"
    handed_in.mkdir(parents=True)
    shutil.copy(folder / "student" / "03_convolution_by_hand.ipynb", handed_in)
    shutil.make_archive(str(folder / "download"), "zip", folder / "moodle")
    worksheet = "Identifier,Full name,Grade\nParticipant 8811,Ann Lee,\n"
    (folder / "grades.csv").write_text(worksheet)
    return folder


@pytest.fixture
def small(monkeypatch, files, few_windows):
    """The demo trains little, and nothing is downloaded."""
    monkeypatch.chdir(files)
    monkeypatch.setattr(demo, "TAKES", 2 * len(demo.KINDS))
    monkeypatch.setattr(demo, "TEST_EVERY", 2)
    monkeypatch.setattr(demo, "SECONDS", 1.5)
    stage = replace(demo.SCHEDULE.fine_tuning, epochs=1)
    layer = replace(demo.SCHEDULE.layer, epochs=0)
    schedule = replace(demo.SCHEDULE, layer=layer, fine_tuning=stage)
    monkeypatch.setattr(demo, "SCHEDULE", schedule)
    monkeypatch.setattr(download, "download_cmu", lambda folder, *_: [folder])


@pytest.mark.parametrize("name", SUBCOMMANDS)
def test_every_example_of_a_help_runs(name, small, tmp_path, monkeypatch):
    examples = examples_of(name)
    assert examples
    if name in ("demo", "lessons"):  # which write what other examples need not find
        monkeypatch.chdir(tmp_path)
    for example in examples:
        for text, shorter in SHORTER.items():
            example = example.replace(text, shorter)
        words = shlex.split(example)
        if words[0] == "python":
            assert data_synth.__main__.main([*words[3:], "--quiet"]) == 0
        else:
            assert main(words[1:]) in STATUSES.get(name, (0,)), example
