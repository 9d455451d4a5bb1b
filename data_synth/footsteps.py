"""Feet that stand and step, for everything but walking.

A step from A to B is a minimum-jerk path along the floor and an arch above it. Heels may rise
while the ball of the foot stays where it is.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from data_synth.body import Body
from data_synth.curves import ease
from data_synth.stride import lift_front
from numpy_cae.motion.features import rotate_about_y


@dataclass(eq=False)
class Foot:
    """The positions of one foot over a take.

    Parameters
    ----------
    side, ahead : float
        Where the ankle stands at first, in the frame of the stage, metres.
    yaw : float
        The foot's direction in that frame, degrees, towards the left positive.
    steps : list
        Filled by `step`.
    """

    side: float
    ahead: float
    yaw: float
    steps: list[tuple[float, float, np.ndarray, float]] = field(default_factory=list)

    def step(
        self,
        start: float,
        end: float,
        to: tuple[float, float],
        yaw: float | None = None,
        lift: float = 0.05,
    ) -> None:
        """Step to (side, ahead) between two times in seconds, turning to `yaw` degrees.

        Steps must be given in the order of time.
        """
        before = self.last()
        goal = np.array([*to, before[2] if yaw is None else yaw])
        self.steps.append((start, end, goal - before, lift))

    def last(self) -> np.ndarray:
        """Side, ahead and yaw after all steps so far, (3,)."""
        return np.array([self.side, self.ahead, self.yaw]) + sum(s[2] for s in self.steps)

    def at(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Side, ahead and yaw in degrees, (F, 3); height above the floor, (F,); in the air."""
        state = np.tile([self.side, self.ahead, self.yaw], (len(t), 1))
        height = np.zeros(len(t))
        flying = np.zeros(len(t), dtype=bool)
        for start, end, change, lift in self.steps:
            u = (t - start) / (end - start)
            state += ease(u)[:, None] * change
            height += lift * arch(u)
            flying |= (u > 0) & (u < 1)
        return state, height, flying


def arch(u: np.ndarray) -> np.ndarray:
    """A smooth arch, 0 at u = 0 and 1, 1 in the middle: (4u(1-u))²."""
    u = np.clip(u, 0.0, 1.0)
    return (4 * u * (1 - u)) ** 2


def stand(
    body: Body, state: np.ndarray, height: np.ndarray, heel: np.ndarray, heading: np.ndarray
) -> tuple[np.ndarray, Rotation, np.ndarray]:
    """The ankle in the frame of the floor, the foot's turn, and its toes' bend.

    Parameters
    ----------
    body : Body
    state : (F, 3) array
        Side, ahead, yaw in degrees, against the heading.
    height : (F,) array
        Above the floor, metres.
    heel : (F,) array
        How far the heel is raised about the ball, degrees; below 0 the toes are raised.
    heading : (F,) array
        Radians.
    """
    yaw = heading + np.radians(state[:, 2])
    pitch = -np.radians(heel)
    pivot = np.where((pitch > 0)[:, None], body.heel, body.ball)
    rise = rotate_about_y(pivot - lift_front(pivot, pitch), yaw)
    zero = np.zeros(len(state))
    ankle = rotate_about_y(np.stack([state[:, 0], zero, state[:, 1]], axis=-1), heading)
    ankle += rise
    ankle[:, 1] += body.ankle_height + height
    foot = Rotation.from_euler("YX", np.stack([yaw, -pitch], axis=-1))
    return ankle, foot, np.maximum(-pitch, 0.0)
