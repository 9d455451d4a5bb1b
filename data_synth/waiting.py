"""Waiting, as in Human3.6M: stretching, twisting the legs, leaning on a wall.

jang2018 samples such motions in its figure 3. The three follow in random order and timing, with
pauses between them.
"""

import numpy as np

from data_synth.body import LEFT, RIGHT, SIDES, SIGN
from data_synth.curves import drift
from data_synth.stage import Stage, bump
from data_synth.standing import fidget, glance, shift_weight
from numpy_cae.motion.features import rotate_about_y


def waiting(stage: Stage, seconds: float, tempo: float) -> None:
    """Repeat the three in random order until the end."""
    rng = stage.rng
    clock = rng.uniform(0.2, 1.2)
    acts = np.array([stretch, twist_legs, rest_on_wall, lean_back], dtype=object)
    while clock < seconds:
        for act in rng.permutation(acts):
            if clock < seconds:
                clock = act(stage, clock, tempo)
                clock = _between(stage, clock, tempo)


def _between(stage: Stage, clock: float, tempo: float) -> float:
    rng = stage.rng
    over = rng.uniform(0.4, 2.4) / tempo
    if over > 1.0:
        amount = float(rng.choice([-1, 1]) * rng.uniform(0.4, 0.9))
        shift_weight(stage, amount, clock, 0.7 / tempo)
        shift_weight(stage, -amount, clock + over - 0.6, 0.8 / tempo)
        glance(stage, clock + 0.2, tempo)
    if rng.random() < 0.3:
        return max(clock + over, fidget(stage, clock, tempo))
    return clock + over


def stretch(stage: Stage, start: float, tempo: float) -> float:
    """Raise the arms, arch the back and stand on the toes; sometimes lean to both sides."""
    rng = stage.rng
    rise = rng.uniform(0.9, 1.3) / tempo
    fall = rng.uniform(0.9, 1.4) / tempo
    bends = int(rng.integers(0, 3))
    hold = rng.uniform(0.4, 1.0) + 1.3 * bends / tempo
    parts = {"bend": -11.0, "nod": -14.0, "tilt": 4.0}
    lag = {"nod": 0.15}
    for name in SIDES:
        parts |= {f"{name}.flexion": rng.uniform(150, 165), f"{name}.elbow": rng.uniform(0, 14),
                  f"{name}.turn": rng.uniform(5, 20), f"{name}.raised": 14.0,
                  f"{name}.heel": 9.0, f"{name}.wrist": -20.0,
                  f"{name}.abduction": -4.0}  # fmt: skip
        lag |= {f"{name}.raised": 0.1, f"{name}.heel": 0.35, f"{name}.wrist": 0.3,
                f"{name}.flexion": rng.uniform(0, 0.05)}  # fmt: skip
    stage.gesture(parts, start, rise, hold, fall, lag)
    # Bent elbows on the way up, straight ones overhead.
    for name in SIDES:
        stage.add(f"{name}.elbow", 45 * bump(stage.t, start, 0.5 * rise, 0.0, 0.5 * rise))
    toward = float(rng.choice([-1, 1]))
    for number in range(bends):
        begin = start + 0.8 * rise + 1.3 * number / tempo
        deep = toward * rng.uniform(12, 20)
        stage.gesture(
            {"side": deep, "aside": -0.0025 * deep, "list": 0.25 * deep, "lean": 0.3 * deep},
            begin, 0.55 / tempo, 0.2, 0.55 / tempo, lag={"lean": 0.1},
        )  # fmt: skip
        toward = -toward
    return start + rise + hold + fall


def twist_legs(stage: Stage, start: float, tempo: float) -> float:
    """Cross one leg in front of the other, turn to and fro, and uncross the legs."""
    rng = stage.rng
    t = stage.t
    moving = int(rng.integers(2))
    name = SIDES[moving]
    sign = SIGN[moving]
    foot = stage.feet[moving]
    standing_foot = stage.feet[1 - moving]
    home = foot.last()
    stood = standing_foot.last()
    over = rng.uniform(0.65, 0.9) / tempo
    hold = rng.uniform(1.5, 4.0)
    across = stood[0] - sign * rng.uniform(0.02, 0.07)
    ahead = stood[1] + rng.uniform(0.15, 0.19)
    stage.move("aside", 0.9 * stood[0], start - 0.15, 0.5 / tempo)
    stage.move("list", -sign * 4.0, start - 0.1, 0.5 / tempo)
    stage.move("side", -sign * 4.5, start, 0.5 / tempo)
    foot.step(start + 0.15, start + 0.15 + over, (across, ahead), home[2] * 0.4, lift=0.07)
    stage.gesture({f"{name}.heel": 22.0}, start + 0.1, 0.4 * over, 0.1, 0.7 * over)
    end = start + 0.15 + over + hold
    twisting = bump(t, start + over, 0.5, hold - 0.5, 0.5)
    way = drift(rng, 6.0, 0.25, 0.6)(t)
    late = drift(rng, 3.0, 0.25, 0.6)(t)
    stage.add("turn", twisting * way)
    stage.add("twist", -0.8 * twisting * way)
    stage.add("side", 0.5 * twisting * late)
    stage.add(f"{name}.flexion", 0.5 * twisting * way)
    if rng.random() < 0.6:
        # The hands are folded in front.
        for arm in SIDES:
            stage.gesture(
                {f"{arm}.flexion": 12.0, f"{arm}.turn": 34.0, f"{arm}.elbow": 48.0},
                start + 0.6, 0.7, hold - 0.6, 0.7,
            )  # fmt: skip
    foot.step(end, end + over, (home[0], home[1]), home[2], lift=0.07)
    stage.gesture({f"{name}.heel": 18.0}, end - 0.05, 0.4 * over, 0.1, 0.6 * over)
    for channel, amount in (("aside", 0.9 * stood[0]), ("list", -sign * 4), ("side", -sign * 4.5)):
        stage.move(channel, -amount, end + 0.35 * over, over)
    return end + 1.2 * over


