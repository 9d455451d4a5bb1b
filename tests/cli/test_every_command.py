"""Every subcommand: its help has an example; every failure is one line, status 2 and no file."""

import os
import shutil

import numpy as np
import pytest
from acclaim_files import FILES

from data_synth import make_take
from numpy_cae.cli import SUBCOMMANDS, main
from numpy_cae.mocap import write_bvh

NAMES = list(SUBCOMMANDS)

# WALK is a motion, FOLDER holds it, MODEL suits it; OUT.xyz can be written. Each case replaces one.
LINES = (FILES / "commands.txt").read_text().splitlines()
COMMANDS = {line.split()[0]: line for line in LINES}


@pytest.fixture(scope="module")
def things(tiny_manifolds, tmp_path_factory):
    """What the words of a command stand for, all of it valid; in `base` also what is not."""
    base = tmp_path_factory.mktemp("things")
    (base / "motions").mkdir()
    (base / "empty").mkdir()
    for seed in range(2):
        motion = make_take("walk", seed, seconds=2.0, rate=50.0).motion
        write_bvh(motion, base / "motions" / f"walk_{seed}.bvh", unit=0.01)
    for name, kind in (("model", "conv"), ("sequences", "sequence")):
        tiny_manifolds[0][kind].save(base / f"{name}.npz")
    np.savez(base / "strange.npz", a=np.zeros(3))
    (base / "plain.txt").write_text("a note\n")
    for number, mask in enumerate(
        ["{", "[]", '[{"joint": 3}]', '[{"joint": "head", "frames": [1, 2]}, {"limb": "tail"}]']
    ):
        (base / f"mask_{number}.json").write_text(mask)
    os.mkfifo(base / "pipe.json")
    text = (base / "motions" / "walk_0.bvh").read_text()
    (base / "cut.bvh").write_text(text[: text.index("MOTION")])
    shutil.copy(FILES / "one_joint.bvh", base / "paw.bvh")
    words = {"WALK": "motions/walk_0.bvh", "FOLDER": "motions", "MODEL": "model.npz"}
    words["SCRIPT"] = "missing.py"
    return {"base": base, **{word: base / name for word, name in words.items()}}


def typed(things, name, out, **instead):
    """The command with other things in the place of some."""
    words = []
    for word in COMMANDS[name].split():
        if word in instead:
            words.append(str(instead[word]))
        elif word.startswith("OUT"):
            words.append(f"{out}{word[3:]}")
        else:
            words.append(str(things.get(word, word)))
    return words


def refused(capsys, argv, written):
    """One line, status 2, no traceback, nothing in the folder `written`."""
    before = sorted(written.rglob("*"))
    capsys.readouterr()
    try:
        status = main(argv)
    except SystemExit as exit_:
        status = exit_.code
    said = capsys.readouterr()
    assert status == 2, said
    assert "Traceback" not in said.err
    lines = said.err.rstrip().splitlines()
    assert lines[-1].startswith(f"numpy-cae {argv[0]}: "), said.err
    assert sum(line.startswith("numpy-cae ") for line in lines) == 1, said.err
    assert sorted(written.rglob("*")) == before
    return lines[-1]


def with_word(word):
    return [name for name in NAMES if word in COMMANDS[name].split()]


@pytest.mark.parametrize("name", NAMES)
def test_help_has_an_example(name, capsys):
    with pytest.raises(SystemExit) as exit_:
        main([name, "--help"])
    assert exit_.value.code == 0
    said = capsys.readouterr().out
    assert "example" in said
    assert f"numpy-cae {name} " in said.split("example", 1)[1]


@pytest.mark.parametrize(
    ("name", "word"),
    [(name, word) for word in ("WALK", "FOLDER", "MODEL", "SCRIPT") for name in with_word(word)],
)
def test_missing_input(name, word, things, tmp_path, capsys):
    argv = typed(things, name, tmp_path / "out", **{word: tmp_path / "missing.bvh"})
    assert "missing" in refused(capsys, argv, tmp_path)


@pytest.mark.parametrize("name", with_word("WALK"))
@pytest.mark.parametrize("wrong", ["plain.txt", "model.npz", "empty"])
def test_input_of_another_kind(name, wrong, things, tmp_path, capsys):
    argv = typed(things, name, tmp_path / "out", WALK=things["base"] / wrong)
    assert wrong in refused(capsys, argv, tmp_path)


@pytest.mark.parametrize("name", with_word("FOLDER"))
def test_an_empty_folder(name, things, tmp_path, capsys):
    argv = typed(things, name, tmp_path / "out", FOLDER=things["base"] / "empty")
    assert "empty" in refused(capsys, argv, tmp_path)


@pytest.mark.parametrize("name", with_word("MODEL"))
@pytest.mark.parametrize("wrong", ["strange.npz", "plain.txt", "motions", "sequences.npz"])
def test_a_model_that_is_none_or_for_other_data(name, wrong, things, tmp_path, capsys):
    argv = typed(things, name, tmp_path / "out", MODEL=things["base"] / wrong)
    assert wrong in refused(capsys, argv, tmp_path)


@pytest.mark.parametrize("name", [name for name in NAMES if "OUT" in COMMANDS[name]])
@pytest.mark.parametrize("place", ["a file's inside", "read-only"])
def test_output_that_cannot_be_written(name, place, things, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    # To the administrator no folder is read-only, but for those that the system itself makes up.
    out = tmp_path / "file" / "out" if place == "a file's inside" else "/proc/out"
    refused(capsys, typed(things, name, out), tmp_path)


ERRORS = (FILES / "command_errors.txt").read_text().splitlines()


@pytest.mark.parametrize("case", ERRORS)
def test_an_error_says_what_is_wrong(case, things, tmp_path, capsys):
    words, message = (part.strip() for part in case.split("|"))
    argv = [str(things.get(word, word)) for word in words.split()]
    argv = [word.replace("BASE", str(things["base"])) for word in argv]
    argv = [word.replace("OUT", str(tmp_path / "out")) for word in argv]
    assert message in refused(capsys, argv, tmp_path)
