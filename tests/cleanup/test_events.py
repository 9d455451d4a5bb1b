"""Events: what is grouped, and that every list has the same order."""

import sys

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cleanup import Finding
from numpy_cae.cleanup.events import group_findings
from numpy_cae.cleanup.result import Repaired

ELBOW = Finding("left_elbow", (28, 73), "frozen", cm=12.0)
WRIST = Finding("left_wrist", (19, 83), "frozen", cm=86.9)


@pytest.mark.parametrize(
    "second",
    [
        Finding("left_wrist", (74, 83), "frozen"),  # later
        Finding("right_wrist", (19, 83), "frozen"),  # another limb
        Finding("body", (19, 83), "repeated"),
    ],
)
def test_what_is_elsewhere_is_another_event(second):
    assert len(group_findings([ELBOW, second])) == 2


def test_bodies_and_trunks_are_not_grouped():
    findings = [Finding(joint, (3, 9), "jumps") for joint in ("body", "body", "head", "head")]
    assert len(group_findings(findings)) == len(findings)


def test_a_limb_is_one_event_of_the_frames_of_all():
    (event,) = group_findings([ELBOW, WRIST])
    assert (event.place, event.frames, event.largest) == ("left arm", (19, 83), WRIST)


def test_findings_of_an_event_have_neighbouring_numbers():
    head = Finding("head", (30, 31), "spike", cm=20.0)
    motion = make_take("walk", 0, seconds=4.0, rate=30.0).motion
    still = np.zeros((len(motion), 20))
    repaired = Repaired(motion, still > 0, still, findings=(head, ELBOW, WRIST))
    assert repaired.listed() == [WRIST, ELBOW, head]


def test_the_work_of_grouping_grows_with_the_number_of_findings():
    """A list of 20,000 stances of one foot, which a file may have, took minutes."""
    calls = 0

    def count_calls(frame, event, argument):
        nonlocal calls
        calls += event == "call"

    findings = [Finding("left_toe", (frame, frame + 1), "foot") for frame in range(400)]
    sys.setprofile(count_calls)
    try:
        events = group_findings(findings)
    finally:
        sys.setprofile(None)
    assert len(events) == 1
    assert calls < 20 * len(findings)
