"""A take: a motion with everything that is known about it, since it was made by formula."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from data_synth.body import Body
from numpy_cae.motion import Motion


@dataclass(frozen=True)
class Take:
    """One synthetic recording and its truth.

    Parameters
    ----------
    motion : Motion
    kind, style : str
        What the person does, and in which manner.
    body : Body
        Who does it.
    contacts : (F, 2) array of bool
        Left and right: the ball of that foot (joints ``ltoes``, ``rtoes``) stands still on the
        floor; in a walk from foot flat to toe off. While it holds, the joint stays within 5 mm.
    path : (F, 2) array
        The x and z that the pelvis was asked to follow, metres; it sways about it.
    heading : (F,) array
        The direction that the pelvis was asked to face about Y, radians, 0 facing +Z and growing
        towards +X; it turns to and fro about it.
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
