"""What each option that reads does with a pipe, a device, a byte order mark or a strange file."""

import codecs
import json
import os
import shutil
from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.mocap import write_bvh
from numpy_cae.motion import JOINTS

READING = {
    "mapping": "rig walk.bvh --mapping ODD",
    "mask": "repair walk.bvh -m model.npz --dry-run --mask ODD",
    "model": "repair walk.bvh --dry-run -m ODD",
    "motion": "rig ODD.bvh",
    "like": "sample -m model.npz -o out.bvh --like ODD.bvh",
    "first": "interpolate ODD.bvh walk.bvh -m model.npz -o out.bvh",
    "second": "interpolate walk.bvh ODD.bvh -m model.npz -o out.bvh",
    "show": "show ODD.bvh -o out.html",
    "compare": "compare walk.bvh ODD.bvh -m model.npz",
    "script": "verify ODD.py",
    "roster": "verify walk.py --csv marks.csv --roster ODD",
    "late": "verify walk.py --csv marks.csv --late ODD",
    "teams": "verify walk.py --csv marks.csv --roster roster.csv --teams ODD",
    "output": "repair walk.bvh -m model.npz -o ODD.bvh",
}


@pytest.fixture(scope="module")
def originals(tiny_manifolds, tmp_path_factory):
    base = tmp_path_factory.mktemp("read")
    write_bvh(make_take("walk", 0, seconds=2.0, rate=30.0).motion, base / "walk.bvh", unit=0.01)
    tiny_manifolds[0]["conv"].save(base / "model.npz")
    (base / "walk.py").write_text("def tanh(x):\n    return x\n")
    (base / "roster.csv").write_text("student\nann\n")
    return base


@pytest.fixture
def place(originals, tmp_path, monkeypatch):
    shutil.copytree(originals, tmp_path / "place")
    monkeypatch.chdir(tmp_path / "place")
    return tmp_path / "place"


def odd_words(command):
    return command.replace("ODD", "odd").split()


@pytest.mark.parametrize("name", list(READING))
def test_a_pipe_is_refused(name, place, error_of):
    for suffix in ("", ".bvh", ".py"):
        os.mkfifo(place / f"odd{suffix}")
    assert "odd" in error_of(*odd_words(READING[name]))


@pytest.mark.parametrize("name", list(READING))
def test_a_device_without_end_is_refused(name, place, error_of):
    for suffix in ("", ".bvh", ".py"):
        (place / f"odd{suffix}").symlink_to("/dev/zero")
    assert "odd" in error_of(*odd_words(READING[name]))


def test_a_mapping_with_a_byte_order_mark_is_read(place, run):
    run("rig", "walk.bvh", "-o", "mapping.json")
    text = (place / "mapping.json").read_bytes()
    (place / "marked.json").write_bytes(codecs.BOM_UTF8 + text)
    run("rig", "walk.bvh", "--mapping", "marked.json")


def test_a_mapping_that_is_too_long_is_refused(place, error_of):
    (place / "long.json").write_text('{"hips": "' + "a" * 2_000_000 + '"}')
    assert "bytes" in error_of("rig", "walk.bvh", "--mapping", "long.json")


@pytest.mark.parametrize(
    ("entry", "message"),
    [({}, "names no joint, limb or frames"), ({"frames": [0, 59]}, "no frame is left")],
)
def test_a_mask_of_the_whole_motion_is_refused(entry, message, place, error_of):
    (place / "mask.json").write_text(json.dumps([entry]))
    words = "repair walk.bvh -m model.npz -o out.bvh --mask mask.json".split()
    assert message in error_of(*words)
    assert not (place / "out.bvh").exists()


def test_a_refusal_of_all_that_a_mask_marks_names_its_file(place, error_of):
    (place / "mask.json").write_text('[{"joint": "hips", "frames": [3, 9]}]')
    words = "repair walk.bvh -m model.npz --dry-run --mask mask.json".split()
    assert "mask.json: hips cannot move alone" in error_of(*words)


@pytest.mark.parametrize(
    "command",
    [
        "sample -m model.npz -o out.bvh --number 999999999999",
        "verify walk.py --memory-limit 1e20",
        "verify walk.py --time-limit 1e308",
    ],
)
def test_a_number_beyond_all_use_is_refused(command, place, error_of):
    assert "expected at most" in error_of(*command.split())


