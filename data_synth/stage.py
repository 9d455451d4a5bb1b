"""The base of all gestures: a standing person to whose angles gestures are added.

Angles are in degrees and lengths in metres. Names of angles: ``turn tilt list`` (pelvis),
``bend side twist`` (spine), ``nod lean look`` (neck), an arm's angles as ``l.elbow`` and
so on (see `Arm`), ``l.heel`` (heel raised), ``l.splay`` (knee outwards), and for a leg in the air
``l.free`` (0 to 1), ``l.thigh l.knee l.out l.ankle``. Lengths: ``aside up ahead`` (pelvis).
"""

from collections import defaultdict
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from data_synth.body import SIDES, SIGN, Body
from data_synth.curves import drift, ease, limit_softly, smooth_over
from data_synth.footsteps import Foot, stand
from data_synth.pose import Arm, Leg, Pose
from numpy_cae.motion.features import rotate_about_y

# How far gestures together can take an angle, degrees; the joints themselves go a little further.
_REACH = {"bend": (-45, 95), "side": (-60, 60), "twist": (-58, 58), "nod": (-45, 75),
          "lean": (-60, 60), "look": (-72, 72), "pronation": (-80, 90), "wrist": (-85, 75),
          "elbow": (4, 145), "curl": (-20, 90), "raised": (-8, 34),
          "forwards": (-22, 26)}  # fmt: skip


