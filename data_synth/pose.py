"""The pose of a person in every frame, in anatomical terms: the input of `assemble`.

Angles are in radians. Legs are given by the position of the ankle and the rotation of the foot;
arms by the angles of shoulder and elbow or by a target position of the hand.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation


@dataclass(eq=False)
class Leg:
    """One leg over F frames.

    Parameters
    ----------
    ankle : (F, 3) array
        In the world, metres.
    foot : Rotation
        F rotations of the foot in the world.
    toes : (F,) array
        Toes bent up against the foot.
    splay : (F,) array
        The knee turned outwards from between pelvis and foot.
    """

    ankle: np.ndarray
    foot: Rotation
    toes: np.ndarray
    splay: np.ndarray


@dataclass(eq=False)
class Arm:
    """One arm over F frames; every field has shape (F,) except the goal.

    Parameters
    ----------
    flexion, abduction : shoulder: the upper arm forwards, and outwards, from hanging.
    turn : the upper arm turned about itself, inwards positive.
    elbow : bent, 0 when straight.
    pronation : the forearm turned, thumb inwards positive.
    wrist : bent towards the palm.
    raised, forwards : the collar bone.
    curl : the fingers.
    goal : (F, 3) array or None
        Where the wrist must be, in the world, metres.
    goal_weight : (F,) array
        0: the angles hold. 1: the goal holds.
    elbow_side : (3,) or (F, 3) array
        Where the elbow points while the goal holds, in the frame of the thorax.
    hand : Rotation or None
        How the hand is turned in the world while the goal holds.
    """

    flexion: np.ndarray
    abduction: np.ndarray
    turn: np.ndarray
    elbow: np.ndarray
    pronation: np.ndarray
    wrist: np.ndarray
    raised: np.ndarray
    forwards: np.ndarray
    curl: np.ndarray
    goal: np.ndarray | None = None
    goal_weight: np.ndarray | None = None
    elbow_side: np.ndarray | None = None
    hand: Rotation | None = None


@dataclass(eq=False)
class Pose:
    """A whole body over F frames.

    Parameters
    ----------
    place : (F, 3) array
        The root in the world, metres.
    pelvis : Rotation
        F rotations of the pelvis in the world.
    spine, neck : (F, 3) arrays
        Bent forwards, bent to the left, twisted to the left: the sums over their three joints.
    legs, arms : pairs, left first
    """

    place: np.ndarray
    pelvis: Rotation
    spine: np.ndarray
    neck: np.ndarray
    legs: tuple[Leg, Leg]
    arms: tuple[Arm, Arm]

    def __len__(self) -> int:
        return len(self.place)
