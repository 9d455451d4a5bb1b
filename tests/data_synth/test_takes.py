"""What holds for every kind of motion and every seed: bones, limits, feet, paths, no pops.

Seeds and lengths are drawn; `-m thorough` draws many more of them.
"""

import json

import numpy as np
import pytest
from acclaim_files import FILES
from hypothesis import given, settings
from hypothesis import strategies as st

from data_synth import KINDS, Take, beyond_limits, make_take
from numpy_cae.motion.masks import runs
from numpy_cae.motion.quaternions import rotate

REFUSED = json.loads((FILES / "synthetic.json").read_text(encoding="utf-8"))
SLIDING = 0.005  # metres
# m/s²; hands of people who punch and knees of people who run reach about half of it at 120 Hz.
STRONGEST = 450.0
GRAVITY = 9.81

seeds = st.integers(0, 2**32 - 1)
every_kind = pytest.mark.parametrize("kind", KINDS)


def joint(take: Take, name: str) -> np.ndarray:
    return take.motion.positions()[:, take.motion.skeleton.index(name)]


def check_all(kind: str, seed: int, seconds: float) -> None:
    take = make_take(kind, seed, seconds, 120.0)
    assert beyond_limits(take.motion) == []
    for check in (check_bones, check_feet, check_floor, check_path, check_smooth):
        check(take)


@pytest.mark.thorough
@every_kind
@settings(max_examples=50, deadline=None)
@given(seed=seeds, seconds=st.floats(0.2, 40.0))
def test_everything_thoroughly(kind, seed, seconds):
    check_all(kind, seed, seconds)


@every_kind
@settings(max_examples=2, deadline=None, derandomize=True)
@given(seed=seeds, seconds=st.floats(1.5, 6.0))
def test_everything_holds(kind, seed, seconds):
    """The same few seeds every time."""
    check_all(kind, seed, seconds)


def check_bones(take: Take) -> None:
    """Lengths constant to 1e-9 m, and those of the body."""
    positions, skeleton = take.motion.positions(), take.motion.skeleton
    for child, parent in enumerate(skeleton.parents):
        if parent >= 0:
            length = np.linalg.norm(positions[:, child] - positions[:, parent], axis=-1)
            np.testing.assert_allclose(
                length, np.linalg.norm(skeleton.offsets[child]), rtol=0, atol=1e-9
            )


def check_feet(take: Take) -> None:
    """While a ball of a foot is said to stand, it stands, and it stands on the floor."""
    for side, name in enumerate(("ltoes", "rtoes")):
        ball = joint(take, name)
        standing_height = 0.013 * take.stature
        for start, end in runs(take.contacts[:, side]):
            way = np.linalg.norm(ball[start:end] - ball[start], axis=-1)
            assert way.max() < SLIDING, f"{name} slides {1000 * way.max():.1f} mm"
            assert abs(ball[start, 1] - standing_height) < SLIDING


def check_floor(take: Take) -> None:
    """No joint and no heel sinks into the floor."""
    positions, turned = take.motion.forward_kinematics()
    assert positions[..., 1].min() > 0.0
    for name in ("lfoot", "rfoot"):
        foot = take.motion.skeleton.index(name)
        heel = positions[:, foot] + rotate(turned[:, foot], take.body.heel)
        assert heel[:, 1].min() > -SLIDING, f"{name}: heel {1000 * heel[:, 1].min():.1f} mm"


def check_path(take: Take) -> None:
    """The pelvis follows the path and the heading of the take."""
    root = joint(take, "root")[:, [0, 2]]
    away = np.linalg.norm(root - take.path, axis=-1)
    # It sways, and leans over one foot to kick with the other.
    assert away.max() < 0.30
    going = "walk" in take.kind or take.kind == "run"
    stride = stride_of(take) if going else 0
    if going:
        assert away.max() < 0.09
    if stride:
        off = over_a_stride(root - take.path, stride)
        assert np.linalg.norm(off, axis=-1).max() < 0.03
    across = joint(take, "lfemur") - joint(take, "rfemur")
    facing = np.arctan2(-across[:, 2], across[:, 0])
    off = (facing - take.heading + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off).max() < np.radians(60)
    if going:
        assert np.abs(off).max() < np.radians(16)
    if stride:
        assert np.abs(over_a_stride(off[:, None], stride)).max() < np.radians(2.5)


def stride_of(take: Take) -> int:
    """Frames from one landing of the left foot to the next; 0 where there are too few."""
    landings = [start for start, _ in runs(take.contacts[:, 0]) if start > 0]
    return int(np.median(np.diff(landings))) if len(landings) > 2 else 0


def over_a_stride(values: np.ndarray, stride: int) -> np.ndarray:
    """The running mean over a stride, in which swaying to and fro cancels out."""
    sums = np.cumsum(np.concatenate([np.zeros((1, values.shape[1])), values]), axis=0)
    return (sums[stride:] - sums[:-stride]) / stride


def check_smooth(take: Take) -> None:
    """No pop: accelerations bounded, and the pelvis falls no faster than things do."""
    if len(take.motion) < 3:
        return
    positions = take.motion.positions()
    accelerations = np.diff(positions, 2, axis=0) * take.motion.rate**2
    size = np.linalg.norm(accelerations, axis=-1)
    assert size.max() < STRONGEST, take.motion.skeleton.names[size.max(axis=0).argmax()]
    assert np.quantile(size, 0.99) < 150
    assert size[:, 0].max() < 5 * GRAVITY


@every_kind
def test_same_seed_same_motion_other_seed_another(kind):
    one, same, other = (make_take(kind, seed, 4.0, 30.0) for seed in (7, 7, 8))
    assert one.motion.rotations.tobytes() == same.motion.rotations.tobytes()
    assert one.motion.translations.tobytes() == same.motion.translations.tobytes()
    assert not np.allclose(one.motion.rotations, other.motion.rotations, atol=1e-3)


@pytest.mark.parametrize("kind", ["walk", "run", "walk_with_turn", "walking_dog"])
def test_a_walk_is_the_same_at_another_rate(kind):
    fine, coarse = (make_take(kind, 5, 6.0, rate).motion.positions() for rate in (120.0, 30.0))
    np.testing.assert_allclose(fine[::4], coarse, rtol=0, atol=0.005)


@every_kind
def test_any_length_can_be_requested(kind):
    for seconds in (0.001, 0.3, 8.0):
        take = make_take(kind, 1, seconds, 30.0)
        assert len(take.motion) == max(round(30 * seconds), 1)
        assert np.isfinite(take.motion.positions()).all()


def test_who_stops_stands_on_both_feet():
    stopped = 0
    for seed in range(5):
        take = make_take("walking_dog", seed, 20.0, 60.0)
        speed = np.linalg.norm(np.gradient(take.path, axis=0), axis=-1) * 60
        for start, end in runs(speed < 1e-4):
            # The last foot lands within a step of when the pelvis has come to rest.
            stopped += end - start > 60
            assert take.contacts[start + 40 : end].all(), (seed, start / 60)
    assert stopped > 2


@pytest.mark.parametrize(("arguments", "message"), REFUSED["takes"])
def test_what_cannot_be_made_is_said(arguments, message):
    with pytest.raises(ValueError, match=message):
        make_take(**arguments)
