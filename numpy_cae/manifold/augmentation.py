"""Mirrored copies of takes, and damage like that of motion files, from which the starter learned.

Neither is in the paper, which learns from a larger database and only sets single values to zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.motion import JOINTS, PARENTS, joint_slice

OPPOSITE_SIDES = {"left": "right", "right": "left"}


def opposite_joint(joint: str) -> str:
    """The joint of the same name on the other side; "chest" and its like are their own."""
    return "_".join(OPPOSITE_SIDES.get(part, part) for part in joint.split("_"))


_OPPOSITES = [JOINTS.index(opposite_joint(joint)) for joint in JOINTS]


def mirror(positions: np.ndarray) -> np.ndarray:
    """World positions (F, 20, 3) with left and right exchanged."""
    return positions[:, _OPPOSITES] * [-1.0, 1.0, 1.0]


LIMBS = [("chest", "shoulder", "elbow", "wrist"), ("hips", "knee", "ankle", "toe")]
"""The joints of a limb after the joint of the trunk that it hangs from."""


def list_chains() -> tuple[tuple[int, ...], ...]:
    """The chains of joints that `FileDamage` damages, base first.

    A joint is given by the index c of its x in the features (y and z are c + 1 and c + 2). Every
    joint is a chain with its parent as base. Each limb gives four more chains, so that whole limbs
    are drawn often enough: one with the chest or the hips as base and one with the limb's first
    joint as base, each of them twice.
    """
    chains: list[tuple[str, ...]] = []
    for joint, parent in zip(JOINTS[1:], PARENTS[1:], strict=True):
        chains.append((JOINTS[parent], joint))
    for side in OPPOSITE_SIDES:
        for base, *joints in LIMBS:
            limb = tuple(f"{side}_{joint}" for joint in joints)
            chains += 2 * [(base, *limb), limb]
    in_features = []
    for chain in chains:
        in_features.append(tuple(joint_slice(joint).start for joint in chain))
    return tuple(in_features)


CHAINS = list_chains()
MAX_STRETCH_FRAMES = 80
"""A damaged stretch has at most this many frames."""


@dataclass(frozen=True)
class FileDamage:
    """The damage of motion files, as the `damage` of a `Stage` of training: stretches, and noise.

    Parameters
    ----------
    displacement : float
        d of `damage_stretch`, in normalised units.
    noise : float
        The largest standard deviation of the noise. A window's deviation is uniform between 0 and
        this, and each of its values gets normal noise of this deviation.

    Examples
    --------
    >>> from numpy_cae.training import Stage
    >>> stage = Stage(damage=FileDamage(displacement=0.3, noise=0.02))
    >>> stage.damage(np.zeros((4, 160, 63), np.float32), np.random.default_rng(0)).shape
    (4, 160, 63)
    """

    displacement: float
    noise: float

    def __call__(self, x: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """A damaged copy of normalised windows (B, T, 63)."""
        damaged = damage_stretches(x, CHAINS, self.displacement, rng)
        deviation = self.noise * rng.random((len(x), 1, 1), dtype=x.dtype)
        return damaged + deviation * rng.standard_normal(x.shape, dtype=x.dtype)


def damage_stretches(
    x: np.ndarray, chains: Sequence[Sequence[int]], displacement: float, rng: np.random.Generator
) -> np.ndarray:
    """A copy of windows (B, T, C) with up to three damaged stretches in each.

    A stretch has 1 to `MAX_STRETCH_FRAMES` frames and one chain, which `damage_stretch` damages.
    The length is log-uniform: 1 to 8 frames are as likely as 9 to 80.
    """
    damaged = x.copy()
    frames = x.shape[1]
    for window in damaged:
        for _ in range(rng.integers(4)):
            chain = chains[int(rng.integers(len(chains)))]
            length = min(int(MAX_STRETCH_FRAMES ** rng.random()), frames)
            start = int(rng.integers(frames - length + 1))
            damage_stretch(window, chain, slice(start, start + length), displacement, rng)
    return damaged


DAMAGES = ("zeroed", "frozen", "frozen relative to the base", "interpolated", "displaced")


def damage_stretch(
    x: np.ndarray,
    chain: Sequence[int],
    stretch: slice,
    displacement: float,
    rng: np.random.Generator,
) -> None:
    """Damage a stretch of frames of one window (T, C) in place, by one of `DAMAGES`.

    The base of the chain is not damaged. Where the chain is displaced, its last joint moves by
    d · 2u · n, where u ~ U(0, 1) and n is a vector of three standard normal numbers; joint k of K
    moves by k / K of that.
    """
    damage = DAMAGES[rng.integers(len(DAMAGES))]
    offset = displacement * rng.standard_normal(3) * rng.random() * 2
    before = max(stretch.start - 1, 0)
    after = min(stretch.stop, len(x) - 1)
    s = np.linspace(0, 1, stretch.stop - stretch.start + 2)[1:-1, None]
    base, *joints = chain
    at_base = x[:, base : base + 3]
    for number, joint in enumerate(joints, start=1):
        position = x[:, joint : joint + 3]  # a view
        if damage == "zeroed":
            position[stretch] = 0
        elif damage == "frozen":
            position[stretch] = position[before]
        elif damage == "frozen relative to the base":
            position[stretch] = at_base[stretch] + (position[before] - at_base[before])
        elif damage == "interpolated":
            position[stretch] = (1 - s) * position[before] + s * position[after]
        else:
            position[stretch] += (offset * number / len(joints)).astype(x.dtype)
