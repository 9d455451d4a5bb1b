"""Kicks and punches: hip, then trunk, then limb, with delays of a few hundredths of a second.

This order is that of measured strikes and throws (Putnam, 1993,
*J. Biomech.* 26 suppl. 1:125).
"""

import numpy as np

from data_synth.body import SIDES, SIGN
from data_synth.footsteps import Foot
from data_synth.stage import Stage, bump


def guard(stage: Stage, lead: int) -> None:
    """Stand side-on with the fists up, the leading side in front; held for the whole take."""
    rng = stage.rng
    body = stage.body
    deep = rng.uniform(0.13, 0.19) * body.leg / 0.85
    half = 0.5 * body.hip_width + rng.uniform(0.02, 0.06)
    stage.feet = [
        Foot(sign * half, deep if side == lead else -deep,
             (10.0 if side == lead else 38.0) * SIGN[1 - lead] * 1.0)
        for side, sign in enumerate(SIGN)
    ]  # fmt: skip
    turn = SIGN[1 - lead] * rng.uniform(14, 24)
    stage.add("turn", turn)
    stage.add("twist", 0.25 * turn)
    stage.add("look", -1.25 * turn)
    stage.add("bend", 6.0)
    stage.add("nod", 4.0)
    stage.add("up", -0.03 * body.leg)
    stage.add(f"{SIDES[1 - lead]}.heel", 10.0)
    for side, name in enumerate(SIDES):
        front = side == lead
        stage.add(f"{name}.flexion", 44.0 if front else 28.0)
        stage.add(f"{name}.abduction", 2.0)
        stage.add(f"{name}.turn", 16.0)
        stage.add(f"{name}.elbow", 92.0 if front else 108.0)
        stage.add(f"{name}.pronation", 15.0)
        stage.add(f"{name}.curl", 44.0)
        stage.add(f"{name}.raised", 3.0)
    # A light and slightly irregular bounce on the feet.
    beat = rng.uniform(1.3, 1.9)
    stage.add("up", 0.007 * np.sin(2 * np.pi * beat * stage.t + rng.uniform(0, 6)))
    stage.add("ahead", 0.010 * np.sin(np.pi * beat * stage.t + rng.uniform(0, 6)))


def punch(stage: Stage, seconds: float, tempo: float) -> None:
    """Jabs with the leading fist, crosses with the other, alone or one after the other."""
    rng = stage.rng
    lead = int(rng.integers(2))
    guard(stage, lead)
    clock = rng.uniform(0.4, 1.0)
    while clock < seconds - 0.9:
        for side in [[lead], [lead, 1 - lead], [1 - lead], [lead, lead, 1 - lead]][rng.integers(4)]:
            if clock > seconds - 0.7:
                break
            clock += _strike(stage, side, side == lead, clock, tempo)
        clock += rng.uniform(0.35, 1.3) / tempo


def _strike(stage: Stage, side: int, leading: bool, start: float, tempo: float) -> float:
    rng = stage.rng
    name = SIDES[side]
    inwards = -SIGN[side]
    out = rng.uniform(0.20, 0.27) / tempo
    back = rng.uniform(0.28, 0.38) / tempo
    hold = rng.uniform(0.0, 0.04)
    high = rng.uniform(-6, 6)
    drive = 0.45 if leading else 1.0
    body = {
        "turn": 20 * drive * inwards, "twist": 20 * drive * inwards, "look": -32 * drive * inwards,
        "ahead": 0.035 + 0.02 * drive, "aside": 0.02 * inwards, "bend": 4.0,
        f"{name}.flexion": (44.0 if leading else 60.0) + high,
        f"{name}.elbow": -100.0 if leading else -114.0,
        f"{name}.turn": 14.0, f"{name}.pronation": 42.0, f"{name}.forwards": 16.0,
        f"{name}.abduction": 8.0, f"{name}.wrist": -8.0,
    }  # fmt: skip
    if not leading:
        body[f"{name}.heel"] = 22.0
    lag = {"turn": -0.06, "look": -0.05, "ahead": -0.05, "aside": -0.05, "twist": -0.03,
           f"{name}.heel": -0.06, f"{name}.forwards": 0.01, f"{name}.elbow": 0.03,
           f"{name}.pronation": 0.05}  # fmt: skip
    stage.gesture(body, start, out, hold, back, lag)
    return (out + hold + 0.75 * back) * rng.uniform(0.95, 1.2)


def kick(stage: Stage, seconds: float, tempo: float) -> None:
    """Front kicks: weight over, knee up, shin out, shin in, foot down."""
    rng = stage.rng
    lead = int(rng.integers(2))
    guard(stage, lead)
    clock = rng.uniform(0.5, 1.0)
    while clock < seconds - 1.7:
        side = 1 - lead if rng.random() < 0.75 else lead
        clock += _front_kick(stage, side, clock, tempo) + rng.uniform(0.35, 1.2) / tempo


def _front_kick(stage: Stage, side: int, start: float, tempo: float) -> float:
    rng = stage.rng
    t = stage.t
    body = stage.body
    name = SIDES[side]
    standing_side = SIDES[1 - side]
    sign = SIGN[side]
    shift = 0.30 / tempo
    lift = 0.34 / tempo
    snap = rng.uniform(0.16, 0.2) / tempo
    draw = 0.22 / tempo
    lower = 0.42 / tempo
    hold = rng.uniform(0.0, 0.06)
    up = start + 0.6 * shift
    top = up + lift + snap
    high = rng.uniform(0.85, 1.1)
    # The body is above the standing foot, not above the middle of both feet.
    stood = stage.feet[1 - side].last()
    stage.gesture(
        {"aside": 0.85 * stood[0], "ahead": 0.85 * stood[1], "list": -sign * 4.0},
        start, shift + 0.1, lift + snap + hold + 0.5 * draw, draw + lower,
    )  # fmt: skip
    away = top + hold + draw
    stage.add(f"{name}.free", bump(t, up, lift, snap + hold + draw, lower))
    stage.add(f"{name}.thigh", 74 * high * bump(t, up, lift, snap + hold + 0.5 * draw, lower))
    stage.add(f"{name}.thigh", 20 * high * bump(t, up + lift - 0.06, snap + 0.06, hold, draw))
    knee = 100 * bump(t, up - 0.02, lift, snap + hold + draw, lower + 0.02)
    stage.add(f"{name}.knee", knee - 84 * bump(t, up + lift - 0.04, snap + 0.04, hold, draw))
    stage.add(f"{name}.ankle", -20 * bump(t, up, lift, snap + hold + draw, lower))
    # The body leans back against the leg and turns with the hip.
    whole = up - start
    stage.gesture(
        {"tilt": -14.0 * high, "bend": 6.0, "turn": -sign * 16.0, "twist": sign * 10.0,
         "nod": 10.0, "up": -0.02 * body.leg, f"{standing_side}.splay": 4.0},
        start + 0.5 * whole, lift + snap, hold, draw + lower, lag={"bend": 0.05, "twist": 0.06},
    )  # fmt: skip
    stage.gesture(
        {f"{name}.flexion": -30.0, f"{name}.elbow": -35.0, f"{name}.abduction": 12.0,
         f"{standing_side}.flexion": 12.0},
        up, lift + snap, hold, draw + lower, lag={f"{name}.elbow": 0.06},
    )  # fmt: skip
    return away + lower - start
