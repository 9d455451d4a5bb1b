"""A take: a synthetic motion with its labels and ground truth."""

from dataclasses import dataclass

import numpy as np

from data_synth.body import Body
from numpy_cae.motion import Motion


@dataclass(frozen=True, eq=False)
class Take:
    """One synthetic recording and its ground truth.

    Parameters
    ----------
    motion : Motion
    kind, style : str
        The action and its manner.
    body : Body
        The person.
    contacts : (F, 2) array of bool
        Left and right: the ball of that foot (joints ``ltoes``, ``rtoes``) stands still on the
        floor; in a walk from foot flat to toe off. While it holds, the joint stays within 5 mm.
    path : (F, 2) array
        The target x and z of the pelvis, metres; the pelvis sways about it.
    heading : (F,) array
        The target heading of the pelvis about Y, radians, 0 facing +Z and growing towards +X;
        the pelvis rotates about it during a step.
    """

    motion: Motion
    kind: str
    style: str
    body: Body
    contacts: np.ndarray
    path: np.ndarray
    heading: np.ndarray

    @property
    def stature(self) -> float:
        """The person's height in metres."""
        return self.body.stature
