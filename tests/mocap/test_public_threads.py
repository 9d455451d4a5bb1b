"""Files as people ask about them in public threads: read, repaired without harm, or refused in a
sentence that says what to do. Each is made of a synthetic walk."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.mocap.formats.write_bvh import write_bvh
from numpy_cae.mocap.load import load_motion

FRAMES = 60


@pytest.fixture
def walk(tmp_path, monkeypatch):
    """A file of a walk in centimetres in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "walk.bvh"
    write_bvh(make_take("walk", 1, 2.0, 30.0).motion, path, unit=0.01)
    return path


def rewrite(path, change_header=str, change_frame=None):
    """Change the text before the numbers, or each line of numbers: a function of its number and
    its words that returns words."""
    lines = path.read_text().splitlines()
    header = change_header("\n".join(lines[:-FRAMES]) + "\n")
    frames = lines[-FRAMES:]
    if change_frame is not None:
        frames = [" ".join(change_frame(n, line.split())) for n, line in enumerate(frames)]
    path.write_text(header + "\n".join(frames) + "\n")


def repaired_bytes(path):
    main(["repair", str(path), "-o", "out.bvh"])
    return path.with_name("out.bvh").read_bytes()


HEADERS = {
    "colons and points in names": lambda text: text.replace("OINT l", "OINT rig:l.").replace(
        "OINT r", "OINT rig:r."
    ),
    "lower case": lambda text: text.replace("HIERARCHY", "hierarchy").replace("JOINT", "joint"),
    "no blank after Frames": lambda text: text.replace("Frames: ", "Frames:"),
    "tabs": lambda text: text.replace("  ", "\t"),
    "line ends of Windows": lambda text: text.replace("\n", "\r\n"),
}


@pytest.mark.parametrize("name", HEADERS)
def test_an_odd_header_is_read_and_written_as_it_is(walk, name):
    before = load_motion(walk)
    rewrite(walk, HEADERS[name])
    odd = load_motion(walk)
    np.testing.assert_array_equal(odd.rotations, before.rotations)
    if name != "colons and points in names":  # then the rig has no names that are known
        assert repaired_bytes(walk) == walk.read_bytes()


def test_numbers_in_scientific_notation_are_read_and_kept(walk):
    before = load_motion(walk)
    rewrite(walk, change_frame=lambda n, words: [f"{float(word):.9e}" for word in words])
    np.testing.assert_allclose(load_motion(walk).rotations, before.rotations, atol=1e-9)
    assert repaired_bytes(walk) == walk.read_bytes()


def flip_root(number, words):
    """Three angles of the root's rotation, others of the same in every seventh frame."""
    a, b, c = map(float, words[3:6])
    if number % 7 == 3:
        words[3:6] = [f"{a + 180:.6f}", f"{180 - b:.6f}", f"{c + 180:.6f}"]
    return words


def turn_root(number, words):
    """An angle of the root, a whole turn more from the middle on."""
    if number > 30:
        words[5] = f"{float(words[5]) + 360:.6f}"
    return words


@pytest.mark.parametrize("change", [flip_root, turn_root])
def test_flips_and_turns_of_angles_are_no_damage(walk, change):
    rewrite(walk, change_frame=change)
    assert repaired_bytes(walk) == walk.read_bytes()


@pytest.mark.parametrize(
    ("factor", "metres"), [(0.01, 1.0), (10.0, 0.001), (0.01 / 0.0254, 0.0254)]
)
def test_metres_millimetres_and_inches_are_told_apart(tmp_path, factor, metres):
    motion = make_take("walk", 1, 2.0, 30.0).motion
    path = tmp_path / "walk.bvh"
    write_bvh(motion, path, unit=metres)
    height = np.ptp(motion.positions()[0, :, 1])
    assert np.ptp(load_motion(path).positions()[0, :, 1]) == pytest.approx(height, rel=0.05)


def test_a_wrong_frame_time_that_nobody_moves_at_is_doubted(walk):
    rewrite(walk, lambda text: text.replace("Frame Time: 0.03333333333", "Frame Time: 1.0"))
    assert any(note.in_doubt for note in load_motion(walk).notes)


REFUSED = {
    "two roots": (lambda text: text.replace("MOTION", "ROOT second\n{\n}\nMOTION"), "second ROOT"),
    "names twice": (lambda text: text.replace("JOINT rtibia", "JOINT ltibia"), "ltibia"),
    "a brace too many": (lambda text: text.replace("MOTION", "}\nMOTION"), "}"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_read_is_refused_with_its_line(walk, name):
    change, word = REFUSED[name]
    rewrite(walk, change)
    with pytest.raises(MotionFileError, match=word) as error:
        load_motion(walk)
    assert f"{walk}:" in str(error.value)


def test_decimal_commas_are_named(walk):
    rewrite(walk, change_frame=lambda n, words: [word.replace(".", ",") for word in words])
    with pytest.raises(MotionFileError, match="comma"):
        load_motion(walk)


def test_values_that_are_no_numbers_are_mended(walk):
    before = load_motion(walk)
    rewrite(walk, change_frame=lambda n, words: ["nan"] * 6 + words[6:] if n == 20 else words)
    assert main(["repair", str(walk), "-o", "out.bvh"]) == 0
    after = load_motion(walk.with_name("out.bvh"))
    assert np.abs(after.positions() - before.positions()).max() < 0.02
