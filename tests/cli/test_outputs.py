"""What each option that writes does to a file that is already there.

`WRITES` has a row for each file that an option writes: the command, the file, and what becomes of a
file of the user's that has this name. Every option of every parser that takes free text is in one
of the three tables, so that a new option needs a row.
"""

import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import SUBCOMMANDS, main, subcommand_parser
from numpy_cae.mocap import write_bvh

REFUSED = "refused without --overwrite"
KEPT = "kept, and nothing is written in its place"
NUMBERED = "kept under a name with a number"

MOTION = "walk.bvh -m model.npz"
TRAIN = "train motions -o out/it.npz --epochs 1 --filters 4 --window 16 --quiet"
REPAIR = f"repair {MOTION} -o out/it.bvh --project --html --findings out/found.json"
FILL = f"fill {MOTION} -o out/it.bvh --joint left_wrist --frames 5 20 --html"
INTERPOLATE = "interpolate walk.bvh second.bvh -m model.npz -o out/it.bvh --html"
COMPARE = "compare walk.bvh second.bvh -m model.npz -o out/it.csv --picture out/it.png"
SAMPLE = "sample -m model.npz -o out/it.bvh --seconds 1 --html"
VERIFY = "verify handed --csv out/it.csv --roster roster.csv --feedback out --json out/it.json"

WRITES = {
    ("train", "--output", "it.npz"): (TRAIN, REFUSED),
    ("train", "--output", "it.png"): (TRAIN, REFUSED),
    ("repair", "--output", "it.bvh"): (REPAIR, REFUSED),
    ("repair", "--output", "it.html"): (REPAIR, REFUSED),
    ("repair", "--findings", "found.json"): (REPAIR, REFUSED),
    ("fill", "--output", "it.bvh"): (FILL, REFUSED),
    ("fill", "--output", "it.html"): (FILL, REFUSED),
    ("interpolate", "--output", "it.bvh"): (INTERPOLATE, REFUSED),
    ("interpolate", "--output", "it.html"): (INTERPOLATE, REFUSED),
    ("compare", "--output", "it.csv"): (COMPARE, REFUSED),
    ("compare", "--picture", "it.png"): (COMPARE, REFUSED),
    ("sample", "--output", "it.bvh"): (SAMPLE, REFUSED),
    ("sample", "--output", "it.html"): (SAMPLE, REFUSED),
    ("edit", "--output", "it.bvh"): ("edit walk.bvh -o out/it.bvh --mirror", REFUSED),
    ("edit", "--output", "walk_1.bvh"): ("edit walk.bvh -o out --split", REFUSED),
    ("rig", "--output", "it.json"): ("rig walk.bvh -o out/it.json", REFUSED),
    ("show", "--output", "walk.png"): ("show walk.bvh -o out", REFUSED),
    ("show", "--output", "it.html"): ("show walk.bvh -o out/it.html", REFUSED),
    ("lessons", "folder", "mine.py"): ("lessons out --only 03", KEPT),
    ("lessons", "--release", "it.zip"): ("lessons --release out/it.zip 03", REFUSED),
    ("verify", "--csv", "it.csv"): (VERIFY, NUMBERED),
    ("verify", "--csv", "it_statistics.csv"): (VERIFY, NUMBERED),
    ("verify", "--csv", "it_import.csv"): (VERIFY, NUMBERED),
    ("verify", "--feedback", "ann.md"): (VERIFY, REFUSED),
    ("verify", "--json", "it.json"): (VERIFY, REFUSED),
    ("demo", "--output", "damaged.bvh"): ("demo -o out --quiet --seed 3", REFUSED),
}
"""A file that an option writes: the command that writes it, and what becomes of one that exists."""
IN_OTHER_TESTS = {("download", "--output")}
"""Writes, and needs a server: tests/download has its test."""
READS = {
    *{(name, "--model") for name in "repair fill interpolate compare sample".split()},
    *{
        (name, "--mapping")
        for name in "train repair fill edit rig interpolate compare sample".split()
    },
    *{(name, "files") for name in "repair fill show verify".split()},
    *{("train", "folders"), ("interpolate", "first"), ("interpolate", "second")},
    *{
        ("compare", "motions"),
        ("sample", "--data"),
        ("sample", "--like"),
        ("rig", "file"),
        ("edit", "file"),
    },
    *{("repair", "--mask"), ("fill", "--mask"), ("lessons", "--from")},
    *{("verify", "--roster"), ("verify", "--late"), ("verify", "--teams")},
}
WORDS = {
    *{("repair", "--joint"), ("fill", "--joint"), ("edit", "--joint")},
    *{("train", "--test"), ("lessons", "--only")},
    *{("download", "--site"), ("verify", "--lesson")},
}
"""Options whose text is no file."""


