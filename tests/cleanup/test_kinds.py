"""The table of the kinds of damage, and the steps that mend them."""

import pytest

from data_synth import make_take
from numpy_cae.cleanup import Finding, repair_motion
from numpy_cae.cleanup.interpolation import mark_damaged_channels
from numpy_cae.cleanup.kinds import KINDS, MARKED, NOT_FINITE, T_POSE, Kind
from numpy_cae.cleanup.repair import STEPS

BEFORE_OR_AFTER_THE_STEPS = (T_POSE, NOT_FINITE, MARKED)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_a_kind_is_mended_by_a_step_or_before_or_after_all(kind):
    assert (kind.step in {step.name for step in STEPS}) != (kind in BEFORE_OR_AFTER_THE_STEPS)


@pytest.mark.parametrize("step", STEPS, ids=lambda step: step.name)
def test_a_step_mends_some_kind(step):
    assert step.name in {kind.step for kind in KINDS.values()}


def test_a_row_is_all_that_a_kind_of_an_existing_step_needs(monkeypatch):
    """A finding of the new kind is read, mended and written."""
    monkeypatch.setitem(KINDS, "glitch", Kind("glitch", "spikes", channel="rotation"))
    motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    motion.rotations[30, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    finding = Finding.from_json({"joint": "left_elbow", "frames": [30, 30], "kind": "glitch"})
    repaired = repair_motion(motion, findings=[finding])
    assert repaired.touched[30].any()
    assert repaired.findings[0].to_json()["kind"] == "glitch"


@pytest.mark.parametrize(
    ("kind", "rotation", "translation"),
    [("spike", True, False), ("length", False, True), ("not finite", True, True)],
)
def test_the_channel_of_a_row_is_what_is_damaged(kind, rotation, translation):
    motion = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    wrist = motion.skeleton.index("lwrist")
    motion.translations[::2, wrist] += 0.001  # so that the bone has a channel
    rotations, translations = mark_damaged_channels(motion, [Finding("left_wrist", (10, 12), kind)])
    assert (rotations[11, wrist], translations[11, wrist]) == (rotation, translation)
