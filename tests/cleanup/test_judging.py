"""Whether a step has made a motion worse is decided from a few numbers."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cleanup import Finding
from numpy_cae.cleanup.judging import Change, Changes, Tolerance, find_worse, has_worse_figures
from numpy_cae.cleanup.kinds import LIMB_TURNED, SPIKE
from numpy_cae.cleanup.view import View

FINDINGS = [Finding("left_wrist", (10, 12)), Finding("hips", (40, 50))]
BETTER = Changes(
    jumps=Change(10, 2),
    sharp_jumps=Change(4, 0),
    is_jumpy=False,
    jumps_near=[Change(6, 1), Change(4, 1)],
    sliding_near=[Change(10.0, 10.5), Change(0.0, 1.5)],
)


def test_a_motion_that_became_better_near_all_findings_has_no_worse_one():
    assert find_worse(FINDINGS, BETTER, Tolerance(0.65, 0.0)) == []


def test_a_finding_near_which_more_joints_jump_is_worse():
    changes = BETTER._replace(jumps_near=[Change(6, 7), Change(4, 1)])
    assert find_worse(FINDINGS, changes, Tolerance()) == FINDINGS[:1]


def test_all_findings_are_worse_if_too_many_jumps_are_left_in_all():
    changes = BETTER._replace(jumps=Change(10, 7))
    assert find_worse(FINDINGS, changes, Tolerance(0.65)) == FINDINGS


def test_in_a_motion_that_always_jumps_findings_are_judged_one_by_one():
    jumps_near = [Change(6, 5), Change(4, 1)]
    changes = BETTER._replace(jumps=Change(10, 7), jumps_near=jumps_near, is_jumpy=True)
    assert find_worse(FINDINGS, changes, Tolerance(0.65)) == FINDINGS[:1]


@pytest.mark.parametrize(
    ("tolerance", "sharp_after", "is_jumpy", "worse"),
    [
        (Tolerance(), 4, False, []),  # feet may slide more
        (Tolerance(sharp_jumps=0.0), 0, False, FINDINGS[1:]),
        (Tolerance(sharp_jumps=0.5), 1, False, []),  # most of the sharp jumps are gone
        (Tolerance(sharp_jumps=0.5), 2, False, FINDINGS[1:]),
        (Tolerance(sharp_jumps=0.0), 4, True, []),  # feet that jump hardly stand
    ],
)
def test_feet_that_slide_more_count_if_the_step_says_so(tolerance, sharp_after, is_jumpy, worse):
    sliding = [Change(10.0, 11.9), Change(10.0, 12.1)]
    sharp = Change(4, sharp_after)
    changes = BETTER._replace(sliding_near=sliding, sharp_jumps=sharp, is_jumpy=is_jumpy)
    assert find_worse(FINDINGS, changes, tolerance) == worse


def test_feet_beside_a_leg_that_was_turned_back_do_not_count():
    """Its ends are interpolated with the frame before and after the turn."""
    truth = make_take("idle", 3, seconds=2.0, rate=30.0).motion
    slides = truth.translations.copy()
    slides[:, 0, 0] += np.interp(np.arange(60), [19, 41], [0.0, 0.1])
    after = View(replace(truth, translations=slides))
    turned = Finding("left_hip", (20, 39), LIMB_TURNED.name)
    assert not has_worse_figures(View(truth), after, [turned])
    spike = Finding("left_hip", (20, 39), SPIKE.name)
    assert has_worse_figures(View(truth), after, [spike])
