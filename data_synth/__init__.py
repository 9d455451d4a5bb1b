"""Synthetic human motion of sixteen kinds, computed by formula."""

from data_synth.body import Body, draw_body, make_body
from data_synth.kinds import HOLDEN2015_KINDS, JANG2018_KINDS, KINDS, make_take, styles_of
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
    "Plan",
    "Take",
    "Windows",
    "beyond_limits",
    "draw_body",
    "joint_angles",
    "make_body",
    "make_take",
    "make_takes",
    "make_windows",
    "plan_cmu_scale",
    "plan_takes",
    "styles_of",
    "windows_of",
    "write_series",
]
