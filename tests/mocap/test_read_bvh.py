"""A BVH file is read as it stands, however its program spaced, cased or ordered it.

Its unit is guessed from its bones, whatever the pose and wherever the root.
"""

import json
import logging
from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import FILES
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_bvh import PlainJoint, bvh_text, plain_positions

from data_synth import make_take
from numpy_cae.mocap import MotionFileError, load_motion, read_bvh, write_bvh
from numpy_cae.mocap.formats import text_file
from numpy_cae.mocap.units import UNITS, describe_unit, guess_unit

WALK = make_take("walk", 1, 1.0, 30.0).motion
numbers = st.floats(-300, 300, allow_nan=False).map(lambda x: round(x, 4))
CHANNELS = [axis + kind for kind in ("position", "rotation") for axis in "XYZ"]


@st.composite
def drawn_files(draw):
    """A tree depth first, every joint with its own channels in its own order, and a motion."""
    joints = []
    for index in range(draw(st.integers(1, 7))):
        # Depth first: a joint hangs on the joint before it or on one of that one's ancestors.
        line_up = [index - 1]
        while line_up[-1] > 0:
            line_up.append(joints[line_up[-1]].parent)
        channels = draw(st.lists(st.sampled_from(CHANNELS), unique=True, min_size=index == 0))
        joints.append(
            PlainJoint(
                name=draw(st.sampled_from(["bone", "mixamorig:Hips", "Left Arm", "骨"]))
                + str(index),
                parent=draw(st.sampled_from(line_up)) if index else -1,
                offset=draw(st.lists(numbers, min_size=3, max_size=3)),
                channels=channels,
                tip=draw(st.none() | st.lists(numbers, min_size=3, max_size=3)),
            )
        )
    row = st.lists(numbers, min_size=(n := sum(len(j.channels) for j in joints)), max_size=n)
    return joints, draw(st.lists(row, min_size=1, max_size=3))


@settings(max_examples=40, deadline=None)
@given(drawn_files())
def test_positions_are_those_of_explicit_matrices(tmp_path_factory, drawn):
    joints, values = drawn
    path = tmp_path_factory.mktemp("drawn") / "drawn.bvh"
    path.write_text(bvh_text(joints, values), encoding="utf-8")
    motion = read_bvh(path, unit=0.5)
    expected = 0.5 * plain_positions(joints, values)
    np.testing.assert_allclose(motion.positions(), expected, rtol=0, atol=1e-9)
    assert motion.skeleton.names == tuple(joint.name for joint in joints)
    assert motion.skeleton.parents == tuple(joint.parent for joint in joints)
    np.testing.assert_allclose(motion.skeleton.offsets, [0.5 * np.array(j.offset) for j in joints])
    tips = {index: joint.tip for index, joint in enumerate(joints) if joint.tip is not None}
    assert motion.skeleton.end_sites.keys() == tips.keys()
    for index, tip in tips.items():
        np.testing.assert_allclose(motion.skeleton.end_sites[index], 0.5 * np.array(tip))


TIDY = (FILES / "tidy.bvh").read_text()


@pytest.fixture
def read_text(tmp_path):
    def read(text: str | bytes, **arguments):
        path = tmp_path / "take.bvh"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_bvh(path, **arguments)

    return read


UNTIDY = json.loads((FILES / "untidy.json").read_text(encoding="utf-8"))
"""What the parts of the tidy file are replaced by."""


@pytest.mark.parametrize(("name", "changes"), UNTIDY.items(), ids=UNTIDY)
def test_spacing_and_case_do_not_matter(read_text, name, changes):
    untidied = TIDY
    for old, new in changes:
        assert old in untidied
        untidied = untidied.replace(old, new)
    latin = name == "beyond UTF-8"
    motion = read_text(untidied.encode("latin-1" if latin else "utf-8"), unit=0.01)
    tidy = read_text(TIDY, unit=0.01)
    assert motion.skeleton.names == ("Hüfte" if latin else "Hips", "mixamorig:Left Leg")
    assert motion.rate == tidy.rate
    np.testing.assert_array_equal(motion.positions(), tidy.positions())
    np.testing.assert_array_equal(motion.skeleton.end_sites[1], tidy.skeleton.end_sites[1])


TIMES = {".0083333": 120, "0.0333333": 30, "0.033367": 1 / 0.033367, "0.04": 25, "1e-3": 1000}


@pytest.mark.parametrize(("time", "rate"), TIMES.items())
def test_the_rounding_of_a_frame_time_is_undone(read_text, time, rate):
    assert read_text(TIDY.replace(".0083333", time), unit=1.0).rate == rate


