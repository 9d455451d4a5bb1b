"""The manner of a gait: the parameters of a confident, old or tired walk and of a run.

Speeds and cadences are for a stature of 1.75 m; they scale with the Froude number v²/(g·leg), at
which gaits of people of different size are similar (Alexander, *J. Zool.* 1984).
"""

from dataclasses import dataclass, fields, replace

import numpy as np

from data_synth.gait_curves import RUN, WALK, LegCurves

_DEGREE = np.pi / 180


@dataclass(frozen=True)
class Manner:
    """The manner of a gait. Angles in degrees, lengths in metres.

    Parameters
    ----------
    speed : float
        Metres a second.
    cadence : float
        Steps a minute.
    arm_swing : float
        The shoulder's amplitude, half of its range: about 16° at one's own speed (Murray et al.,
        1967, *Am. J. Phys. Med.* 46:290).
    arm_rest, arm_out : float
        The shoulder's mean flexion and abduction.
    elbow, elbow_swing : float
        The elbow's mean bend and amplitude.
    lean : float
        The trunk forwards from the vertical.
    stoop : float
        The spine's extra bend, which the neck undoes.
    pelvis_turn, pelvis_drop, chest_turn : float
        Amplitudes of the pelvis about the vertical (4°) and about the way ahead (4°), and of the
        chest against it (5°); Perry (1992), chapter 6.
    sway : float
        The pelvis to the side of the standing leg.
    width, toe_out : float
        Between the lines of the two feet, and each foot turned outwards (7°).
    crouch : float
        Extra bend of the knees.
    roll : float
        How much the foot rolls: 1 heel to toe, 0 a shuffle.
    clearance : float
        Of the sole above the floor in mid-swing, at least.
    bob : float
        Amplitude of the pelvis up and down, as a share of what the legs' angles imply.
    gaze : float
        The head bent down.
    curves : LegCurves
    """

    speed: float = 1.30
    cadence: float = 112.0
    arm_swing: float = 16.0
    arm_rest: float = -2.0
    arm_out: float = 8.0
    elbow: float = 24.0
    elbow_swing: float = 10.0
    lean: float = 3.0
    stoop: float = 4.0
    pelvis_turn: float = 4.5
    pelvis_drop: float = 4.0
    chest_turn: float = 5.0
    sway: float = 0.020
    width: float = 0.11
    toe_out: float = 7.0
    crouch: float = 2.0
    roll: float = 1.0
    clearance: float = 0.015
    bob: float = 1.15
    gaze: float = 4.0
    curves: LegCurves = WALK


MANNERS = {
    "neutral": Manner(),
    "confident": Manner(
        speed=1.47, cadence=117, arm_swing=24, arm_out=11, elbow=22, elbow_swing=14, lean=0,
        stoop=-3, pelvis_turn=6, chest_turn=8, sway=0.024, width=0.12, toe_out=10, gaze=-2,
    ),
    "old": Manner(
        speed=0.68, cadence=96, arm_swing=6, arm_rest=14, arm_out=10, elbow=48, elbow_swing=4,
        lean=12, stoop=26, pelvis_turn=3, pelvis_drop=2, chest_turn=2, sway=0.030, width=0.16,
        toe_out=11, crouch=13, roll=0.75, clearance=0.010, gaze=14,
    ),
    "tired": Manner(
        speed=1.0, cadence=98, arm_swing=9, arm_rest=3, elbow=16, elbow_swing=5, lean=7, stoop=14,
        pelvis_turn=4, chest_turn=3, sway=0.030, width=0.13, crouch=5, roll=0.85, gaze=18,
    ),
    "brisk": Manner(
        speed=1.65, cadence=131, arm_swing=26, elbow=45, elbow_swing=16, lean=5, pelvis_turn=7,
        chest_turn=8, width=0.09,
    ),
    "run": Manner(
        speed=3.0, cadence=164, arm_swing=30, arm_rest=-8, arm_out=14, elbow=88, elbow_swing=13,
        lean=9, stoop=2, pelvis_turn=7, pelvis_drop=4, chest_turn=11, sway=0.008, width=0.05,
        toe_out=5, crouch=0, gaze=2, curves=RUN, clearance=0.02, bob=1.9,
    ),
}  # fmt: skip

# How far takes differ: a share of the value, or an amount where the value may be 0.
_SHARES = {"cadence": 0.04, "speed": 0.045, "arm_swing": 0.22, "elbow": 0.12, "elbow_swing": 0.25,
           "pelvis_turn": 0.2, "pelvis_drop": 0.2, "chest_turn": 0.2, "sway": 0.2, "width": 0.15,
           "bob": 0.08, "roll": 0.04}  # fmt: skip
_AMOUNTS = {"arm_rest": 3, "arm_out": 2.5, "lean": 2, "stoop": 3, "toe_out": 2.5, "gaze": 4}


def draw_manner(rng: np.random.Generator, style: str) -> Manner:
    """A person's own variant of a style.

    Raises
    ------
    KeyError
        If no such style is known.
    """
    manner = MANNERS[style]
    changed = {}
    for name, share in _SHARES.items():
        changed[name] = getattr(manner, name) * float(np.exp(share * _bounded(rng)))
    for name, amount in _AMOUNTS.items():
        changed[name] = getattr(manner, name) + float(amount * _bounded(rng))
    # Who steps faster goes faster; the length of the step is drawn apart from it.
    changed["speed"] *= changed["cadence"] / manner.cadence
    changed["roll"] = min(changed["roll"], 1.0)
    return replace(manner, **changed)


def _bounded(rng: np.random.Generator) -> float:
    return np.clip(rng.normal(), -2.0, 2.0)


def in_radians(manner: Manner) -> Manner:
    """The same manner with every angle in radians."""
    angles = {"arm_swing", "arm_rest", "arm_out", "elbow", "elbow_swing", "lean", "stoop",
              "pelvis_turn", "pelvis_drop", "chest_turn", "toe_out", "crouch", "gaze"}  # fmt: skip
    assert angles <= {f.name for f in fields(Manner)}
    return replace(manner, **{name: getattr(manner, name) * _DEGREE for name in angles})
