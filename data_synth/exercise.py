"""Exercises: squats, jumping jacks and press-ups, each repetition a little unlike the last."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from data_synth.assemble import bent
from data_synth.body import LEFT, SIDES, SIGN
from data_synth.curves import ease
from data_synth.footsteps import Foot
from data_synth.pose import Leg, Pose
from data_synth.stage import Stage, bump
from data_synth.stride import pitched, turned


def squats(stage: Stage, seconds: float, tempo: float) -> None:
    """Down until the thighs are near level and up again, arms forwards for balance."""
    rng, body = stage.rng, stage.body
    wide = 0.5 * body.hip_width + rng.uniform(0.06, 0.14)
    out = rng.uniform(10, 18)
    stage.feet = [Foot(sign * wide, 0.0, sign * out) for sign in SIGN]
    arms = float(rng.uniform(0.75, 1.0))
    clock = rng.uniform(0.3, 0.8)
    while clock < seconds - 1.5:
        down, up = rng.uniform(0.8, 1.3) / tempo, rng.uniform(0.7, 1.1) / tempo
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
    rng, body, t = stage.rng, stage.body, stage.t
    near = 0.5 * body.hip_width + 0.01
    stage.feet = [Foot(sign * near, 0.0, sign * rng.uniform(5, 9)) for sign in SIGN]
    wide = near + rng.uniform(0.17, 0.28) * body.leg / 0.85
    half = rng.uniform(0.46, 0.58) / tempo
    high = rng.uniform(145, 165)
    bend = rng.uniform(12, 30)
    clock, apart = rng.uniform(0.5, 1.0), False
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
            begin, over = clock + rng.uniform(0, 0.03) - 0.02, 0.92 * beat
            stage.move(f"{name}.abduction", lift, begin, over)
            stage.move(f"{name}.turn", -0.28 * lift, begin + 0.02, over)
            stage.move(f"{name}.raised", 0.11 * lift, begin - 0.02, over)
            stage.add(f"{name}.elbow", bend * bump(t, begin, 0.5 * over, 0.0, 0.5 * over))
        stage.add("up", _hop(t, leave, flight, 0.06))
        stage.add("bend", 4.0 * bump(t, leave + flight - 0.05, 0.12, 0.0, 0.2))
        stage.add("nod", -3.0 * bump(t, leave + flight, 0.12, 0.0, 0.2))
        apart = not apart
        clock += beat


def _hop(t: np.ndarray, leave: float, flight: float, dip: float) -> np.ndarray:
    """Crouch, fly as a thrown body does (g T²/8 high), land and give."""
    u = (t - leave) / flight
    flying = 9.81 * flight**2 / 8 * np.clip(4 * u * (1 - u), 0.0, None)
    pushes = bump(t, leave - 0.20, 0.10, 0.0, 0.12) + bump(
        t, leave + flight - 0.04, 0.12, 0.0, 0.18
    )
    return smooth_corner(flying) - dip * pushes


def smooth_corner(height: np.ndarray, over: float = 0.012) -> np.ndarray:
    """Round off the corner where a flight begins: sqrt(h² + ε²) - ε."""
    return np.sqrt(height**2 + over**2) - over


def press_ups(stage: Stage, seconds: float, tempo: float) -> tuple[Pose, np.ndarray]:
    """A straight body turns about the toes; hands stay on the floor, elbows bend and stretch."""
    rng, body, t = stage.rng, stage.body, stage.t
    low = np.zeros(len(t))
    clock = rng.uniform(0.2, 0.8)
    while clock < seconds - 1.0:
        down, up = rng.uniform(0.6, 1.0) / tempo, rng.uniform(0.5, 0.9) / tempo
        hold = rng.uniform(0.0, 0.2)
        low += rng.uniform(0.75, 1.0) * bump(t, clock, down, hold, up)
        clock += down + hold + up + rng.uniform(0.05, 0.5) / tempo
    return _Plank(stage, low, rng).pose()


class _Plank:
    """The geometry of a press-up in the plane, then in the world."""

    def __init__(self, stage: Stage, low: np.ndarray, rng: np.random.Generator):
        self.stage, self.body, self.low = stage, stage.body, low
        self.sag = np.radians(rng.uniform(-4, 3))
        self.pitch = -np.radians(66.0)
        body = stage.body
        pivot = np.array([0.0, body.ankle_height, 0.0]) + body.ball
        self.ankle = pivot - pitched(body.ball, np.array(self.pitch))
        spine = sum(body.offset(n)[1] for n in ("upperback", "thorax", "lowerneck"))
        shoulder = body.offset("lhumerus")
        self.trunk = -body.hip(LEFT)[1] + spine + shoulder[1]
        self.wrist_height = 0.035 * body.stature
        self.hands_out = abs(shoulder[0]) * rng.uniform(1.05, 1.4)
        self.hands_turn = np.radians(rng.uniform(0, 20))
        across = self.hands_out - abs(shoulder[0])
        reach = np.sqrt((0.955 * body.arm) ** 2 - across**2)
        self.high = self._slope(self.wrist_height + reach)
        self.deep = self._slope(self.wrist_height + rng.uniform(0.22, 0.32) * body.arm)

    def _slope(self, shoulder_height: float) -> float:
        length = 0.990 * self.body.leg + self.trunk
        return float(np.arcsin((shoulder_height - self.ankle[1]) / length))

    def pose(self) -> tuple[Pose, np.ndarray]:
        stage, body, frames = self.stage, self.body, len(self.low)
        slope = self.high + (self.deep - self.high) * self.low
        ahead, up = np.cos(slope + self.sag), np.sin(slope + self.sag)
        zero = np.zeros(frames)
        hip = self.ankle + 0.990 * body.leg * np.stack([zero, up, ahead], axis=-1)
        tilt = np.pi / 2 - slope + 0.6 * self.sag
        small = {n: np.radians(0.5 * (stage.angles[n] - stage.angles[n].mean())) for n in
                 ("turn", "side", "twist")}  # fmt: skip
        level = Rotation.from_euler("YXZ", np.stack([zero, tilt, small["turn"]], axis=-1))
        place = hip - level.apply(body.hip(LEFT) * [0, 1, 1])
        facing = Rotation.from_euler("Y", stage.heading[:, None])
        pelvis = facing * level
        place = facing.apply(place)
        foot = Rotation.from_euler(
            "YX", np.stack([stage.heading, np.full(frames, -self.pitch)], axis=-1)
        )
        legs = []
        for sign in SIGN:
            ankle = self.ankle + np.array([sign * 0.55 * body.hip_width, 0.0, 0.0])
            ankle = np.tile(ankle, (frames, 1))
            legs.append(
                Leg(facing.apply(ankle), foot, np.full(frames, -self.pitch), np.full(frames, 0.0))
            )
        spine = np.stack([-1.6 * self.sag + zero, small["side"], small["twist"]], axis=-1)
        lift = np.radians(-24 + stage.angles["nod"] - stage.angles["nod"].mean())
        neck = np.stack([lift + 0.15 * self.low, zero, np.radians(0.5 * stage.angles["look"])], -1)
        arms = tuple(self._arm(side, place, pelvis, spine, facing) for side in (0, 1))
        stage.path[:] = 0.0
        stage.plank_place = place
        return Pose(place, pelvis, spine, neck, tuple(legs), arms), np.ones((frames, 2), bool)

    def _arm(self, side, place, pelvis, spine, facing):
        body, sign, frames = self.body, SIGN[side], len(self.low)
        # Under the shoulders of the upper position.
        length = 0.990 * body.leg * np.cos(self.high + self.sag) + self.trunk * np.cos(self.high)
        hand = np.array([sign * self.hands_out, self.wrist_height, self.ankle[2] + length - 0.03])
        arm = self.stage._arm(side)
        arm.goal = facing.apply(np.tile(hand, (frames, 1)))
        arm.goal_weight = np.ones(frames)
        arm.elbow_side = np.array([sign * 0.75, -0.75, -0.25])
        # The palm on the floor, fingers ahead: the arm's X turned from the side to the front.
        yaw = np.full(frames, -sign * (np.pi / 2 - self.hands_turn))
        arm.hand = facing * Rotation.from_euler("Y", yaw[:, None])
        arm.curl = np.full(frames, np.radians(4))
        arm.pronation = np.full(frames, np.radians(50))
        return arm


__all__ = ["bent", "ease", "jumping_jacks", "press_ups", "squats", "turned"]