class Stage:
    """A person who stands at ease and sways, and to whom gestures are added.

    Parameters
    ----------
    body : Body
    t : (F,) array
        Seconds.
    rng : numpy.random.Generator
    lively : float
        The size of the sway and of other small movements; 1 is as measured in quiet standing.
    """

    def __init__(self, body: Body, t: np.ndarray, rng: np.random.Generator, lively: float = 1.0):
        self.body = body
        self.t = t
        self.rng = rng
        self.angles: dict[str, np.ndarray] = defaultdict(lambda: np.zeros(len(t)))
        self.heading = np.full(len(t), rng.uniform(-np.pi, np.pi))
        self.start = np.zeros(2)
        # The target path; `aside` and `ahead` add the sway.
        self.path = np.zeros((len(t), 2))
        half = 0.5 * body.hip_width + rng.uniform(0.0, 0.05)
        self.feet = [
            Foot(sign * half, rng.uniform(-0.02, 0.02), sign * rng.uniform(4, 14)) for sign in SIGN
        ]
        # Goals of the hands: fields of `Arm`.
        self.goals: list[dict] = [{}, {}]
        # A person on hands and toes, if any; it has a `place` and a `pose()`.
        self.prone: Any = None  # a Plank of press_ups, which imports this module
        self._rest(lively)

    def add(self, name: str, values: np.ndarray | float) -> None:
        """Add to an angle (degrees) or length (metres)."""
        self.angles[name] = self.angles[name] + values

    def move(self, name: str, amount: float, start: float, over: float) -> None:
        """Change an angle or length by `amount` within `over` seconds, and leave it there."""
        self.add(name, amount * ease((self.t - start) / over))

    def gesture(
        self,
        amounts: dict[str, float],
        start: float,
        rise: float,
        hold: float,
        fall: float,
        lag: dict[str, float] | None = None,
    ) -> None:
        """Go to a pose and back: each angle by its amount, with a delay for some."""
        lag = lag or {}
        for name, amount in amounts.items():
            shape = bump(self.t - lag.get(name, 0.0), start, rise, hold, fall)
            self.add(name, amount * shape)

    def _rest(self, lively: float) -> None:
        rng = self.rng
        t = self.t
        for name, size in {"aside": 0.008, "ahead": 0.006}.items():
            self.add(name, lively * size * drift(rng, 1.0, 0.08, 0.7)(t))
        for name in ("turn", "tilt", "bend", "side", "twist", "nod", "lean"):
            self.add(name, lively * drift(rng, 1.1, 0.08, 0.5)(t))
        self.add("look", lively * drift(rng, 4.0, 0.05, 0.3)(t))
        breath = np.sin(2 * np.pi * (rng.uniform(0.2, 0.3) * t + rng.random()))
        self.add("bend", rng.normal(3, 2) - 0.8 * breath)
        self.add("nod", rng.normal(2, 3) + 0.5 * breath)
        for side in SIDES:
            self.add(f"{side}.raised", 0.8 * breath)
            rest = {"flexion": 2, "abduction": 8, "turn": 10, "elbow": 16, "pronation": 25,
                    "wrist": 8, "curl": 28}  # fmt: skip
            for name, mean in rest.items():
                wander = drift(rng, 1.5, 0.08, 0.5)(t)
                self.add(f"{side}.{name}", mean * np.exp(rng.normal(0, 0.15)) + lively * wander)
            self.add(f"{side}.splay", 4.0)

    def _radians(self, name: str) -> np.ndarray:
        # The sum of several gestures is limited to the joint's range.
        angles = self.angles[name]
        reach = _REACH.get(name.removeprefix("l.").removeprefix("r."))
        return np.radians(angles if reach is None else limit_softly(angles, *reach))

    def pose(self) -> tuple[Pose, np.ndarray]:
        """The pose at every time, and which foot's ball stands still, (F, 2) bool."""
        if self.prone is not None:
            return self.prone.pose()
        turn, tilt, sideways = (self._radians(n) for n in ("turn", "tilt", "list"))
        angles = np.stack([self.heading + turn, tilt, sideways], axis=-1)
        pelvis = Rotation.from_euler("YXZ", angles)
        planted = [self._planted(side) for side in (0, 1)]
        flying = np.stack([p[3] for p in planted], axis=-1)
        free = np.stack([self.angles[f"{s}.free"] > 0 for s in SIDES], axis=-1)
        place = self._place()
        place[:, 1] -= self._lowering(place, pelvis, planted, flying | free)
        left, right = (self._leg(side, place, pelvis, planted[side]) for side in (0, 1))
        spine = np.stack([self._radians(n) for n in ("bend", "side", "twist")], axis=-1)
        neck = np.stack([self._radians(n) for n in ("nod", "lean", "look")], axis=-1)
        arms = (self.arm(0), self.arm(1))
        return Pose(place, pelvis, spine, neck, (left, right), arms), ~(flying | free)

    def target_path(self) -> np.ndarray:
        """x and z of the target path, (F, 2), metres."""
        if self.prone is not None:
            return rotate_about_y(self.prone.place, self.heading)[:, [0, 2]]
        way = np.stack([self.path[:, 0], np.zeros(len(self.t)), self.path[:, 1]], axis=-1)
        return self.start + rotate_about_y(way, self.heading)[:, [0, 2]]

    def _place(self) -> np.ndarray:
        height = self.body.standing - 0.009 * self.body.leg + self.angles["up"]
        aside = self.path[:, 0] + self.angles["aside"]
        ahead = self.path[:, 1] + self.angles["ahead"]
        place = rotate_about_y(
            np.stack([aside, np.zeros_like(aside), ahead], axis=-1), self.heading
        )
        place += [self.start[0], 0.0, self.start[1]]
        # The hip joints, not the root, stand above the ankles.
        place -= rotate_about_y(self.body.hip(0) * [0, 0, 1], self.heading)
        place[:, 1] = height
        return place

    def _planted(self, side: int):
        state, height, flying = self.feet[side].at(self.t)
        heel = self.angles[f"{SIDES[side]}.heel"]
        ankle, foot, toes = stand(self.body, state, height, heel, self.heading)
        return ankle + [self.start[0], 0.0, self.start[1]], foot, toes, flying

    def _lowering(self, place, pelvis, planted, away) -> np.ndarray:
        """How far the pelvis must sink so that the legs reach standing feet, smoothed."""
        need = np.zeros(len(place))
        for side in (0, 1):
            hip = place + pelvis.apply(self.body.hip(side))
            ankle = planted[side][0]
            flat = np.sum((ankle - hip)[:, [0, 2]] ** 2, axis=-1)
            highest = np.sqrt(np.maximum((0.993 * self.body.leg) ** 2 - flat, 1e-4))
            missing = hip[:, 1] - ankle[:, 1] - highest
            need = np.maximum(need, np.where(away[:, side], 0.0, missing))
        return smooth_over(need, 0.16 / (self.t[1] - self.t[0]) if len(self.t) > 1 else 1)

    def _leg(self, side: int, place: np.ndarray, pelvis: Rotation, planted) -> Leg:
        ankle, foot, toes, _ = planted
        name = SIDES[side]
        sign = SIGN[side]
        free = self.angles[f"{name}.free"]
        if np.any(free > 0):
            thigh, knee, out, bent = (
                self._radians(f"{name}.{n}") for n in ("thigh", "knee", "out", "ankle")
            )
            shank = thigh - knee
            upper = self.body.thigh
            lower = self.body.shank
            ahead = upper * np.sin(thigh) + lower * np.sin(shank)
            down = upper * np.cos(thigh) + lower * np.cos(shank)
            way = np.stack([sign * down * np.sin(out), -down * np.cos(out), ahead], axis=-1)
            facing = pelvis.as_euler("YXZ")[:, 0]
            lifted = place + pelvis.apply(self.body.hip(side)) + rotate_about_y(way, facing)
            ankle = ankle + free[:, None] * (lifted - ankle)
            # The foot rises before it moves forwards, so that the toes clear the floor.
            ankle[:, 1] += 0.16 * self.body.leg * free * (1 - free)
            turn = foot.as_euler("YXZ")
            turn[:, 1] += free * (-(shank + bent) - turn[:, 1])
            away = (facing + sign * np.radians(6.0) - turn[:, 0] + np.pi) % (2 * np.pi) - np.pi
            turn[:, 0] += free * away
            foot = Rotation.from_euler("YXZ", turn)
            toes = toes * (1 - free)
        return Leg(ankle, foot, toes, self._radians(f"{name}.splay"))

    def arm(self, side: int) -> Arm:
        """The angles of one arm, and its goal if it has one."""
        name = SIDES[side]
        fields = ("flexion", "abduction", "turn", "elbow", "pronation", "wrist", "raised",
                  "forwards", "curl")  # fmt: skip
        angles = {field: self._radians(f"{name}.{field}") for field in fields}
        return Arm(**angles, **self.goals[side])


def bump(t: np.ndarray, start: float, rise: float, hold: float, fall: float) -> np.ndarray:
    """A smooth curve that is 0, then 1 from start + rise on for `hold` seconds, then 0 again."""
    return ease((t - start) / rise) - ease((t - start - rise - hold) / fall)
