"""Stepping sideways: one foot, then the other, several times, sometimes back again."""

import numpy as np

from data_synth.body import LEFT, RIGHT, SIDES, SIGN
from data_synth.curves import ease
from data_synth.footsteps import Foot
from data_synth.stage import Stage, bump


def sidestep(stage: Stage, seconds: float, tempo: float) -> None:
    """Step sideways with lead foot and trailing foot in turn; the direction may change."""
    rng = stage.rng
    body = stage.body
    t = stage.t
    half = 0.5 * body.hip_width + 0.015
    stage.feet = [Foot(sign * half, 0.0, sign * rng.uniform(3, 9)) for sign in SIGN]
    stage.add("up", -rng.uniform(0.01, 0.05) * body.leg)
    for name in SIDES:
        stage.add(f"{name}.abduction", rng.uniform(3, 14))
        stage.add(f"{name}.elbow", rng.uniform(8, 35))
    clock = rng.uniform(0.4, 0.9)
    toward = float(rng.choice([-1.0, 1.0]))
    length = rng.uniform(0.28, 0.42) * body.leg / 0.85
    beat = rng.uniform(0.42, 0.58) / tempo
    while clock < seconds - 2.4 * beat:
        for _ in range(int(rng.integers(2, 6))):
            if clock > seconds - 2.4 * beat:
                break
            clock = _one(stage, clock, toward, length, beat * float(np.exp(rng.normal(0, 0.05))), t)
        toward = -toward
        clock += rng.uniform(0.1, 0.6)


def _one(stage: Stage, start: float, toward: float, length: float, beat: float, t) -> float:
    rng = stage.rng
    lead, trail = (LEFT, RIGHT) if toward > 0 else (RIGHT, LEFT)
    far = length * float(np.exp(rng.normal(0, 0.07))) * toward
    for foot, begin in ((lead, start), (trail, start + beat)):
        side, ahead, _ = stage.feet[foot].last()
        stage.feet[foot].step(
            begin, begin + 0.80 * beat, (side + far, ahead + rng.normal(0, 0.006)),
            lift=rng.uniform(0.035, 0.06),
        )  # fmt: skip
        # The heel leaves the floor first.
        stage.add(f"{SIDES[foot]}.heel", 16 * bump(t, begin, 0.3 * beat, 0.05, 0.4 * beat))
    stage.path[:, 0] += far * ease((t - start - 0.05 * beat) / (1.75 * beat))
    away = bump(t, start + 0.1 * beat, 0.7 * beat, 0.1 * beat, 0.9 * beat)
    stage.add("up", -0.018 * away)
    stage.add("side", toward * 2.5 * away)
    stage.add("list", -toward * 2.0 * away)
    # The arms open and close with the legs, a little later.
    for name in SIDES:
        stage.add(f"{name}.abduction", 9 * bump(t, start + 0.16, 0.8 * beat, 0.05, 0.9 * beat))
    return start + 2 * beat
