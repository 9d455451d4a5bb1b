"""A model of motion capture with a Kinect, with the ground truth and the kind of each error.

One depth camera stands in front of the person. The model uses these published figures:

- The random error of depth grows with its square, from a few millimetres near by to 4 cm at 5 m
  (Khoshelham & Elberink, *Sensors* 12 (2012) 1437): σ = 0.0016 Z² metres.
- Joints of the skeleton lie 5 to 10 cm from those of optical motion capture, and bones change
  their length while a person moves (Wang, Kurillo, Ofli & Bajcsy, *Evaluation of Pose Tracking
  Accuracy in the First and Second Generations of Microsoft Kinect*, 2015, arXiv:1512.04134).
  They describe the errors as a Gaussian with outliers, most of them from joints that the body
  itself hides and the tracker guesses.
- Seen from the side or with arms close together, left and right get mixed up for a few frames (a
  known issue in the notes of the OpenNI and Kinect trackers).
- The sensor estimates the floor continuously and with a delay, so the whole person rises and
  sinks.

The publications describe swapped limbs, guesses and the floor's delay without rates; the constants
below are our choice.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import label
from scipy.signal import lfilter

from data_synth.curves import drift
from data_synth.damage import Damaged, Rng

DEPTH_NOISE = 0.0016
"""σ of depth over squared distance, 1/m."""
FARTHEST = 5.0
"""Metres. No figure is published beyond; noise there is as here."""
SIDEWAYS_SHARE = 0.35
"""Noise across the line of sight, as a share of that along it."""
JOINT_BIAS = 0.03
"""σ of a joint's constant offset along each axis, m: 5 cm in space."""
BREATHING = 0.05
"""σ of the slow change of a bone's length, as a share of it."""
GUESS = 0.07
"""σ of how far a hidden joint's guess misses along each axis, m: 12 cm in space."""
LIMB_RADIUS = 0.055
"""Of the limb that hides a joint behind it, m."""
SWAPS_A_SECOND = (0.05, 0.5)
"""Facing the sensor, and side-on."""
FLOOR = 0.015
"""σ of the steps of the floor's height, m; one every two seconds."""
FLOOR_LAG = 0.6
"""Time constant of the floor estimate, seconds."""


@dataclass(frozen=True)
class Seen(Damaged):
    """The output of the sensor; `known` is False for hidden joints.

    Parameters
    ----------
    sensor : (3,) array
        Its position in the world, metres.
    hidden : (F, J) array of bool
    swapped : (F,) array of bool
        Left and right were exchanged.
    floor : (F,) array
        Error of the height of the whole person, metres.
    """

    sensor: np.ndarray
    hidden: np.ndarray
    swapped: np.ndarray
    floor: np.ndarray


def see_with_kinect(
    positions: np.ndarray,
    names: Sequence[str],
    parents: Sequence[int],
    rate: float,
    rng: Rng,
    distance: float = 2.6,
) -> Seen:
    """A motion as captured by a Kinect.

    Parameters
    ----------
    positions : (F, J, 3) array of float
        World positions in metres, Y up, floor at 0.
    names : sequence of J str
        The prefixes "left_" or "l" and "right_" or "r" mark the sides.
    parents : sequence of J int
        -1 for the root.
    rate : float
        Frames a second.
    rng : int or numpy.random.Generator
    distance : float
        Of the sensor from the middle of the path, metres; it works from 0.8 to 4 m.

    Returns
    -------
    Seen

    Raises
    ------
    ValueError
        If the shapes do not fit together, or the distance is not above 0.
    """
    frames, joints = positions.shape[:2]
    if positions.ndim != 3 or positions.shape[2] != 3 or not len(names) == len(parents) == joints:
        raise ValueError(
            f"positions have shape {positions.shape}, expected (frames, joints, 3) with "
            f"{len(names)} names and {len(parents)} parents"
        )
    if not distance > 0:
        raise ValueError(f"distance is {distance}, expected metres above 0")
    rng = np.random.default_rng(rng)
    mirror = mirrored(names)
    across = _across(positions, mirror)
    sensor = _place_sensor(positions, across, distance, rng)
    hidden = _hidden(positions, parents, sensor)
    seen = _breathe(positions, parents, rate, rng)
    seen = seen + JOINT_BIAS * rng.normal(size=(joints, 3))
    seen += _guesses(hidden, rng)
    swapped = _swaps(positions, across, sensor, rate, rng)
    seen[swapped] = seen[swapped][:, mirror]
    seen += _jitter(positions, sensor, rng)
    floor = _floor(frames, rate, rng)
    seen[..., 1] += floor[:, None]
    known = np.repeat(~hidden[..., None], 3, axis=2)
    return Seen(seen, positions.copy(), known, sensor, hidden, swapped, floor)