def options_with_text(name):
    """The options of a subcommand that take a path or free text, by their longest name."""
    for action in subcommand_parser(name)._actions:
        is_flag = action.nargs == 0 or action.dest == "help"
        if not is_flag and not action.choices and action.type in (None, Path):
            yield max(action.option_strings, key=len, default=action.dest)


@pytest.mark.parametrize("name", list(SUBCOMMANDS))
def test_every_option_that_takes_text_has_a_row(name):
    listed = {(command, option) for command, option, _ in WRITES} | IN_OTHER_TESTS | READS | WORDS
    expected = {option for command, option in listed if command == name}
    assert set(options_with_text(name)) == expected


@pytest.fixture(scope="module")
def originals(tiny_manifolds, tmp_path_factory):
    """A folder of all that the commands read."""
    base = tmp_path_factory.mktemp("originals")
    for folder in ("motions", "handed", "out"):
        (base / folder).mkdir()
    for name, seed in (("walk.bvh", 0), ("second.bvh", 1), ("motions/third.bvh", 2)):
        write_bvh(make_take("walk", seed, seconds=2.0, rate=30.0).motion, base / name, unit=0.01)
    tiny_manifolds[0]["conv"].save(base / "model.npz")
    (base / "handed" / "ann_01.py").write_text("def tanh(x):\n    return x\n")
    (base / "roster.csv").write_text("student\nann\n")
    return base


@pytest.fixture
def place(originals, tmp_path, monkeypatch):
    """A copy of the folder, which is the current one."""
    folder = tmp_path / "place"
    shutil.copytree(originals, folder)
    monkeypatch.chdir(folder)
    return folder


ROWS = list(WRITES)
NAMES = [" ".join(row) for row in ROWS]
SLOW = {"demo"}


def row_words(row):
    return WRITES[row][0].split()


@pytest.mark.parametrize("row", ROWS, ids=NAMES)
def test_a_file_of_the_users_is_not_lost(row, place, shared_grading, capsys):
    path = place / "out" / row[2]
    path.write_text("my notes\n")
    status = main(row_words(row))
    said = capsys.readouterr()
    fate = WRITES[row][1]
    if fate == REFUSED:
        assert status == 2
        assert "out/" + row[2] in said.err and "--overwrite" in said.err
    if fate == NUMBERED:
        path = path.with_suffix(f".1{path.suffix}")
    assert path.read_text() == "my notes\n"


@pytest.mark.parametrize(
    "row", [row for row in ROWS if WRITES[row][1] == REFUSED and row[0] not in SLOW]
)
def test_overwriting_follows_a_link_and_keeps_the_mode(row, place, shared_grading):
    kept = place / "elsewhere"
    kept.write_text("my notes\n")
    kept.chmod(0o640)
    path = place / "out" / row[2]
    path.symlink_to(kept)
    assert main([*row_words(row), "--overwrite"]) in (0, 1)
    assert path.is_symlink()
    assert kept.read_bytes() != b"my notes\n"
    assert kept.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("row", [row for row in ROWS if WRITES[row][1] != KEPT], ids=str)
def test_a_pipe_is_refused(row, place, shared_grading, capsys):
    path = place / "out" / row[2]
    os.mkfifo(path)
    assert main([*row_words(row), "--overwrite"]) == 2
    assert re.search("is no (regular )?file", capsys.readouterr().err)
    assert path.is_fifo()


@pytest.mark.parametrize(
    "row", [row for row in ROWS if WRITES[row][1] == REFUSED and "walk.bvh" in WRITES[row][0]]
)
def test_a_source_under_another_name_is_not_replaced(row, place, capsys):
    before = (place / "walk.bvh").read_bytes()
    os.link(place / "walk.bvh", place / "out" / row[2])
    assert main(row_words(row)) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert (place / "walk.bvh").read_bytes() == before


AGAIN = [REPAIR, FILL, INTERPOLATE, COMPARE, "rig walk.bvh -o out/it.json", "show walk.bvh -o out"]


@pytest.mark.parametrize("command", AGAIN)
def test_the_same_command_can_be_given_again(command, place):
    assert main(command.split()) == 0
    assert main(command.split()) == 0


