"""A person's body: bones with the names of the CMU database, in random proportions.

The fractions of stature are those of Drillis & Contini (1966) as drawn in Winter, *Biomechanics
and Motor Control of Human Movement* (4th ed., 2009), figure 4.1. The tree of bones is that of the
CMU database's Acclaim skeletons, and so is the split of the trunk, the neck and the forearm into
several bones. The rest pose is a T: standing straight, facing +Z, arms along ±X, left being +X.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from numpy_cae.motion import Skeleton

SIDES = ("l", "r")
LEFT = 0
RIGHT = 1
# +1 where a left limb points along +X in the rest pose, -1 for its mirror image.
SIGN = (1.0, -1.0)

# joint, parent, and the vector from the parent's joint to this one, as fractions of stature, for
# the left side and the middle. A joint is where its bone begins, as in the CMU database in BVH.
_MIDDLE = [
    ("lowerback", "root", (0.0, 0.0, 0.0)),
    ("upperback", "lowerback", (0.0, 0.070, -0.003)),
    ("thorax", "upperback", (0.0, 0.070, 0.0)),
    ("lowerneck", "thorax", (0.0, 0.070, 0.0)),
    ("upperneck", "lowerneck", (0.0, 0.048, 0.006)),
    ("head", "upperneck", (0.0, 0.048, 0.0)),
]
_LEG = [
    ("hipjoint", "root", (0.0, 0.0, 0.0)),
    ("femur", "hipjoint", (0.053, -0.055, 0.014)),
    ("tibia", "femur", (0.0, -0.245, 0.0)),
    ("foot", "tibia", (0.0, -0.246, 0.0)),
    ("toes", "foot", (0.0, -0.026, 0.075)),
]
_ARM = [
    ("clavicle", "thorax", (0.0, 0.070, 0.0)),
    ("humerus", "clavicle", (0.112, 0.023, -0.012)),
    ("radius", "humerus", (0.186, 0.0, 0.0)),
    ("wrist", "radius", (0.097, 0.0, 0.0)),
    ("hand", "wrist", (0.049, 0.0, 0.0)),
    ("fingers", "hand", (0.050, 0.0, 0.0)),
    ("thumb", "wrist", (0.049, 0.0, 0.0)),
]
_TIPS = {
    "head": (0.0, 0.082, 0.0),
    "toes": (0.0, -0.003, 0.039),
    "fingers": (0.050, 0.0, 0.0),
    "thumb": (0.030, 0.0, 0.030),
}
_ANKLE_HEIGHT = 0.039
_HEEL_BEHIND = 0.038

# The order of the bones in the CMU database's .asf files.
_ORDER = (
    [f"l{bone}" for bone, *_ in _LEG]
    + [f"r{bone}" for bone, *_ in _LEG]
    + [bone for bone, *_ in _MIDDLE]
    + [f"l{bone}" for bone, *_ in _ARM]
    + [f"r{bone}" for bone, *_ in _ARM]
)
NAMES = ("root", *_ORDER)


@dataclass(frozen=True)
class Body:
    """One person.

    Parameters
    ----------
    skeleton : Skeleton
        31 joints in metres, in the T-pose, the root at the origin.
    stature : float
        Height of the standing person in metres.
    """

    skeleton: Skeleton
    stature: float

    def offset(self, name: str) -> np.ndarray:
        """From the parent's joint to this one in the rest pose, (3,), in metres."""
        return self.skeleton.offsets[self.skeleton.index(name)]

    @cached_property
    def thigh(self) -> float:
        """Hip to knee, in metres."""
        return float(np.linalg.norm(self.offset("ltibia")))

    @cached_property
    def shank(self) -> float:
        """Knee to ankle, in metres."""
        return float(np.linalg.norm(self.offset("lfoot")))

    @property
    def leg(self) -> float:
        """Hip to ankle of the straight leg, in metres."""
        return self.thigh + self.shank

    @cached_property
    def upper_arm(self) -> float:
        """Shoulder to elbow, in metres."""
        return float(np.linalg.norm(self.offset("lradius")))

    @cached_property
    def forearm(self) -> float:
        """Elbow to the wrist joint (`lhand` in the CMU tree), in metres."""
        return float(np.linalg.norm(self.offset("lwrist") + self.offset("lhand")))

    @property
    def arm(self) -> float:
        """Shoulder to wrist of the straight arm, in metres."""
        return self.upper_arm + self.forearm

    @property
    def ankle_height(self) -> float:
        """Height of the ankle above the floor while the foot stands flat, in metres."""
        return _ANKLE_HEIGHT * self.stature

    @property
    def heel(self) -> np.ndarray:
        """From the ankle to the heel's point on the floor, (3,), in the frame of the foot."""
        return np.array([0.0, -self.ankle_height, -_HEEL_BEHIND * self.stature])

    @property
    def ball(self) -> np.ndarray:
        """From the ankle to the ball of the foot (joint `ltoes`), (3,), in the foot's frame."""
        return self.offset("ltoes")

    @property
    def ball_sole(self) -> np.ndarray:
        """From the ankle to the sole under the ball, (3,), in the frame of the foot."""
        return self.ball * [0, 0, 1] - [0, self.ankle_height, 0]

    @property
    def toe_tip(self) -> np.ndarray:
        """From the ankle to the sole under the tip of straight toes, (3,), in the foot's frame."""
        tip = self.ball + self.skeleton.end_sites[self.skeleton.index("ltoes")]
        return tip * [0, 0, 1] - [0, self.ankle_height, 0]

    @property
    def hip_width(self) -> float:
        """The distance between the two hip joints, in metres."""
        return 2 * abs(float(self.offset("lfemur")[0]))

    @property
    def standing(self) -> float:
        """Height of the root while the person stands on straight legs, in metres."""
        return self.ankle_height + self.leg - float(self.offset("lfemur")[1])

    def hip(self, side: int) -> np.ndarray:
        """From the root to the hip joint, (3,), in the frame of the pelvis."""
        return self.offset(f"{SIDES[side]}femur")


