"""Press-ups: a straight body rotates about the toes, hands stay on the floor, elbows bend.

The slope of the body determines the height of the shoulders; the slope for a given height is found
by Brent's method, and the arms reach down to the floor.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from data_synth.assemble import bend_trunk
from data_synth.body import LEFT, SIGN
from data_synth.pose import Arm, Leg, Pose
from data_synth.stage import Stage, bump
from data_synth.stride import lift_front

# The foot stands on its toes, nearly upright.
_FOOT_PITCH = -np.radians(66.0)
# How straight the legs are: distance from hip to ankle over its length.
_STRAIGHT = 0.995


def press_ups(stage: Stage, seconds: float, tempo: float) -> None:
    """Several press-ups of different depth with short rests."""
    rng = stage.rng
    t = stage.t
    low = np.zeros(len(t))
    clock = rng.uniform(0.2, 0.8)
    while clock < seconds - 1.0:
        down = rng.uniform(0.6, 1.0) / tempo
        up = rng.uniform(0.5, 0.9) / tempo
        hold = rng.uniform(0.0, 0.2)
        low += rng.uniform(0.75, 1.0) * bump(t, clock, down, hold, up)
        clock += down + hold + up + rng.uniform(0.05, 0.5) / tempo
    stage.prone = Plank(stage, low)


class Plank:
    """A person face down on hands and toes.

    Parameters
    ----------
    stage : Stage
        Gives the small movements of a body at rest.
    low : (F,) array
        0 with straight arms, 1 with the chest near the floor.
    """

    def __init__(self, stage: Stage, low: np.ndarray):
        rng = stage.rng
        body = stage.body
        self.stage = stage
        self.body = body
        self.low = low
        self.sag = np.radians(rng.uniform(-4, 3))
        self.hollow = -1.6 * self.sag
        pivot = np.array([0.0, body.ankle_height, 0.0]) + body.ball
        self.ankle = pivot - lift_front(body.ball, np.array(_FOOT_PITCH))
        self.wrist_height = 0.035 * body.stature
        half = abs(body.offset("lhumerus")[0])
        self.hands_out = half * rng.uniform(1.05, 1.4)
        self.hands_turn = np.radians(rng.uniform(0, 20))
        reach = np.sqrt((0.955 * body.arm) ** 2 - (self.hands_out - half) ** 2)
        self.high = self._slope_for(self.wrist_height + reach)
        self.deep = self._slope_for(self.wrist_height + rng.uniform(0.28, 0.38) * body.arm)
        self.slope = self.high + (self.deep - self.high) * low
        self.level = self._level(self.slope, self._unrest("turn"))
        self.place = self._place(self.slope, self.level)

    def _slope_for(self, shoulder_height: float) -> float:
        return brentq(lambda slope: self._shoulder(slope)[1] - shoulder_height, -0.4, 1.2)

    def _shoulder(self, slope: float) -> np.ndarray:
        """The left shoulder joint at rest at this slope, (3,)."""
        slopes = np.array([slope])
        zero = np.zeros(1)
        level = self._level(slopes, zero)
        spine = np.array([[self.hollow, 0.0, 0.0]])
        chest, trunk, _ = bend_trunk(self.body, self._place(slopes, level), level, spine)
        return (chest + trunk.apply(self.body.offset("lhumerus")))[0]

    def _level(self, slope: np.ndarray, roll: np.ndarray) -> Rotation:
        """The rotation of the pelvis of a person who faces +Z."""
        tilt = np.pi / 2 - slope + 0.6 * self.sag
        return Rotation.from_euler("YXZ", np.stack([0 * roll, tilt, roll], axis=-1))

    def _place(self, slope: np.ndarray, level: Rotation) -> np.ndarray:
        """The position of the root, (F, 3), of a person who faces +Z."""
        way = np.stack([0 * slope, np.sin(slope + self.sag), np.cos(slope + self.sag)], axis=-1)
        leg = _STRAIGHT * self.body.leg
        return self.ankle + leg * way - level.apply(self.body.hip(LEFT) * [0, 1, 1])

    def _unrest(self, name: str) -> np.ndarray:
        values = self.stage.angles[name]
        return np.radians(0.5 * (values - values.mean()))

    def pose(self) -> tuple[Pose, np.ndarray]:
        """The pose, and which foot's ball stands still: both."""
        stage = self.stage
        body = self.body
        frames = len(self.low)
        facing = Rotation.from_euler("Y", stage.heading[:, None])
        place = facing.apply(self.place)
        pelvis = facing * self.level
        pitch = np.full(frames, -_FOOT_PITCH)
        foot = facing * Rotation.from_euler("X", pitch[:, None])
        zero = np.zeros(frames)
        legs = []
        for sign in SIGN:
            aside = np.array([sign * 0.55 * body.hip_width, 0.0, 0.0])
            ankle = facing.apply(np.tile(self.ankle + aside, (frames, 1)))
            legs.append(Leg(ankle, foot, pitch, zero))
        spine = np.stack([zero + self.hollow, self._unrest("side"), self._unrest("twist")], axis=-1)
        lift = np.radians(-24) + self._unrest("nod") + 0.15 * self.low
        neck = np.stack([lift, zero, self._unrest("look")], axis=-1)
        arms = (self._arm(0, facing), self._arm(1, facing))
        pose = Pose(place, pelvis, spine, neck, (legs[0], legs[1]), arms)
        return pose, np.ones((frames, 2), dtype=bool)

    def _arm(self, side: int, facing: Rotation) -> Arm:
        sign = SIGN[side]
        frames = len(self.low)
        # Under the shoulders of the upper position.
        ahead = self._shoulder(self.high)[2] - 0.02
        hand = np.array([sign * self.hands_out, self.wrist_height, ahead])
        # The palm on the floor, fingers ahead: the arm's X turned from the side to the front.
        yaw = np.full((frames, 1), -sign * (np.pi / 2 - self.hands_turn))
        return replace(
            self.stage.arm(side),
            curl=np.full(frames, np.radians(4)),
            pronation=np.full(frames, np.radians(50)),
            goal=facing.apply(np.tile(hand, (frames, 1))),
            goal_weight=np.ones(frames),
            elbow_side=np.array([sign * 0.75, -0.75, -0.25]),
            hand=facing * Rotation.from_euler("Y", yaw),
        )
