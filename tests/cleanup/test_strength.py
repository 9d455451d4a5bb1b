"""A part of a repair: each rotation and place goes a share of its way."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cleanup import PRESETS, repair_motion
from numpy_cae.cleanup.result import weaken


@pytest.fixture(scope="module")
def repaired():
    motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    motion.rotations[30, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    motion.translations[40:, 0] += [0.4, 0.0, 0.0]
    return repair_motion(motion)


def test_all_of_a_repair_is_the_repair(repaired):
    assert weaken(repaired, 1.0) is repaired


def test_nothing_of_a_repair_is_the_original(repaired):
    motion = weaken(repaired, 0.0).motion
    np.testing.assert_allclose(motion.rotations, repaired.original.rotations, atol=1e-12)
    np.testing.assert_allclose(motion.translations, repaired.original.translations, atol=1e-12)


def test_half_of_a_repair_is_halfway(repaired):
    half = weaken(repaired, 0.5).motion.translations[:, 0]
    ends = [m.translations[:, 0] for m in (repaired.original, repaired.motion)]
    np.testing.assert_allclose(half, np.mean(ends, axis=0), atol=1e-12)


def test_frames_that_were_not_repaired_keep_every_digit(repaired):
    part = weaken(repaired, 0.3).motion
    same = ~repaired.touched.any(axis=1)
    np.testing.assert_array_equal(part.rotations[same], repaired.original.rotations[same])
    np.testing.assert_array_equal(part.translations[same], repaired.original.translations[same])


def test_a_part_of_a_repair_that_cuts_a_t_pose_off_is_of_the_rest():
    motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    motion.rotations[:1, 1:] = [0.0, 0.0, 0.0, 1.0]
    repaired = repair_motion(motion, preset=PRESETS["optical"])
    assert len(weaken(repaired, 0.5).motion) == len(repaired.motion) < len(motion)


@pytest.mark.parametrize("strength", [-0.1, 1.5, float("nan")])
def test_a_strength_is_from_0_to_1(repaired, strength):
    with pytest.raises(ValueError, match="strength is"):
        weaken(repaired, strength)


def test_a_repair_that_fades_is_whole_within_and_less_at_its_ends():
    motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    motion.translations[20:41, 0] += [0.4, 0.0, 0.0]
    repaired = repair_motion(motion)
    fading = weaken(repaired, fade=0.2)
    share = fading.moved[20:41].max(axis=1) / repaired.moved[20:41].max(axis=1)
    np.testing.assert_allclose(share[6:-6], 1.0)
    assert (np.diff(share[:7]) > 0).all() and (np.diff(share[-7:]) < 0).all()
    moved = np.linalg.norm(fading.motion.positions() - motion.positions(), axis=-1)
    np.testing.assert_allclose(moved[20:41].max(axis=1), fading.moved[20:41].max(axis=1))


def test_a_fade_is_a_time(repaired):
    with pytest.raises(ValueError, match="fade is"):
        weaken(repaired, fade=-1.0)
