"""Repair: rig, rate and length stay, and the twenty joints are moved onto the manifold."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, lfilter, savgol_filter, sosfiltfilt

from data_synth import make_take
from numpy_cae.cleanup import project_motion
from numpy_cae.cleanup.holes import Holes
from numpy_cae.cleanup.projection import keep_trajectory
from numpy_cae.evaluation import position_error
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold, starter
from numpy_cae.mocap import body_of, body_positions
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion import POSITIONS, bone_lengths
from numpy_cae.motion.features import TURN, VELOCITY, trajectory_of
from numpy_cae.motion.filters import smooth_curve
from numpy_cae.motion.joints import joint_mask


class Identity(MotionManifold):
    """A manifold that every motion lies on."""

    def project(self, features, average_shifts=False):
        return np.array(features)


def walk(seed, rate=120.0, seconds=2.0):
    return make_take("walk", seed, seconds=seconds, rate=rate).motion


def shaken(motion, size, frames=slice(None)):
    """The motion with noise in its rotations, some of which have the other sign."""
    rotations = motion.rotations.copy()
    rotations[frames] += np.random.default_rng(0).normal(0, size, rotations[frames].shape)
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    rotations[::5] *= -1
    return replace(motion, rotations=rotations)


def jitter(motion):
    return np.abs(np.diff(body_positions(motion), 2, axis=0)).mean()


@pytest.mark.parametrize("rate", [20.0, 59.94, 120.0])
@pytest.mark.parametrize("frames", [1, 5, 31, 60])
def test_a_motion_returns_from_its_features(rate, frames):
    motion = walk(2, rate, seconds=3.0)
    body = Body(motion, bone_lengths(body_of(motion)) * 1.1)
    made = body.to_rig(body.features[:frames])
    assert (made.skeleton, made.rate) == (motion.skeleton, rate)
    assert len(made) == pytest.approx(frames * rate / 30, abs=1)
    np.testing.assert_allclose(body_of(made), body.positions[: len(body_of(made))], atol=0.02)


@pytest.mark.parametrize(("rate", "frames"), [(30.0, 1), (120.0, 2), (25.0, 37), (59.94, 37)])
def test_rig_rate_unit_and_length_stay(untrained_manifold, rate, frames):
    motion = replace(walk(1, rate).at(slice(frames)), unit=0.0254)
    fixed = project_motion(motion, untrained_manifold)
    assert fixed.skeleton is motion.skeleton
    assert (fixed.rate, fixed.unit, len(fixed)) == (motion.rate, 0.0254, frames)
    assert np.all(np.isfinite(fixed.rotations))
    single = [5, 6, 7, 9, 10, 11, 13, 14, 15, 17, 18, 19]  # bones without joints in between
    before, after = (bone_lengths(body_positions(each))[single] for each in (motion, fixed))
    np.testing.assert_allclose(after, before, atol=1e-9)


def test_a_projected_motion_has_the_same_bits_on_any_number_of_threads():
    motion = walk(1, 30.0, seconds=20.0)
    manifold = starter("ops")
    network = manifold.network
    projected = []
    for threads in (1, 2):
        manifold.network = accelerate(network, threads)
        projected.append(project_motion(motion, manifold))
    np.testing.assert_array_equal(projected[1].rotations, projected[0].rotations)


@pytest.mark.parametrize("rate", [30.0, 120.0])
def test_a_motion_on_the_manifold_comes_back(untrained_manifold, rate):
    """Only what lies between poses at 30 a second is lost."""
    motion = walk(2, rate)
    fixed = project_motion(motion, Identity(**vars(untrained_manifold)))
    gap = np.linalg.norm(body_positions(fixed) - body_positions(motion), axis=-1)
    assert gap[:: round(rate / 30)].max() < 1e-6
    assert gap.max() < 0.03


def test_noise_between_the_poses_does_not_come_through(untrained_manifold):
    """Three of four frames at 120 a second are noisy; none of these is a pose at 30."""
    calm = walk(2)
    noisy = shaken(calm, 0.05, np.arange(len(calm)) % 4 > 0)
    assert jitter(noisy) > 20 * jitter(calm)
    assert jitter(project_motion(noisy, untrained_manifold)) < 0.1 * jitter(noisy)


def test_fingers_are_carried_along_and_a_wrong_pose_moves(untrained_manifold):
    motion = walk(1)
    fixed = project_motion(motion, untrained_manifold)
    for finger in ("lfingers", "rthumb", "lhand"):
        place = motion.skeleton.index(finger)
        np.testing.assert_array_equal(fixed.rotations[:, place], motion.rotations[:, place])
    before, after = (Body(each, untrained_manifold.lengths).features for each in (motion, fixed))
    target = untrained_manifold.project(before)
    assert position_error(after, target) < position_error(before, target)


@pytest.fixture(scope="module")
def walked(untrained_manifold):
    body = Body(walk(1, seconds=6.0), untrained_manifold.lengths)
    return body.features, body.root


def test_the_root_stays_on_the_trajectory_of_the_file(walked):
    """Sums of projected velocities drift; the trajectory of the file does not."""
    features, start = walked
    drifting = features + np.random.default_rng(0).normal(0, 0.01, features.shape)
    drifting[:, VELOCITY] = features[:, VELOCITY] + 0.005
    drifting[:, TURN] = features[:, TURN] + 0.003
    kept, place = keep_trajectory(features, drifting, start, 30.0)
    np.testing.assert_array_equal(kept[:, POSITIONS], drifting[:, POSITIONS])
    (floor, theta), (there, facing) = trajectory_of(features, start), trajectory_of(kept, place)
    assert np.abs(trajectory_of(drifting, start)[0] - floor).max() > 0.5
    assert np.abs(there - floor).max() < 0.15
    assert np.abs(facing - theta).max() < 0.15
    assert np.abs(there - floor)[30:-30].max() < 0.05


def test_slow_motion_of_the_root_is_the_files_and_fast_motion_the_projections(walked):
    features, start = walked
    quick = features.copy()
    quick[:, TURN] += 0.05 * (-1.0) ** np.arange(len(features))[:, None]
    kept, _ = keep_trajectory(quick, features, start, 30.0)
    headings = [trajectory_of(x, start)[1] for x in (features, quick, kept)]
    assert np.abs(np.diff(headings[1] - headings[0])).min() > 0.04
    assert np.abs(np.diff(headings[2] - headings[0])).max() < 0.004
    same, place = keep_trajectory(features, features, start, 30.0)
    np.testing.assert_allclose(same[:-1], features[:-1], atol=1e-9)
    assert place.heading == pytest.approx(start.heading)


@pytest.mark.parametrize("coloured", [0.0, 0.5])
def test_smoothing_is_better_than_fixed_filters_and_keeps_clean_motion(coloured):
    """Savitzky-Golay and a Butterworth filter of 6 Hz."""
    clean = body_positions(walk(3, 30.0, seconds=6.0)).reshape(180, -1)
    noise = np.random.default_rng(0).normal(0, 0.008, clean.shape)
    noise = lfilter([1.0], [1.0, -coloured], noise, axis=0)
    lowpass = butter(2, 6.0, fs=30.0, output="sos")

    def smooth(x):
        joints = [smooth_curve(joint, 30.0) for joint in np.split(x, 20, axis=1)]
        return np.concatenate(joints, axis=1)

    def error(x):
        return np.linalg.norm((x - clean).reshape(180, 20, 3), axis=-1).mean()

    others = savgol_filter(clean + noise, 7, 2, axis=0), sosfiltfilt(lowpass, clean + noise, axis=0)
    assert error(smooth(clean + noise)) < min(map(error, others))
    assert error(smooth(clean)) < 0.002


def test_a_long_repair_needs_little_more_memory_than_both_motions(untrained_manifold):
    """An hour at 120 Hz takes 0.75 GB, and the repaired rotations 0.43 GB."""
    motion = walk(2, seconds=100.0)
    mask = joint_mask(len(motion), ["left_wrist"], slice(3000, 3020))
    mask |= joint_mask(len(motion), ["hips"], slice(11000, 11020))
    tracemalloc.start()
    holes = Holes(Body(motion, untrained_manifold.lengths), mask)
    repaired = holes.move_to(holes.features)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1.9 * (repaired.rotations.nbytes + repaired.translations.nbytes)


def test_pieces_that_do_not_change_are_projected_once(untrained_manifold, monkeypatch):
    features = Body(walk(1, rate=30.0, seconds=100.0), untrained_manifold.lengths).features
    changed = features.copy()
    changed[1500, 10] += 0.1
    expected = [untrained_manifold.project(x) for x in (features, changed)]
    network, calls = untrained_manifold.network, []
    project = network.project
    monkeypatch.setattr(network, "project", lambda x: calls.append(len(x)) or project(x))
    remembering = untrained_manifold.remember_projections()
    for x, right in zip((features, changed, changed), (*expected, expected[1]), strict=True):
        np.testing.assert_array_equal(remembering.project(x), right)
    assert len(calls) == 7 + 1  # one of seven pieces depends on the changed frame
