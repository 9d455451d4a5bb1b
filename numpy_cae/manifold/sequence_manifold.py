"""A trained sequential autoencoder together with what it was taught to see (jang2018).

The network knows standardised clips. What turns a motion into those and back (mean and deviation
of each of the 54 numbers, their table, bones to draw with) belongs to it and is kept with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.models import SequentialAutoencoder
from numpy_cae.motion import ANGLE_RATE, AngleSequence, AngleTable, Motion, draw_clips
from numpy_cae.motion.angles import motion_of, on_floor

CONSTANT = 1e-3
"""A number that varies less (metres, radians) is constant: it is only centred. MBR17 drops such
columns; here they stay, as zeros, so that one table does for every rig."""


@dataclass
class SequenceManifold:
    """The manifold of clips.

    Parameters
    ----------
    network : SequentialAutoencoder
    mean, deviation : (54,) arrays of float64
        Of each number over all frames of all clips.
    table : AngleTable
    offsets : (J, 3) array of float64
        Bones to draw with, metres; see `AngleSequence`.
    settings : dict
        How it was made, as far as JSON can say.
    """

    network: SequentialAutoencoder
    mean: np.ndarray
    deviation: np.ndarray
    table: AngleTable
    offsets: np.ndarray
    settings: dict = field(default_factory=dict)
    rate: float = ANGLE_RATE

    def normalise(self, clips: np.ndarray) -> np.ndarray:
        """Each number standardised, in the dtype of the network; any shape (…, 54)."""
        dtype = self.network.weights["frame_w"].dtype
        return ((clips - self.mean) / self.deviation).astype(dtype)

    def denormalise(self, x: np.ndarray) -> np.ndarray:
        """The numbers that `normalise` makes x of, float64."""
        return x.astype(np.float64) * self.deviation + self.mean

    def drawing_from(self, sequences: Sequence[AngleSequence], frames: int):
        """A function (rng, batch) -> normalised clips (batch, frames, 54), others at every call."""

        def draw(rng: np.random.Generator, batch: int) -> np.ndarray:
            return self.normalise(draw_clips(sequences, batch, rng, frames))

        return draw

    def motion(self, clip: np.ndarray) -> Motion:
        """A clip of the network, (F, 54), as a motion that stands on the floor."""
        return on_floor(motion_of(self.denormalise(clip), self.table, self.offsets))


def standardisation(clips: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and deviation (54,) of clips (N, F, 54); the deviation of what is constant is 1."""
    deviation = clips.std(axis=(0, 1))
    return clips.mean(axis=(0, 1)), np.where(deviation < CONSTANT, 1.0, deviation)


def common_bones(sequences: Sequence[AngleSequence]) -> tuple[AngleTable, np.ndarray]:
    """The table and the mean bones of motions that are learned together.

    Raises
    ------
    ValueError
        If their rigs differ: the same angles would be other poses.
    """
    table = sequences[0].table
    if any(sequence.table is not table for sequence in sequences):
        raise ValueError("Human3.6M's own text and other motions have different numbers: not both")
    bones = np.stack([sequence.offsets for sequence in sequences])
    mean = bones.mean(axis=0)
    # People differ in the length of their bones; rigs differ in where these point at rest.
    along = np.sum(bones * mean, axis=-1)
    lengths = np.linalg.norm(bones, axis=-1) * np.linalg.norm(mean, axis=-1)
    long = np.linalg.norm(mean, axis=-1) > LONG
    bent = (along < np.cos(np.radians(DIFFERENT)) * lengths) & long
    if bent.any():
        joint = table.joints[int(np.argwhere(bent)[0][1])]
        raise ValueError(
            f"the motions have different rigs: at rest the bone to {joint} points elsewhere in "
            "some of them, so that their angles mean different poses; learn one rig at a time"
        )
    return table, mean


LONG, DIFFERENT = 0.15, 30.0
"""Metres and degrees: shorter bones than that may point anywhere in an arm that is at rest."""