@pytest.mark.parametrize(("frames", "level"), [("30", "INFO"), ("1000", "WARNING")])
def test_guesses_are_logged_and_what_is_odd_is_warned_about_once(tmp_path, caplog, frames, level):
    path = tmp_path / "walk.bvh"
    write_bvh(WALK, path, unit=0.01)
    path.write_text(path.read_text().replace("Frames: 30", f"Frames: {frames}"))
    caplog.set_level(logging.INFO, logger="numpy_cae.mocap.load")
    note = load_motion(path).note
    assert [(r.levelname, r.message) for r in caplog.records] == [(level, f"{path}: {note}")]


ODD = {
    "more frames": (TIDY.replace("Frames: 2", "Frames: 9"), "Frames: says 9, but 2 lines"),
    "comments": (TIDY.replace("  JOINT", "# by hand\n\n  JOINT"), "skipped 1 unknown line of "),
    "still": (TIDY[: TIDY.index("1e1")] + "10 90 20 1 2 3 4 5 6\n", "nothing moves: all frames"),
    "rate": (TIDY.replace(".0083333", "1"), "Frame Time: 1 is 1 frames a second; is that right"),
    "brackets": (TIDY.replace("OFFSET 0 -40 0", "OFFSET [0, -40., 0]"), "assumed"),
}


@pytest.mark.parametrize(("text", "note"), ODD.values(), ids=ODD)
def test_what_is_odd_is_read_as_it_stands_and_noted(tmp_path, read_text, text, note):
    (tmp_path / "odd.bvh").write_text(text)
    tidy, odd = read_text(TIDY), load_motion(tmp_path / "odd.bvh")
    # One leg alone has no two limbs to measure: the unit is assumed.
    assert note in odd.note and "assumed" in tidy.note and "; " not in tidy.note
    if not note.startswith("nothing moves"):
        np.testing.assert_array_equal(odd.positions(), tidy.positions())
    odd.save(tmp_path / "same.bvh")
    assert (tmp_path / "same.bvh").read_text() == text


@pytest.mark.parametrize("step", [1, 2, 3, 7])
def test_a_table_read_in_blocks_holds_the_numbers_of_each_line(tmp_path, monkeypatch, step):
    monkeypatch.setattr(text_file, "MAX_LINE", 200)
    rng = np.random.default_rng(step)
    forms = ["{:.6f}", "{:+.3e}", "{:.17g}", " {:.0f}.", "{:.1f}\t", "{:.2f}\xa0"]
    numbers = rng.normal(size=(99, 4)) * 10.0 ** rng.integers(-9, 9, (99, 4))
    rows = [" ".join(rng.choice(forms).format(value) for value in row) for row in numbers]
    (tmp_path / "numbers").write_text("a head\n\n" + "\n \n".join(rows), encoding="utf-8")
    file = text_file.TextFile.read(tmp_path / "numbers")
    values, lines = file.table(1, 4, "four numbers", step)
    assert lines == 99
    np.testing.assert_array_equal(values, [[float(w) for w in r.split()] for r in rows[::step]])
    rows[98] = rows[98].replace(rows[98].split()[2], "1_0")
    (tmp_path / "numbers").write_text("\n".join(rows), encoding="utf-8")
    with pytest.raises(MotionFileError, match=r"numbers:99: '1_0' is not a number"):
        text_file.TextFile.read(tmp_path / "numbers").table(0, 4, "four numbers", step)


def test_giants_and_dwarfs_are_doubted():
    for unit in UNITS.values():
        assert guess_unit(1.4 / unit)[0] == guess_unit(2.0 / unit)[0] == unit
    giant = guess_unit(4.0)[1]
    assert giant.in_doubt and "4.0 m tall, which no adult is" in giant.text
    assert describe_unit(0.1, "as given", 18.2).in_doubt
    assert not describe_unit(0.01, "as given", 1.8).in_doubt
    assert "metres (assumed: " in guess_unit(0.0)[1].text


@pytest.mark.parametrize(
    "take",
    ["cmu/bvh/02_03_first_frames.bvh", "bandai/dataset-2_run_normal_001.bvh"]
    + [f"cmu/asfamc/{trial}" for trial in ("01/01_01.amc", "02/02_01.amc", "03/03_01.amc")],
)
def test_real_skeletons_in_any_unit_are_measured_right(data_folder, tmp_path, take):
    short = load_motion(data_folder / take).at(slice(5))
    prop = {len(short.skeleton.names) - 1: np.array([9.0, 0.0, 0.0])}
    short = replace(short, skeleton=replace(short.skeleton, end_sites=prop))
    for unit in UNITS.values():
        write_bvh(short, tmp_path / "take.bvh", unit)
        assert load_motion(tmp_path / "take.bvh").unit == unit
