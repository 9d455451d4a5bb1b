"""A whole walk: a random route, legs by `Gait`, and the opposite movement of the upper body.

The chest rotates against the pelvis, each arm swings with the opposite leg, elbows follow the
shoulders with a delay, and the head compensates the trunk so that the eyes stay level
(Pozzo, Berthoz & Lefort, 1990, *Exp. Brain Res.* 82:97).
"""

import numpy as np

from data_synth.body import Body
from data_synth.curves import drift, ease
from data_synth.gait import Gait
from data_synth.manner import Manner
from data_synth.pose import Arm, Pose
from data_synth.route import Route

# Strides after a heel strike when a walker stops: that foot is flat, the other has not left.
_STOP = 0.064


def set_out(
    rng: np.random.Generator,
    manner: Manner,
    stature: float,
    times: np.ndarray,
    headings: np.ndarray,
    bouts: list[tuple[float, float]],
) -> tuple[Route, np.ndarray]:
    """A route with the manner's speed, and its phase; each bout begins and ends with standing.

    Parameters
    ----------
    rng : numpy.random.Generator
    manner : Manner
    stature : float
        Metres.
    times, headings : (N,) arrays
        Times in seconds, and the direction that the walker faces, in radians.
    bouts : list of (begin, end)
        Seconds, one after the other.

    Returns
    -------
    route : Route
    phase : (N,) array
        Strides done at `times`.
    """
    size = stature / 1.75
    speed = manner.speed * np.sqrt(size)
    steps = manner.cadence / 60 / np.sqrt(size)
    # Full speed is reached within three steps (Breniere & Do, 1986, J. Biomech. 19:1035).
    gather = 3 / steps
    wander = drift(rng, 0.02, 0.1, 0.5)(times)
    # People slow down in a bend, by a tenth at 40 degrees a second.
    bend = np.abs(np.gradient(headings, times))
    go = np.zeros(len(times))
    phase = np.full(len(times), 0.5 * rng.integers(2))
    step = times[1] - times[0]
    for begin, end in bouts:
        go += ease((times - begin) / gather) * ease((end - times) / gather)
        ticking = ease((times - begin) / 0.35) * steps / 2 * (1 + 0.7 * wander)
        done = np.concatenate([[0.0], np.cumsum((ticking[1:] + ticking[:-1]) / 2) * step])
        # The last foot comes down flat before its clock stops, and the other foot has not left.
        before = phase[-1]
        arrived = np.ceil(2 * (before + np.interp(end - 0.3, times, done))) / 2 + _STOP
        phase = np.minimum(before + done, arrived) if begin <= times[0] else np.where(
            times < begin, phase, np.minimum(before + done, arrived)
        )  # fmt: skip
    speeds = speed * go * (1 + wander) / (1 + 0.15 * bend)
    return Route(times, speeds, headings), phase


def walk(
    body: Body,
    manner: Manner,
    route: Route,
    phase: np.ndarray,
    t: np.ndarray,
    rng: np.random.Generator,
) -> tuple[Pose, np.ndarray]:
    """The pose at each time t, and which foot's ball stands still, (F, 2) bool."""
    gait = Gait(body, manner, route, phase, rng)
    place, pelvis = gait.pelvis(t)
    legs, contacts = zip(*(gait.leg(t, side) for side in (0, 1)), strict=True)
    spine, neck = _trunk(gait, t, rng)
    arms = (_arm(gait, t, 0, rng), _arm(gait, t, 1, rng))
    return Pose(place, pelvis, spine, neck, legs, arms), np.stack(contacts, axis=-1)


def _trunk(gait: Gait, t: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    m = gait.manner
    angle = 2 * np.pi * gait.phase(t)
    vigour = gait.vigour(t)
    yaw, tilt, drop = gait.pelvis_angles(t)
    heading = gait.route.heading(t)
    chest_turn = m.chest_turn * vigour * np.cos(angle - 0.35)
    chest_lean = m.lean + np.radians(1.0) * vigour * np.cos(2 * angle - 1.8)
    breath = np.radians(0.8) * np.sin(2 * np.pi * 0.25 * t + rng.uniform(0, 6))
    aside = np.radians(1.3) * vigour * np.cos(angle - 2 * np.pi * 0.33)
    wander = [np.radians(1.2) * drift(rng, 1.0, 0.08, 0.4)(t) for _ in range(5)]
    spine = np.stack(
        [
            chest_lean - tilt + m.stoop + breath + wander[0],
            0.95 * drop + aside + wander[1],
            chest_turn - (yaw - heading) + wander[2],
        ],
        axis=-1,
    )
    # Eyes lead into a bend by a third of a second.
    look = np.clip(gait.route.heading(t + 0.35) - heading, -0.6, 0.6)
    neck = np.stack(
        [
            m.gaze - 0.85 * (chest_lean + m.stoop) + 2 * wander[3],
            -0.8 * aside - wander[1],
            look - 0.85 * chest_turn + 3 * wander[4],
        ],
        axis=-1,
    )
    return spine, neck


def _arm(gait: Gait, t: np.ndarray, side: int, rng: np.random.Generator) -> Arm:
    m = gait.manner
    vigour = gait.vigour(t)
    phase = gait.phase(t)
    # Furthest forwards a little after the strike of the other foot.
    late = rng.normal(0.03, 0.012)
    angle = 2 * np.pi * (phase - 0.5 * (1 - side) - late)
    own = np.exp(rng.normal(0, 0.12))
    wander = [drift(rng, np.radians(1.5), 0.1, 0.7)(t) for _ in range(4)]
    swing = own * m.arm_swing * vigour * (np.cos(angle) + 0.08 * np.cos(2 * angle + 0.8))
    bend = own * m.elbow_swing * vigour * np.cos(angle - 0.55)
    rest = 0.55 + 0.45 * vigour
    return Arm(
        flexion=m.arm_rest + m.lean + 0.5 * m.stoop + swing + wander[0],
        abduction=m.arm_out + np.radians(1.5) * vigour * np.cos(2 * angle) + wander[1],
        turn=np.radians(8) + 0.25 * swing + 2 * wander[2],
        elbow=np.maximum(m.elbow * rest + bend + wander[3], np.radians(6)),
        pronation=np.radians(22) + 0.2 * bend + 2 * wander[1],
        wrist=np.radians(6) - 0.25 * np.maximum(swing, -0.5) + wander[2],
        raised=np.radians(1.5) * vigour * np.cos(2 * angle + 1.0),
        forwards=0.10 * swing,
        curl=np.full(len(t), np.radians(rng.uniform(18, 40))),
    )


def bends(rng: np.random.Generator, times: np.ndarray, most: float) -> np.ndarray:
    """A heading that varies by up to about `most` radians, from a random start."""
    return rng.uniform(-np.pi, np.pi) + drift(rng, most / 2, 0.03, 0.15)(times)


def turn_at(rng: np.random.Generator, times: np.ndarray, angle: float, when: float, over: float):
    """A heading that turns once, by `angle` radians over `over` seconds around `when`."""
    start = rng.uniform(-np.pi, np.pi)
    return start + angle * ease((times - when) / over + 0.5) + drift(rng, 0.03, 0.05, 0.2)(times)
