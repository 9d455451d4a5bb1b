"""Every subcommand: its help has an example; every failure is one line, status 2 and no file."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import SUBCOMMANDS, main
from numpy_cae.manifold import save_manifold
from numpy_cae.motion import write_bvh

NAMES = list(SUBCOMMANDS)

# WALK is a motion, FOLDER holds it, MODEL suits it; OUT.xyz can be written. Each case replaces one.
COMMANDS = {
    "demo": "demo -o OUT --quiet",
    "download": "download cmu --subjects 1 -o OUT --site http://127.0.0.1:9 --quiet",
    "train": "train FOLDER -o OUT.npz --epochs 1 --filters 4 --quiet",
    "repair": "repair WALK -m MODEL -o OUT.bvh",
    "fill": "fill WALK -m MODEL -o OUT.bvh --joint left_wrist",
    "interpolate": "interpolate WALK WALK -m MODEL -o OUT.bvh",
    "compare": "compare FOLDER -m MODEL -o OUT.csv",
    "sample": "sample -m MODEL --data FOLDER -o OUT.bvh --seconds 1",
    "rig": "rig WALK -o OUT.json",
    "show": "show WALK -o OUT",
    "report": "report --data FOLDER -m MODEL -o OUT --test walk_1.bvh",
    "study": "study --data FOLDER --test walk_1.bvh -o OUT --quiet",
    "lessons": "lessons OUT --from FOLDER",
    "verify": "verify SCRIPT",
    "bench": "bench --rounds 1",
}


ONE_JOINT = """HIERARCHY
ROOT paw { OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
End Site { OFFSET 0 1 0 } }
MOTION
Frames: 2
Frame Time: 0.0333
0 0 0 0 0 0
0 1 0 0 9 0
"""


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
        save_manifold(tiny_manifolds[0][kind], base / f"{name}.npz")
    np.savez(base / "strange.npz", a=np.zeros(3))
    (base / "plain.txt").write_text("a note\n")
    for number, mask in enumerate(["{", "[]", '[{"joint": 3}]', '[{}, {"limb": "tail"}]']):
        (base / f"mask_{number}.json").write_text(mask)
    text = (base / "motions" / "walk_0.bvh").read_text()
    (base / "cut.bvh").write_text(text[: text.index("MOTION")])
    (base / "paw.bvh").write_text(ONE_JOINT)
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


ERRORS = """
train FOLDER -o OUT.npz --test *_1.bvh x*                   | no file matches 'x*'
train FOLDER -o OUT.npz --test *                            | none is left to train
train FOLDER -o OUT.npz --window 150                        | multiple of 8
train FOLDER -o OUT.npz --latent 3                          | not an option of the convolutional
train FOLDER -o OUT.npz --model sequential --window 64      | not an option of the sequential
train FOLDER -o OUT.npz --model sequential --recipe best    | is for the convolutional model
train FOLDER -o OUT.npz --model sequential --test *.txt     | no file matches *.txt
train FOLDER -o OUT.npz --model sequential --test *         | every file matches *
train FOLDER -o OUT.npz --model sequential --frames 500     | as long as a clip of 500 frames
train FOLDER -o OUT.npz --epochs 0                          | argument --epochs: 0 is not 1 or
train FOLDER -o OUT.npz --rate nan                          | argument --rate: nan is not
train FOLDER -o OUT.npz --unit 0                            | argument --unit: 0 is not
train FOLDER -o OUT/no/m.npz                                | No such file or directory
repair BASE/cut.bvh -m MODEL -o OUT.bvh                     | ends without MOTION
repair BASE/paw.bvh -m MODEL -o OUT.bvh                     | paw.bvh
repair WALK -m MODEL -o OUT.fbx                             | written as .bvh
repair FOLDER -m MODEL -o OUT.bvh                           | expected a folder
repair WALK -m MODEL -o OUT.bvh --project --smooth          | use it without --joint
fill WALK -m MODEL -o OUT.bvh                               | say what is missing
fill WALK -m MODEL -o OUT.bvh --joint head --keyframes 15   | say what is missing
fill WALK -m MODEL -o OUT.bvh --joint nose                  | there is no joint 'nose'
fill WALK -m MODEL -o OUT.bvh --joint left_hip              | left_hip is fixed
fill WALK -m MODEL -o OUT.bvh --mask BASE/mask_0.json       | mask_0.json:1: not JSON
fill WALK -m MODEL -o OUT.bvh --mask BASE/mask_1.json       | mask_1.json: expected a list
fill WALK -m MODEL -o OUT.bvh --mask BASE/mask_2.json       | entry 1: expected
fill WALK -m MODEL -o OUT.bvh --mask BASE/mask_3.json       | entry 2: there is no limb 'tail'
fill WALK -m MODEL -o OUT.bvh --joint head --frames 80 400  | the motion has 0 to 99
fill WALK -m MODEL -o OUT.bvh --joint head --frames 90 40   | the first is after the last
interpolate WALK WALK -m MODEL -o OUT.bvh --share 2         | argument --share: 2 is not
sample -m MODEL -o OUT.bvh                                  | requires motions in --data
sample -m MODEL -o OUT.fbx --prior uniform                  | written as .bvh
compare WALK -m MODEL                                       | one motion alone
compare WALK BASE/no.bvh -m MODEL                           | no such file
show BASE/cut.bvh -o OUT                                    | cut.bvh
study --data FOLDER -o OUT --quiet                          | leaves nothing of motions to test
report -o OUT                                               | required: --data
report --data FOLDER -o OUT --only nonsense                 | argument --only: invalid choice
""".strip().splitlines()


@pytest.mark.parametrize("case", ERRORS)
def test_an_error_says_what_is_wrong(case, things, tmp_path, capsys):
    words, message = (part.strip() for part in case.split("|"))
    argv = [str(things.get(word, word)) for word in words.split()]
    argv = [word.replace("BASE", str(things["base"])) for word in argv]
    argv = [word.replace("OUT", str(tmp_path / "out")) for word in argv]
    assert message in refused(capsys, argv, tmp_path)
