"""Pins: read from JSON, converted to the mean skeleton, and reached."""

import json
from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.beyond import Pin, constrain, read_pins
from numpy_cae.beyond.pins import pins_on_mean_skeleton
from numpy_cae.manifold import Repaired, save_manifold
from numpy_cae.motion import (
    JOINTS,
    MotionFileError,
    body_positions,
    change_lengths,
    write_bvh,
)

WRIST = JOINTS.index("left_wrist")


@pytest.fixture(scope="module")
def motion():
    return replace(make_take("walk", 3, seconds=2.0, rate=120.0).motion, unit=0.01)


WRONG = {
    '{"joint"': "not JSON",
    "[]": "a list of pins",
    "[3]": "pin 1: expected an object",
    '[{"joint": "tail", "frames": [0, 1], "at": [0, 0, 0]}]': "pin 1: there is no joint 'tail'",
    '[{"joint": "head", "frames": [0, 1]}]': "expected either",
    '[{"joint": "head", "frames": [0, 1], "at": [0, 0]}]': "is not a point",
    '[{"joint": "head", "frames": [0, 1], "at": [null, null, null]}]': "is not a point",
    '[{"joint": "head", "frames": [0, 1], "at": [0, true, 0]}]': "is not a point",
    '[{"joint": "head", "frames": [0, 1], "path": [[0, 1, 0]]}]': "two points or more",
    '[{"joint": "head", "frames": [0, 1], "path": [[0, 1, 0], [0, null, 0]]}]': "y is null in some",
    '[{"joint": "head", "frames": [9, 2], "at": [0, 1, 0]}]': "frames 9 to 2",
    '[{"joint": "head", "frames": [0, 240], "at": [0, 1, 0]}]': "the motion has 0 to 239",
    '[{"joint": "head", "frame": 3, "at": [0, 1, 0]}]': "unknown: frame",
}


@pytest.mark.parametrize(("text", "message"), WRONG.items())
def test_an_error_names_the_pin(motion, tmp_path, text, message):
    file = tmp_path / "pins.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(MotionFileError, match="pins") as raised:
        read_pins(file, motion)
    assert message in str(raised.value)


def test_pins_are_in_the_axes_and_joint_names_of_the_file(motion, tmp_path):
    file = tmp_path / "pins.json"
    file.write_text('[{"joint": "lwrist", "frames": [0, 1], "at": [10, null, 130]}]')
    (pin,) = read_pins(file, replace(motion, up="z", floor=1.0))
    assert pin.joint == "left_wrist"
    np.testing.assert_allclose(pin.points, [[0.1, 0.3, np.nan]])


def test_pins_are_in_the_unit_and_frames_of_the_file(motion, untrained_manifold, tmp_path):
    file = tmp_path / "pins.json"
    wrist = {"joint": "left_wrist", "frames": [41, 41], "at": [10, 120, None]}
    hips = {"joint": "hips", "frames": [0, 100], "path": [[0, None, 0], [50, None, 200]]}
    file.write_text(json.dumps([wrist, hips]))
    pins = read_pins(file, motion)
    targets = pins_on_mean_skeleton(pins, untrained_manifold.body(motion))
    # Every fourth frame of 120 Hz is a pose; the nearest to frame 41 is the tenth.
    np.testing.assert_array_equal(np.argwhere(targets.weights[:, WRIST]), [[10, 0], [10, 1]])
    np.testing.assert_allclose(targets.targets[10, WRIST], [0.1, 1.2, 0])
    np.testing.assert_allclose(targets.targets[[0, 25], 0], [[0, 0, 0], [0.5, 0, 2.0]])
    assert not targets.weights[26:].any() and not targets.weights[:, 0, 1].any()
    body = untrained_manifold.body(motion)
    mean = change_lengths(body.positions, body.lengths, untrained_manifold.lengths)
    back = np.einsum("jk,fkx->fjx", targets.body, mean)
    np.testing.assert_allclose(back, body.positions, atol=1e-9)


@pytest.fixture(scope="module")
def brief(motion):
    return motion.at(slice(0, 80))


def unrepaired(motion):
    nothing = np.zeros((len(motion), 20))
    return Repaired(motion, nothing > 0, nothing)


def test_a_pinned_joint_of_a_rig_meets_its_target_and_distant_frames_stay(motion, walk_manifold):
    own = body_positions(motion)
    pin = Pin("left_wrist", 20, 40, own[[30], WRIST] + [0.0, 0.05, 0.0])
    pinned = constrain(motion, unrepaired(motion), walk_manifold, pins=[pin]).motion
    # The arm is a little too short for the last frames.
    assert pin.errors(pinned).max() < 0.01
    assert np.median(pin.errors(pinned)) < 1e-9
    steps = np.diff(body_positions(pinned)[:, WRIST] - own[:, WRIST], axis=0)
    assert np.linalg.norm(steps, axis=-1).max() < 0.02
    np.testing.assert_array_equal(pinned.rotations[140:], motion.rotations[140:])
    np.testing.assert_array_equal(pinned.translations[140:], motion.translations[140:])
    assert np.linalg.norm(body_positions(pinned) - own, axis=-1)[:, 0].max() < 0.1


def test_pinned_hips_take_the_rest_of_the_way_along(brief, walk_manifold):
    own = body_positions(brief)
    pin = Pin("hips", 10, 50, own[[10, 50], 0] * [1, np.nan, 1] + [[0, 0, 0], [0.2, 0, 0]])
    pinned = constrain(brief, unrepaired(brief), walk_manifold, pins=[pin])
    assert pin.errors(pinned.motion).max() < 1e-9
    steps = np.diff(body_positions(pinned.motion)[:, 0], axis=0) - np.diff(own[:, 0], axis=0)
    assert np.linalg.norm(steps, axis=-1).max() < 0.05


def test_pins_from_the_command_line(brief, untrained_manifold, tmp_path, capsys, run, error_of):
    model, file, pins, out = (tmp_path / n for n in ("m.npz", "a.bvh", "p.json", "o.bvh"))
    save_manifold(untrained_manifold, model)
    write_bvh(brief, file)
    words = ["repair", file, "-m", model, "-o", out, "--pin", pins]
    assert "p.json: cannot be read" in error_of(*words)
    pins.write_text('[{"joint": "head", "frames": [0, 9], "at": [0, 170, 0]}]')
    run(*words)
    assert "head, frames 0 to 9: within" in capsys.readouterr().err