def test_keyframes_further_apart_than_the_motion_is_long_change_nothing(place, run):
    run(*"fill walk.bvh -m model.npz -o out.bvh --keyframes".split(), 10**20)
    assert (place / "out.bvh").read_bytes() == (place / "walk.bvh").read_bytes()


@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_a_zip_file_that_is_no_file_is_not_opened(kind, place, capsys):
    if kind == "pipe":
        os.mkfifo(place / "odd.zip")
    else:
        (place / "odd.zip").symlink_to("/dev/zero")
    assert main(["verify", "odd.zip"]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "the zip file is not opened: it is no file" in said


def test_corrections_that_are_a_link_to_nowhere_are_refused(place, error_of):
    (place / "corrections.csv").symlink_to("nowhere.csv")
    words = "verify walk.py --csv marks.csv".split()
    assert "corrections.csv: there is no such file" in error_of(*words)


@pytest.mark.skipif(not os.path.exists("/proc/self/mem"), reason="needs Linux")
def test_a_table_that_cannot_be_read_is_named(place, error_of):
    words = "verify walk.py --csv marks.csv --roster /proc/self/mem".split()
    assert "/proc/self/mem: cannot be read: " in error_of(*words)


def test_a_long_list_is_refused(place, error_of):
    (place / "late.txt").write_bytes(b"a" * (2**24 + 1))
    words = "verify walk.py --csv marks.csv --late late.txt".split()
    assert "late.txt: it is larger than 16 MB" in error_of(*words)


def test_a_mask_of_too_many_entries_is_refused(place, error_of):
    entry = '{"joint": "head", "frames": [3, 4]}'
    (place / "mask.json").write_text("[" + ",".join([entry] * 20_001) + "]")
    words = "repair walk.bvh -m model.npz --dry-run --mask mask.json".split()
    assert "20001 entries" in error_of(*words)


def test_evidence_with_half_a_character_can_be_written(place, run):
    mask = [{"joint": JOINTS[7], "frames": [20, 30], "kind": "marked", "evidence": "\ud800"}]
    (place / "mask.json").write_text(json.dumps(mask))
    words = "repair walk.bvh -m model.npz -o out.bvh --mask mask.json --findings f.json --html"
    run(*words.split())
    assert json.loads((place / "f.json").read_text())[0]["evidence"] == "\\ud800"


@pytest.mark.parametrize("columns", ["1", "2", "12"])
def test_a_narrow_terminal_gets_help(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", columns)
    with pytest.raises(SystemExit):
        main(["repair", "--help"])
    assert "example" in capsys.readouterr().out


def test_a_word_for_lost_values_is_not_called_a_comma(place, error_of):
    text = (place / "walk.bvh").read_text()
    (place / "lost.bvh").write_text(text.replace("Frame Time: 0.03333333333", "Frame Time: nan"))
    message = error_of("rig", "lost.bvh")
    assert "finite number" in message
    assert "comma" not in message


@pytest.mark.parametrize("floor", ["1e300", "-1e300", "10001"])
def test_a_floor_that_is_out_of_the_world_is_refused(floor, place, error_of):
    assert "floor" in error_of("rig", "walk.bvh", f"--floor={floor}")


def test_memory_that_ran_out_is_said(place, error_of, monkeypatch):
    def without_memory(*_, **__):
        raise MemoryError("Unable to allocate 118. KiB")

    monkeypatch.setattr("numpy_cae.array_file.np.load", without_memory)
    message = error_of("repair", "walk.bvh", "--dry-run")
    assert "not enough memory" in message
    assert "model" not in message


def test_a_mirrored_file_is_said(place, capsys, run):
    """As from a left-handed program: x is turned round, the names of the sides stay."""
    motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    turned = np.array([-1.0, 1.0, 1.0])
    skeleton = replace(motion.skeleton, offsets=motion.skeleton.offsets * turned, end_sites={})
    mirrored = replace(
        motion,
        skeleton=skeleton,
        translations=motion.translations * turned,
        rotations=motion.rotations * [1.0, 1.0, -1.0, -1.0],
    )
    write_bvh(mirrored, place / "mirrored.bvh", unit=0.01)
    run("rig", "mirrored.bvh")
    assert "mirror image" in capsys.readouterr().out
