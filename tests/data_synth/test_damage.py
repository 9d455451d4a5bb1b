"""Damage leaves the truth alone, says where it struck, and strikes as often as it was told."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from data_synth import hold_poses, lose_marker, make_take, see_with_kinect, zero_values
from data_synth.kinect import mirrored
from numpy_cae.motion import JOINTS, PARENTS, body_of

seeds = st.integers(0, 2**31)


@pytest.fixture(scope="module")
def body() -> np.ndarray:
    return body_of(make_take("walk", 1, 10.0, 30.0).motion)


@settings(max_examples=25, deadline=None)
@given(seed=seeds, p=st.floats(0, 1))
def test_zeroing_zeroes_a_share_of_p_and_nothing_else(seed, p):
    values = np.random.default_rng(seed).normal(size=(40, 10, 3)) + 5
    before = values.copy()
    damaged = zero_values(values, p, seed)
    np.testing.assert_array_equal(values, before)
    np.testing.assert_array_equal(damaged.truth, before)
    assert damaged.truth is not values
    np.testing.assert_array_equal(damaged.values, np.where(damaged.known, before, 0.0))
    # Five standard deviations of a binomial.
    assert abs((~damaged.known).mean() - p) <= 5 * np.sqrt(p * (1 - p) / values.size) + 1e-12


def test_a_marker_lost_for_the_whole_clip(body):
    wrist = JOINTS.index("left_wrist")
    damaged = lose_marker(body, wrist)
    assert np.isnan(damaged.values[:, wrist]).all()
    others = np.delete(np.arange(20), wrist)
    np.testing.assert_array_equal(damaged.values[:, others], body[:, others])
    assert not damaged.known[:, wrist].any() and damaged.known[:, others].all()


@settings(max_examples=15, deadline=None)
@given(seed=seeds, gap=st.floats(2, 40), share=st.floats(0.1, 0.8))
def test_gaps_are_as_long_and_as_many_as_asked(seed, gap, share):
    assume(share <= gap / (gap + 1))
    positions = np.zeros((60_000, 2, 3))
    damaged = lose_marker(positions, [1], seed, gap=gap, share=share)
    lost = ~damaged.known[:, 1, 0]
    begins = np.count_nonzero(np.diff(lost.astype(int)) == 1)
    assert lost.mean() == pytest.approx(share, abs=0.1)
    assert lost.sum() / max(begins, 1) == pytest.approx(gap, rel=0.25)
    assert damaged.known[:, 0].all()


def test_a_kinect_errs_as_published(body):
    seen = see_with_kinect(body, JOINTS, PARENTS, 30.0, 3)
    np.testing.assert_array_equal(seen.truth, body)
    error = np.linalg.norm(seen.values - body, axis=-1)
    # Wang et al. (2015): 5 to 10 cm for most joints.
    assert 0.03 < np.median(error[~seen.swapped]) < 0.10
    if seen.hidden.any():
        assert error[seen.hidden].mean() > error[~seen.hidden & ~seen.swapped[:, None]].mean()
    np.testing.assert_array_equal(seen.known, np.repeat(~seen.hidden[..., None], 3, axis=2))


def test_left_and_right_swap_for_a_few_frames():
    walk = body_of(make_take("walk_with_turn", 5, 40.0, 30.0).motion)
    seen = see_with_kinect(walk, JOINTS, PARENTS, 30.0, 5)
    assert 0 < seen.swapped.mean() < 0.3
    mirror = mirrored(JOINTS)
    knee = JOINTS.index("left_knee")
    hidden = seen.hidden[:, knee] | seen.hidden[:, mirror[knee]]
    swapped = seen.swapped & ~hidden
    assert swapped.any()
    to_other = np.linalg.norm(seen.values[:, knee] - walk[:, mirror[knee]], axis=-1)
    to_own = np.linalg.norm(seen.values[:, knee] - walk[:, knee], axis=-1)
    assert (to_other < to_own)[swapped].mean() > 0.8
    assert (to_other < to_own)[~seen.swapped & ~hidden].mean() < 0.2


def test_same_seed_same_damage(body):
    for damage in (
        lambda seed: zero_values(body, 0.5, seed),
        lambda seed: lose_marker(body, 3, seed, gap=10),
        lambda seed: see_with_kinect(body, JOINTS, PARENTS, 30.0, seed),
    ):
        assert damage(1).values.tobytes() == damage(1).values.tobytes()
        assert damage(1).values.tobytes() != damage(2).values.tobytes()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda body: zero_values(body, 1.5, 0), r"p is 1\.5"),
        (lambda body: lose_marker(body, 20), "expected 0 to 19"),
        (lambda body: lose_marker(body, 1, gap=5), "give rng"),
        (lambda body: lose_marker(body, 1, 0, gap=0), "gap is 0"),
        (lambda body: lose_marker(body[0], 1), "expected .frames, joints, 3."),
        (lambda body: hold_poses(body, 0), "every is 0"),
        (lambda body: see_with_kinect(body, ["a", "b"], [-1, 0], 30.0, 0), "with 2 names"),
    ],
)
def test_invalid_arguments_are_refused(body, call, message):
    with pytest.raises(ValueError, match=message):
        call(body)
