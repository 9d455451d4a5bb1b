"""Standing: idling and waving."""

import numpy as np

from data_synth.stage import Stage, bump


def idle(stage: Stage, seconds: float, tempo: float) -> None:
    """Shift the weight from leg to leg, look around, fidget a little."""
    rng = stage.rng
    clock = rng.uniform(0.3, 1.5)
    side = float(rng.choice([-1.0, 1.0]))
    before = 0.0
    while clock < seconds:
        goal = side * rng.uniform(0.3, 1.0)
        shift_weight(stage, goal - before, clock, rng.uniform(0.7, 1.4) / tempo)
        before = goal
        side = -side
        clock += rng.uniform(1.8, 4.5) / tempo
    clock = rng.uniform(0.5, 2.5)
    while clock < seconds:
        glance(stage, clock, tempo)
        if rng.random() < 0.35:
            clock = fidget(stage, clock + rng.uniform(0.5, 1.5), tempo)
        clock += rng.uniform(1.5, 5.0) / tempo


def shift_weight(stage: Stage, amount: float, start: float, over: float) -> None:
    """Shift the weight to the left leg (1) or to the right (-1).

    The pelvis moves to this side, drops on the other side and turns; the spine bends back, and the
    chest and the head follow later."""
    stage.move("aside", 0.045 * amount, start, over)
    stage.move("list", 3.5 * amount, start + 0.05, over)
    stage.move("turn", -4.0 * amount, start + 0.05, over)
    stage.move("side", 4.5 * amount, start + 0.10, over)
    stage.move("twist", 3.0 * amount, start + 0.15, 1.1 * over)
    stage.move("lean", -1.5 * amount, start + 0.20, over)
    unloaded = "r" if amount > 0 else "l"
    stage.gesture({f"{unloaded}.splay": 3.0}, start, over, 0.6, over)


def glance(stage: Stage, start: float, tempo: float) -> None:
    """Turn the head, then a little of the trunk, somewhere and back."""
    rng = stage.rng
    look = float(rng.choice([-1, 1]) * rng.uniform(12, 45))
    rise = rng.uniform(0.35, 0.6) / tempo
    hold = rng.uniform(0.4, 1.6)
    stage.gesture(
        {"look": look, "twist": 0.2 * look, "nod": rng.uniform(-6, 10)},
        start, rise, hold, 1.3 * rise, lag={"twist": 0.12},
    )  # fmt: skip


def fidget(stage: Stage, start: float, tempo: float) -> float:
    """Raise a hand in front of the body, as to look at a watch; return when it is down again."""
    rng = stage.rng
    side = str(rng.choice(["l", "r"]))
    rise = rng.uniform(0.5, 0.8) / tempo
    hold = rng.uniform(0.5, 1.4)
    stage.gesture(
        {f"{side}.flexion": rng.uniform(15, 32), f"{side}.elbow": rng.uniform(65, 100),
         f"{side}.turn": rng.uniform(15, 35), f"{side}.pronation": rng.uniform(10, 40),
         f"{side}.wrist": 10.0, "nod": rng.uniform(8, 18)},
        start, rise, hold, 1.2 * rise,
        lag={f"{side}.elbow": 0.06, f"{side}.wrist": 0.15, "nod": 0.1},
    )  # fmt: skip
    return start + 2.2 * rise + hold


def wave(stage: Stage, seconds: float, tempo: float) -> None:
    """Raise an arm and wave, once or a few times."""
    rng = stage.rng
    t = stage.t
    side = str(rng.choice(["l", "r"]))
    sign = 1.0 if side == "l" else -1.0
    clock = rng.uniform(0.3, 1.0)
    while clock < seconds - 1.0:
        rise = rng.uniform(0.55, 0.8) / tempo
        fall = rng.uniform(0.6, 0.9) / tempo
        hold = min(rng.uniform(1.2, 3.5), max(seconds - clock - rise - fall - 0.3, 0.4))
        high = rng.uniform(0.75, 1.15)
        raised = {
            f"{side}.flexion": 22.0 * high, f"{side}.abduction": 68.0 * high,
            f"{side}.turn": -58.0, f"{side}.elbow": 78.0 / high, f"{side}.pronation": 20.0,
            f"{side}.raised": 7.0 * high, f"{side}.curl": -20.0, "side": -sign * 4.0,
            "look": sign * rng.uniform(0, 15), "aside": -sign * 0.02,
        }  # fmt: skip
        lag = {f"{side}.elbow": 0.08, f"{side}.turn": 0.05, f"{side}.pronation": 0.12,
               f"{side}.raised": -0.05, "look": -0.1}  # fmt: skip
        stage.gesture(raised, clock, rise, hold, fall, lag)
        # To and fro: the upper arm turns, the elbow follows, the wrist trails.
        beat = rng.uniform(1.4, 2.4) * tempo
        width = rng.uniform(0.7, 1.3)
        swing = bump(t, clock + 0.6 * rise, 0.35, max(hold - 0.2, 0.2), 0.35)
        angle = 2 * np.pi * beat * (t - clock)
        stage.add(f"{side}.turn", 14 * width * swing * np.sin(angle))
        stage.add(f"{side}.elbow", 13 * width * swing * np.sin(angle - 0.5))
        stage.add(f"{side}.wrist", 12 * width * swing * np.sin(angle - 1.1))
        stage.add("side", 0.5 * swing * np.sin(angle - 0.3))
        clock += rise + hold + fall + rng.uniform(0.6, 2.0)
    idle_quietly(stage, seconds)


def idle_quietly(stage: Stage, seconds: float) -> None:
    """Shift the weight from time to time."""
    rng = stage.rng
    clock = rng.uniform(0.5, 2.0)
    before = 0.0
    while clock < seconds:
        goal = rng.uniform(-0.5, 0.5)
        shift_weight(stage, goal - before, clock, rng.uniform(0.8, 1.4))
        before = goal
        clock += rng.uniform(2.0, 4.0)
