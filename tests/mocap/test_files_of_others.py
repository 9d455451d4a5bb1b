"""Synthetic motion with the properties of files of others that were once read wrongly."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data_synth import make_take
from numpy_cae.cleanup.mask_file import entry_findings
from numpy_cae.mocap import body_positions
from numpy_cae.mocap.coordinates import TO_Y_UP, detect_up, turn_as_in_file, turn_y_up
from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.mocap.formats.write_bvh import write_bvh
from numpy_cae.mocap.load import load_motion
from numpy_cae.mocap.rigs.recognise import MIRRORED, recognise_rig, rig_of
from numpy_cae.motion.features import problem_of


def clip(kind, seed=1, seconds=4.0):
    return make_take(kind, seed, seconds, 30.0).motion


def tilted(motion, degrees, axis="x"):
    """The motion with its body tilted by angles (frames,) about the place of its hips."""
    rotations = motion.rotations.copy()
    turn = Rotation.from_euler(axis, np.reshape(degrees, (-1, 1)), degrees=True)
    rotations[:, 0] = (turn * Rotation.from_quat(rotations[:, 0])).as_quat()
    return replace(motion, rotations=rotations)


def on_the_floor(motion):
    """The motion moved up or down, so that its lowest joint is on the floor in every frame."""
    translations = motion.translations.copy()
    translations[:, 0, 1] -= motion.positions()[..., 1].min(axis=1)
    return replace(motion, translations=translations)


@pytest.mark.parametrize("degrees", [-90.0, 90.0])
@pytest.mark.parametrize("axis", ["x", "z"])
def test_a_person_who_falls_and_lies_is_y_up(degrees, axis):
    falls = np.interp(np.arange(120), [0, 20, 40, 119], [0.0, 0.0, degrees, degrees])
    assert turn_y_up(on_the_floor(tilted(clip("idle"), falls, axis))).up == "y"


def test_a_person_who_crawls_is_y_up():
    """The hips move along the direction from the ankles to the head."""
    crawls = on_the_floor(tilted(clip("idle"), np.full(120, 80.0)))
    translations = crawls.translations.copy()
    translations[:, 0, 2] += 0.4 * np.arange(120) / 30.0
    translations[:, 0, 1] += 0.05 * np.sin(np.arange(120) / 5.0) ** 2
    assert turn_y_up(replace(crawls, translations=translations)).up == "y"


@pytest.mark.parametrize("degrees", [-90.0, 90.0])
def test_a_rest_pose_along_which_people_fall_does_not_say_what_is_up(degrees):
    """The bones of some rigs all lie along one axis in the rest pose, and people fall along it."""
    falls = np.interp(np.arange(120), [0, 60, 70, 119], [0.0, 0.0, degrees, degrees])
    motion = on_the_floor(tilted(clip("walk"), falls, "z"))
    motion.translations[:, 0, 0] += 0.5 * np.arange(120) / 30.0
    rest = motion.skeleton.rest_positions()[rig_of(motion).joints]
    assert detect_up(body_positions(motion), rest @ np.transpose(TO_Y_UP["-x"])) == "y"


@pytest.mark.parametrize("kind", ["walk", "idle", "jumping_jacks", "kick", "squats"])
def test_a_person_who_stands_in_a_file_that_is_z_up_is_z_up(kind):
    in_file = turn_as_in_file(replace(clip(kind, 3), up="z", floor=0.4))
    in_file.translations[:, 0, 1] += 2.0  # the origin is elsewhere
    assert turn_y_up(in_file).up == "z"


def test_a_person_who_climbs_in_a_file_that_is_z_up_is_z_up():
    climbs = clip("walk", 3)
    climbs.translations[:, 0, 1] += 1.5 * np.arange(120) / 120
    assert turn_y_up(turn_as_in_file(replace(climbs, up="z"))).up == "z"


def mirrored(motion):
    """The mirror image of a motion, whose joints keep their names."""
    flip = np.array([-1.0, 1.0, 1.0])
    skeleton = replace(motion.skeleton, offsets=motion.skeleton.offsets * flip)
    rotations = motion.rotations * [1.0, -1.0, -1.0, 1.0]
    return replace(
        motion, skeleton=skeleton, rotations=rotations, translations=motion.translations * flip
    )


def test_a_mirrored_file_is_said():
    motion = clip("walk")
    assert MIRRORED in recognise_rig(mirrored(motion)).note
    assert MIRRORED not in recognise_rig(motion).note


def with_a_level_trunk(motion):
    rotations = motion.rotations.copy()
    joint = motion.skeleton.index("lowerback")
    rotations[:, joint] = Rotation.from_euler("x", 100, degrees=True).as_quat()
    offsets = motion.skeleton.offsets.copy()
    for name in ("upperback", "thorax", "lowerneck"):
        offsets[motion.skeleton.index(name)] = [0.0, 0.0, 0.12]  # of its rest pose, too
    return on_other_bones(replace(motion, rotations=rotations), offsets)


def with_short_arms(motion):
    offsets = motion.skeleton.offsets.copy()
    for name in ("lradius", "lwrist", "rradius", "rwrist"):
        offsets[motion.skeleton.index(name)] *= 0.3
    return on_other_bones(motion, offsets)


def on_other_bones(motion, offsets):
    translations = motion.translations.copy()
    translations[:, 1:] = offsets[1:]
    skeleton = replace(motion.skeleton, offsets=offsets)
    return replace(motion, skeleton=skeleton, translations=translations)


@pytest.mark.parametrize("change", [with_a_level_trunk, with_short_arms])
def test_a_dinosaur_on_a_known_rig_is_asked_about(change):
    motion = clip("walk")
    assert "is this a person?" not in recognise_rig(motion).note
    assert "is this a person?" in recognise_rig(change(motion)).note


def test_an_empty_entry_of_a_mask_is_refused():
    with pytest.raises(ValueError, match="names no joint, limb or frames"):
        entry_findings({}, clip("walk"))


@pytest.mark.parametrize("lost", [slice(0, None, 2), slice(1, None, 2)])
def test_a_motion_that_lost_every_second_frame_is_sampled(lost):
    motion = make_take("walk", 1, 20.0, 60.0).motion
    rotations = motion.rotations.copy()
    rotations[lost, 0] = np.nan
    sample = replace(motion, rotations=rotations).sampled(500)
    assert 400 < len(sample) <= 1000 and np.isfinite(sample.rotations).all()


def test_a_file_that_lost_every_second_frame_is_read(tmp_path):
    motion = make_take("walk", 1, 40.0, 30.0).motion
    path = tmp_path / "lost.bvh"
    write_bvh(motion, path, unit=0.01)
    lines = path.read_text().splitlines()
    first = len(lines) - len(motion)
    for number in range(first, len(lines), 2):
        lines[number] = "nan " + lines[number].split(maxsplit=1)[1]
    path.write_text("\n".join(lines) + "\n")
    assert len(load_motion(path)) == len(motion)


def test_positions_of_zero_that_replace_offsets_are_named():
    assert "position channels of 0 replace the offsets" in problem_of(np.zeros((3, 20, 3)))


def test_a_missing_blank_between_two_numbers_is_named(tmp_path):
    path = tmp_path / "glued.bvh"
    write_bvh(clip("walk"), path, unit=0.01)
    lines = path.read_text().splitlines()
    words = lines[-1].split()
    place = next(n for n in range(3, len(words)) if words[n].startswith("-"))
    glued = words[place - 1] + words[place]
    lines[-1] = " ".join([*words[: place - 1], glued, *words[place + 1 :]])
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(MotionFileError, match=f"{glued}' is two numbers without a blank"):
        load_motion(path)