def test_a_page_is_renewed_unless_it_was_edited(place, capsys):
    assert main(FILL.split()) == 0
    others = [word.replace("20", "30") for word in FILL.split()]
    assert main(others) == 0
    page = place / "out" / "it.html"
    page.write_text(page.read_text().replace("<h1>", "<h1>My "))
    edited = page.read_bytes()
    assert main(FILL.split()) == 2
    assert "it.html" in capsys.readouterr().err
    assert page.read_bytes() == edited


def test_findings_that_were_edited_stay(place, capsys):
    assert main(REPAIR.split()) == 0
    findings = place / "out" / "found.json"
    edited = '[{"joint": "left_wrist", "frames": [3, 4], "accept": true}]\n'
    findings.write_text(edited)
    assert main("repair walk.bvh -m model.npz --dry-run --findings out/found.json".split()) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert findings.read_text() == edited


def test_an_empty_file_is_written(place, run):
    (place / "out" / "it.json").touch()
    run("rig", "walk.bvh", "-o", "out/it.json")
    assert "left_wrist" in (place / "out" / "it.json").read_text()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files to others")
def test_the_owner_of_a_file_stays(place, run):
    path = place / "out" / "it.json"
    path.write_text("my notes\n")
    os.chown(path, 1234, 1235)
    run("rig", "walk.bvh", "-o", "out/it.json", "--overwrite")
    assert (path.stat().st_uid, path.stat().st_gid) == (1234, 1235)


@pytest.mark.parametrize(
    "command",
    [
        "compare walk.bvh second.bvh -m model.npz -o out/it --picture out/it",
        "repair walk.bvh -m model.npz -o out/it.bvh --findings out/it.bvh",
        "repair walk.bvh -m model.npz -o out/it.bvh --html --findings out/it.html",
        "verify handed --csv out/it.csv --json out/it.csv",
        "verify handed --csv out/it.csv --json out/it_statistics.csv",
        "verify handed --csv out/it.csv --roster roster.csv --json out/it_import.csv",
        "verify handed --json out/it.zip --feedback out/it.zip",
    ],
)
def test_two_outputs_with_one_name_are_refused(command, place, error_of):
    assert "would both write it" in error_of(*command.split())
    assert not any((place / "out").iterdir())


@pytest.mark.parametrize("command", [REPAIR, FILL])
def test_a_page_that_is_a_link_to_the_motion_is_refused(command, place, error_of):
    (place / "out" / "it.html").symlink_to("it.bvh")
    assert "would both write it" in error_of(*command.split())
    assert not (place / "out" / "it.bvh").exists()


def test_the_marks_do_not_replace_the_corrections(place, error_of):
    corrections = place / "out" / "corrections.csv"
    corrections.write_text("student,exercise,points,reason\nann,tanh,1,right\n")
    error = error_of("verify", "handed", "--csv", corrections)
    assert "is the name of the corrections" in error
    assert os.listdir(place / "out") == ["corrections.csv"]


def test_a_release_needs_a_name(place, error_of):
    assert "there is a folder of this name" in error_of("lessons", "--release", "", "03")


def test_a_model_needs_its_suffix(place, error_of):
    assert "npz" in error_of(*TRAIN.replace("it.npz", "second.bvh").split())


def test_the_marks_do_not_replace_the_roster(place, error_of):
    before = (place / "roster.csv").read_text()
    error_of(*VERIFY.replace("out/it.csv", "roster.csv").split())
    assert (place / "roster.csv").read_text() == before


def test_a_link_to_nothing_makes_its_file(place, run):
    (place / "out" / "it.json").symlink_to(place / "new.json")
    run("rig", "walk.bvh", "-o", "out/it.json")
    assert "left_wrist" in (place / "new.json").read_text()


def test_functions_replace_what_they_are_told_to(place):
    """In Python an output is a parameter of its own, as of `numpy.save`."""
    motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    write_bvh(motion, "second.bvh")
    assert "Frames: 30" in Path("second.bvh").read_text()
    assert np.isfinite(motion.positions()).all()


def test_findings_of_one_name_in_two_folders_are_kept_apart(place, run):
    for folder in ("a", "b"):
        (place / "both" / folder).mkdir(parents=True)
        shutil.copy(place / "walk.bvh", place / "both" / folder)
    run("repair", "both", "-m", "model.npz", "-o", "out", "--project", "--findings", "out")
    names = sorted(str(path.relative_to(place / "out")) for path in place.glob("out/*/*"))
    assert names == ["a/walk.bvh", "a/walk.json", "b/walk.bvh", "b/walk.json"]
