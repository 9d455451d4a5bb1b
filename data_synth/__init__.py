"""Synthetic human motion of sixteen kinds, computed by formula, and typical damage to it."""

from data_synth.body import Body, draw_body, make_body
from data_synth.damage import Damaged, hold_poses, lose_marker, zero_values
from data_synth.kinds import HOLDEN2015_KINDS, JANG2018_KINDS, KINDS, make_take, styles_of
from data_synth.kinect import Seen, see_with_kinect
from data_synth.limits import LIMITS, beyond_limits, joint_angles
from data_synth.series import Plan, make_takes, plan_cmu_scale, plan_takes
from data_synth.take import Take
from data_synth.windows import Windows, make_windows, windows_of
from data_synth.write_series import write_series

__all__ = [
    "HOLDEN2015_KINDS",
    "JANG2018_KINDS",
    "KINDS",
    "LIMITS",
    "Body",
    "Damaged",
    "Plan",
    "Seen",
    "Take",
    "Windows",
    "beyond_limits",
    "draw_body",
    "hold_poses",
    "joint_angles",
    "lose_marker",
    "make_body",
    "make_take",
    "make_takes",
    "make_windows",
    "plan_cmu_scale",
    "plan_takes",
    "see_with_kinect",
    "styles_of",
    "windows_of",
    "write_series",
    "zero_values",
]