def draw_body(rng: np.random.Generator) -> Body:
    """A person of random stature and limb lengths.

    Parameters
    ----------
    rng : numpy.random.Generator

    Returns
    -------
    Body

    Notes
    -----
    Adult stature has a standard deviation near 7 cm around 1.76 m for men and 1.63 m for women
    (NCD-RisC, 2016, western Europe: 1.77 and 1.64). Limb ratios vary by 2 to 3 per cent.
    """
    woman = rng.random() < 0.5
    stature = float(np.clip(rng.normal(1.64 if woman else 1.77, 0.065), 1.48, 1.98))
    spread = {limb: float(np.clip(rng.normal(1.0, 0.02), 0.95, 1.05)) for limb in "tlaf"}
    spread["shoulders"] = float(np.clip(rng.normal(0.95 if woman else 1.02, 0.03), 0.88, 1.1))
    spread["hips"] = float(np.clip(rng.normal(1.04 if woman else 0.99, 0.03), 0.92, 1.12))
    return make_body(stature, spread)


def make_body(stature: float = 1.75, spread: dict[str, float] | None = None) -> Body:
    """The body of a given stature.

    Parameters
    ----------
    stature : float
        In metres.
    spread : dict, optional
        Factors of the average lengths: ``t`` trunk, ``l`` legs, ``a`` arms, ``f`` feet,
        ``shoulders`` and ``hips`` (their widths).

    Raises
    ------
    ValueError
        If the stature is not positive.
    """
    if not stature > 0:
        raise ValueError(f"stature is {stature}, expected metres above 0")
    spread = {"t": 1.0, "l": 1.0, "a": 1.0, "f": 1.0, "shoulders": 1.0, "hips": 1.0} | (
        spread or {}
    )
    way = {"root": np.zeros(3)}
    parent: dict[str, str | None] = {"root": None}
    tips = {}
    for name, above, fraction in _MIDDLE:
        way[name], parent[name] = np.array(fraction) * spread["t"], above
    for side, sign in zip(SIDES, SIGN, strict=True):
        mirror = np.array([sign, 1.0, 1.0])
        for chain, length in ((_LEG, spread["l"]), (_ARM, spread["a"])):
            bones = {bone for bone, *_ in chain}
            for bone, above, fraction in chain:
                stretch = np.ones(3)
                if bone in ("tibia", "foot") or chain is _ARM:
                    stretch *= length
                if bone == "toes":
                    stretch[2] = spread["f"]
                if bone == "femur":
                    stretch[0] = spread["hips"]
                if bone == "humerus":
                    stretch[:] = spread["shoulders"], 1.0, 1.0
                if bone == "clavicle":
                    stretch[:] = spread["t"]
                way[side + bone] = np.array(fraction) * stretch * mirror
                parent[side + bone] = side + above if above in bones else above
        for bone in ("toes", "fingers", "thumb"):
            tips[side + bone] = np.array(_TIPS[bone]) * mirror
    tips["head"] = np.array(_TIPS["head"])
    skeleton = Skeleton(
        names=NAMES,
        parents=(-1, *(NAMES.index(parent[name]) for name in NAMES[1:])),
        offsets=np.array([way[name] for name in NAMES]) * stature,
        end_sites={NAMES.index(name): tip * stature for name, tip in tips.items()},
    )
    return Body(skeleton, stature)