def mirrored(names: Sequence[str]) -> np.ndarray:
    """For each joint the joint of the other side, or itself in the middle, (J,) int."""
    names = list(names)
    other = {"left_": "right_", "right_": "left_", "Left": "Right", "Right": "Left",
             "l": "r", "r": "l"}  # fmt: skip
    found = []
    for joint, name in enumerate(names):
        twins = (other[start] + name[len(start) :] for start in other if name.startswith(start))
        found.append(next((names.index(twin) for twin in twins if twin in names), joint))
    return np.array(found)


def _across(positions: np.ndarray, mirror: np.ndarray) -> np.ndarray:
    """From the right side of the body to the left, level, (F, 3) unit vectors."""
    left = [joint for joint, twin in enumerate(mirror) if joint < twin]
    way = (positions[:, left] - positions[:, mirror[left]]).mean(axis=1) * [1.0, 0.0, 1.0]
    return way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-9)


def _place_sensor(positions, across, distance, rng) -> np.ndarray:
    """In front of the person as they face in the middle of the clip, a metre above the floor."""
    left = across[len(across) // 2]
    ahead = np.array([-left[2], 0.0, left[0]])
    angle = rng.normal(0, np.radians(20))
    ahead = np.cos(angle) * ahead + np.sin(angle) * left
    sensor = positions[:, 0].mean(axis=0) + distance * ahead
    sensor[1] = 1.0
    return sensor


def _hidden(positions: np.ndarray, parents: Sequence[int], sensor: np.ndarray) -> np.ndarray:
    """Whether a bone that the joint is no end of passes before it, (F, J) bool."""
    rays = positions - sensor
    depth = np.linalg.norm(rays, axis=-1)
    sight = rays / depth[..., None]
    hidden = np.zeros(positions.shape[:2], dtype=bool)
    bones = [(child, parent) for child, parent in enumerate(parents) if parent >= 0]
    for child, parent in bones:
        others = [j for j in range(len(parents)) if j not in (child, parent)
                  and parents[j] not in (child, parent) and parents[parent] != j]  # fmt: skip
        for share in (0.2, 0.5, 0.8):
            point = (1 - share) * positions[:, parent] + share * positions[:, child] - sensor
            along = np.einsum("fjc,fc->fj", sight[:, others], point)
            beside = np.linalg.norm(point[:, None] - along[..., None] * sight[:, others], axis=-1)
            before = along < depth[:, others] - 0.10
            hidden[:, others] |= (beside < LIMB_RADIUS) & before
    return hidden


def _breathe(positions, parents, rate, rng) -> np.ndarray:
    """Change every bone's length slowly; its descendants move along."""
    t = np.arange(len(positions)) / rate
    seen = positions.copy()
    for joint, parent in enumerate(parents):
        if parent >= 0:
            stretch = 1 + BREATHING * drift(rng, 1.0, 0.1, 1.0)(t)
            bone = positions[:, joint] - positions[:, parent]
            seen[:, joint] = seen[:, parent] + stretch[:, None] * bone
    return seen


def _guesses(hidden: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A constant error for each interval in which a joint is hidden."""
    off = np.zeros((*hidden.shape, 3))
    for joint in range(hidden.shape[1]):
        runs, count = label(hidden[:, joint])
        misses = np.concatenate([np.zeros((1, 3)), GUESS * rng.normal(size=(count, 3))])
        off[:, joint] = misses[runs]
    return off


def _swaps(positions, across, sensor, rate, rng) -> np.ndarray:
    """A few frames at a time, (F,) bool; more often where the person stands side-on."""
    sight = (positions[:, 0] - sensor) * [1.0, 0.0, 1.0]
    sight /= np.linalg.norm(sight, axis=-1, keepdims=True)
    side_on = np.abs(np.sum(sight * across, axis=-1)) ** 3
    low, high = SWAPS_A_SECOND
    starts = rng.random(len(positions)) < (low + (high - low) * side_on) / rate
    swapped = np.zeros(len(positions), dtype=bool)
    for start in np.flatnonzero(starts):
        swapped[start : start + max(1, round(rng.uniform(0.06, 0.25) * rate))] = True
    return swapped


def _jitter(positions: np.ndarray, sensor: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    rays = positions - sensor
    depth = np.linalg.norm(rays, axis=-1, keepdims=True)
    sight = rays / depth
    noise = rng.normal(size=positions.shape)
    along = np.sum(noise * sight, axis=-1, keepdims=True) * sight
    sigma = DEPTH_NOISE * np.minimum(depth, FARTHEST) ** 2
    return sigma * (along + SIDEWAYS_SHARE * (noise - along))


def _floor(frames: int, rate: float, rng: np.random.Generator) -> np.ndarray:
    """Steps of the estimated floor that the sensor follows late: a first-order lag."""
    steps = np.cumsum(FLOOR * rng.normal(size=frames) * (rng.random(frames) < 0.5 / rate))
    decay = np.exp(-1 / (rate * FLOOR_LAG))
    start = FLOOR * rng.normal()
    return start + lfilter([1 - decay], [1, -decay], steps)