def rest_on_wall(stage: Stage, start: float, tempo: float) -> float:
    """Lean sideways with a straight arm, the hand on a wall."""
    rng = stage.rng
    body = stage.body
    t = stage.t
    side = int(rng.choice([LEFT, RIGHT]))
    name = SIDES[side]
    sign = SIGN[side]
    if stage.goals[side]:
        return start
    rise = rng.uniform(0.9, 1.3) / tempo
    fall = rng.uniform(0.9, 1.2) / tempo
    hold = rng.uniform(2.0, 5.0)
    far = rng.uniform(0.05, 0.10)
    stage.gesture(
        {"aside": sign * far, "list": -sign * 3.0, "side": sign * rng.uniform(6, 9),
         "lean": -sign * 5.0, "twist": -sign * 3.0, f"{name}.raised": 7.0,
         f"{name}.wrist": -45.0, f"{name}.curl": -15.0},
        start, rise, hold, fall,
        lag={"lean": 0.2, f"{name}.wrist": -0.1},
    )  # fmt: skip
    out = sign * (abs(body.offset("lhumerus")[0]) + far + 0.80 * body.arm)
    height = body.stature * rng.uniform(0.80, 0.86)
    goal = rotate_about_y(
        np.array([out, 0.0, rng.uniform(0.0, 0.12)]) + np.zeros((len(t), 3)), stage.heading
    )
    goal += [stage.start[0], height, stage.start[1]]
    stage.goals[side] = {
        "goal": goal,
        "goal_weight": bump(t, start - 0.15, rise + 0.1, hold, fall),
        "elbow_side": np.array([0.0, -1.0, -0.35]),
    }
    if rng.random() < 0.6:
        free_side = SIDES[1 - side]
        # The other hand is on the hip.
        stage.gesture(
            {f"{free_side}.abduction": 30.0, f"{free_side}.turn": 32.0, f"{free_side}.elbow": 70.0,
             f"{free_side}.flexion": -14.0},
            start + 0.5, 0.8, hold - 0.4, 0.8,
        )  # fmt: skip
    return start + rise + hold + fall


def lean_back(stage: Stage, start: float, tempo: float) -> float:
    """Rest the back on a wall, one foot up against it."""
    rng = stage.rng
    side = int(rng.integers(2))
    name = SIDES[side]
    standing_side = SIDES[1 - side]
    sign = SIGN[side]
    rise = rng.uniform(1.0, 1.4) / tempo
    fall = rng.uniform(1.0, 1.3) / tempo
    hold = rng.uniform(2.0, 4.5)
    stage.gesture(
        {"ahead": -0.13, "tilt": -8.0, "bend": 6.0, "nod": 6.0, "up": -0.01},
        start, rise, hold, fall, lag={"bend": 0.2, "nod": 0.3},
    )  # fmt: skip
    for arm in SIDES:
        stage.gesture(
            {f"{arm}.flexion": 8.0, f"{arm}.turn": 30.0, f"{arm}.elbow": 62.0,
             f"{arm}.abduction": -3.0},
            start + 0.4 + 0.1 * (arm == name), 0.9, hold - 0.2, 0.9,
        )  # fmt: skip
    begin = start + 0.8 * rise
    stay = hold - 0.4 * rise
    stood = stage.feet[1 - side].last()
    stage.gesture(
        {"aside": 0.6 * stood[0], "list": -sign * 3.0}, start + 0.4 * rise, 0.8, stay, 0.9
    )
    lift = {f"{name}.free": 1.0, f"{name}.thigh": rng.uniform(22, 34),
            f"{name}.knee": rng.uniform(82, 98), f"{name}.ankle": 18.0,
            f"{standing_side}.splay": 3.0}  # fmt: skip
    stage.gesture(lift, begin, 0.8, stay, 0.8, lag={f"{name}.knee": -0.03})
    return start + rise + hold + fall + 0.3
