"""Walking a dog: one arm holds the lead forwards, the dog tugs and stops at random times.

One of the three actions of jang2018, after Human3.6M's "WalkDog".
"""

import numpy as np

from data_synth.body import SIGN, Body
from data_synth.curves import drift
from data_synth.pose import Pose
from data_synth.stage import bump
from numpy_cae.motion.features import rotate_about_y


def hold_lead(
    pose: Pose, body: Body, heading: np.ndarray, t: np.ndarray, rng: np.random.Generator
) -> None:
    """Make one arm of a walk hold a lead; changes the pose in place.

    Parameters
    ----------
    pose : Pose of F frames
    body : Body
    heading : (F,) array
        Of the walker, radians.
    t : (F,) array
        Seconds.
    rng : numpy.random.Generator
    """
    side = int(rng.integers(2))
    sign = SIGN[side]
    size = body.stature / 1.75
    tug = _tugs(t, rng)
    dog = drift(rng, 0.30, 0.05, 0.25)(t)
    aside = sign * 0.20 + 0.16 * np.sin(dog) + 0.02 * drift(rng, 1.0, 0.2, 0.8)(t)
    ahead = 0.27 + 0.03 * drift(rng, 1.0, 0.1, 0.6)(t) + 0.15 * tug
    height = 0.605 * body.stature + 0.02 * drift(rng, 1.0, 0.2, 0.9)(t) - 0.03 * tug
    hand = rotate_about_y(np.stack([aside, np.zeros(len(t)), ahead], axis=-1) * size, heading)
    arm = pose.arms[side]
    arm.goal = np.stack(
        [pose.place[:, 0] + hand[:, 0],
         height + 0.6 * (pose.place[:, 1] - pose.place[:, 1].mean()),
         pose.place[:, 2] + hand[:, 2]], axis=-1,
    )  # fmt: skip
    arm.goal_weight = np.full(len(t), 1.0)
    arm.elbow_side = np.array([sign * 0.55, -0.8, -0.45])
    arm.curl = np.full(len(t), np.radians(75))
    arm.forwards = arm.forwards + np.radians(9) * tug
    # A tug moves the shoulder and the trunk, and the head turns to the dog.
    pose.spine[:, 0] += np.radians(4.0) * tug
    pose.spine[:, 2] -= sign * np.radians(7.0) * tug
    pose.neck[:, 0] += np.radians(3.0) + np.radians(4.0) * drift(rng, 1.0, 0.08, 0.4)(t)
    pose.neck[:, 2] += 0.7 * np.sin(dog) + sign * np.radians(5.0) * tug
    free_arm = pose.arms[1 - side]
    free_arm.elbow = free_arm.elbow + np.radians(rng.uniform(0, 15))


def _tugs(t: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The strength of the pull, 0 to 1; the dog pulls about every three seconds."""
    tug = np.zeros(len(t))
    clock = t[0] + rng.uniform(0.3, 2.0)
    while clock < t[-1]:
        hold = rng.uniform(0.05, 0.7)
        tug += rng.uniform(0.4, 1.0) * bump(t, clock, rng.uniform(0.16, 0.24), hold, 0.5)
        clock += hold + 0.8 + rng.exponential(1.8)
    return tug


def bouts(rng: np.random.Generator, begin: float, end: float) -> list[tuple[float, float]]:
    """The intervals of walking; every few seconds the dog stops."""
    walks = []
    clock = begin
    while end - clock > 2.5:
        stop = min(clock + rng.uniform(3.0, 8.0), end)
        if end - stop < 2.5:
            stop = end
        walks.append((clock, stop))
        clock = stop + rng.uniform(0.8, 2.8)
    return walks
