"""Exercises on the feet: squats and jumping jacks, every repetition slightly different."""

import numpy as np

from data_synth.body import SIDES, SIGN
from data_synth.footsteps import Foot
from data_synth.stage import Stage, bump

_GRAVITY = 9.81


def squats(stage: Stage, seconds: float, tempo: float) -> None:
    """Down until the thighs are near level and up again, arms forwards for balance."""
    rng = stage.rng
    body = stage.body
    wide = 0.5 * body.hip_width + rng.uniform(0.06, 0.14)
    out = rng.uniform(10, 18)
    stage.feet = [Foot(sign * wide, 0.0, sign * out) for sign in SIGN]
    arms = float(rng.uniform(0.75, 1.0))
    clock = rng.uniform(0.3, 0.8)
    while clock < seconds - 1.5:
        down = rng.uniform(0.8, 1.3) / tempo
        up = rng.uniform(0.7, 1.1) / tempo
        hold = rng.uniform(0.0, 0.35)
        deep = float(rng.uniform(0.75, 1.0))
        parts = {
            "up": -0.46 * body.leg * deep, "ahead": -0.20 * body.leg * deep, "tilt": 24.0 * deep,
            "bend": 14.0 * deep, "nod": -24.0 * deep, "l.splay": 11.0, "r.splay": 11.0,
        }  # fmt: skip
        lag = {"tilt": -0.05, "bend": 0.05, "nod": 0.08}
        for side in SIDES:
            parts |= {f"{side}.flexion": 88.0 * arms + 30 * deep, f"{side}.elbow": -6.0,
                      f"{side}.turn": -8.0, f"{side}.forwards": 8.0, f"{side}.curl": -15.0,
                      f"{side}.pronation": 15.0}  # fmt: skip
            lag |= {f"{side}.flexion": rng.uniform(-0.08, 0.04), f"{side}.elbow": 0.1}
        stage.gesture(parts, clock, down, hold, up, lag)
        clock += down + hold + up + rng.uniform(0.15, 0.7) / tempo


def jumping_jacks(stage: Stage, seconds: float, tempo: float) -> None:
    """Jump the feet apart while the arms go up, jump them together while the arms come down."""
    rng = stage.rng
    body = stage.body
    t = stage.t
    near = 0.5 * body.hip_width + 0.01
    stage.feet = [Foot(sign * near, 0.0, sign * rng.uniform(5, 9)) for sign in SIGN]
    wide = near + rng.uniform(0.17, 0.28) * body.leg / 0.85
    half = rng.uniform(0.46, 0.58) / tempo
    high = rng.uniform(145, 165)
    bend = rng.uniform(12, 30)
    clock = rng.uniform(0.5, 1.0)
    apart = False
    flights: list[tuple[float, float]] = []
    while clock < seconds - 2 * half - 0.4 or apart:
        beat = half * float(np.exp(rng.normal(0, 0.03)))
        flight = rng.uniform(0.24, 0.28)
        leave = clock + 0.45 * beat - 0.5 * flight
        for side, sign in enumerate(SIGN):
            late = rng.uniform(0.0, 0.012)
            goal = near if apart else wide + rng.normal(0, 0.01)
            stage.feet[side].step(
                leave + late, leave + flight + late, (sign * goal, 0.0), lift=0.07
            )
            name = SIDES[side]
            # Off and down on the balls of the feet.
            heel = bump(t, leave - 0.10, 0.14, flight - 0.10, 0.20)
            stage.add(f"{name}.heel", 30.0 * heel)
            lift = high if not apart else -high
            begin = clock + rng.uniform(0, 0.03) - 0.02
            over = 0.92 * beat
            stage.move(f"{name}.abduction", lift, begin, over)
            stage.move(f"{name}.turn", -0.28 * lift, begin + 0.02, over)
            stage.move(f"{name}.raised", 0.11 * lift, begin - 0.02, over)
            stage.add(f"{name}.elbow", bend * bump(t, begin, 0.5 * over, 0.0, 0.5 * over))
        flights.append((leave, flight))
        stage.add("bend", 4.0 * bump(t, leave + flight - 0.05, 0.12, 0.0, 0.2))
        stage.add("nod", -3.0 * bump(t, leave + flight, 0.12, 0.0, 0.2))
        apart = not apart
        clock += beat
    stage.add("up", bounce(t, flights))


def bounce(t: np.ndarray, flights: list[tuple[float, float]], gather: float = 0.34) -> np.ndarray:
    """The height of a body during several jumps, (F,) in metres, 0 at take-off.

    In the air the body is in free flight, g u (T - u) / 2 above the floor. On the floor it sinks
    and pushes off again along another parabola, with the same speed v = g T / 2 at both ends. The
    first push starts at rest and the last landing ends at rest, each along a cubic.

    Parameters
    ----------
    t : (F,) array
        Seconds.
    flights : list of (when the feet leave, how long they are away)
        In the order of time.
    gather : float
        Seconds before the first push and after the last landing.
    """
    height = np.zeros(len(t))
    if not flights:
        return height
    befores = [None, *flights]
    afters = [*flights, None]
    for leave, air in flights:
        u = np.clip(t - leave, 0.0, air)
        height += _GRAVITY / 2 * u * (air - u)
    for before, after in zip(befores, afters, strict=True):
        if before is None:
            start = flights[0][0] - gather
            fall = 0.0
        else:
            start = sum(before)
            fall = -_GRAVITY / 2 * before[1]
        end = start + gather if before is None or after is None else after[0]
        push = 0.0 if after is None else _GRAVITY / 2 * after[1]
        u = np.clip((t - start) / (end - start), 0.0, 1.0)
        span = end - start
        height += span * (u * (1 - u) ** 2 * fall - u**2 * (1 - u) * push)
    return height
