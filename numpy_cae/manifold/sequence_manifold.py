"""A trained sequential autoencoder with the standardisation of its clips (jang2018)."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from numpy_cae.array_file import save_arrays
from numpy_cae.manifold.model_arrays import (
    MAX_FRAMES,
    MAX_LENGTH,
    SMALLEST,
    read_integer,
    read_numbers,
    require_loadable,
)
from numpy_cae.models.sequential_autoencoder import SequentialAutoencoder, weight_shapes
from numpy_cae.motion import CLIP, Motion, angles, draw_clips

FORMAT = "numpy_cae sequential manifold 4"
"""The only format that is read; a file of another version has to be made again."""
MIN_LENGTH = 0.15
"""Only bones longer than this (m) are compared by MAX_ANGLE."""
MAX_ANGLE = 30.0
"""Rigs differ if a bone points more than this (degrees) away from the mean."""


@dataclass(eq=False)
class SequenceManifold:
    """A network, and the conversion between motions and its standardised clips.

    Parameters
    ----------
    network : SequentialAutoencoder
        Plain or accelerated; everything is computed with it.
    mean, deviation : (54,) arrays of float64
        Mean and standard deviation of each column over all frames of all clips. The deviation of a
        constant column is 1: MBR17 drops such columns, but with them one table serves every rig.
    table : angles.AngleTable
    offsets : (J, 3) array of float64
        Bones for drawing, metres; see `AngleSequence`.
    settings : dict
        Provenance as JSON values; nothing is computed from it.
    rate, frames
        Frames a second, and frames of the clips that the network was trained on.

    Examples
    --------
    A network that has hardly learned, and a motion of two seconds that it draws:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import learn_sequences
    >>> from numpy_cae.mocap import angles_of
    >>> from numpy_cae.training import SequenceSchedule
    >>> sequences = [angles_of(make_take("walk", 0, seconds=4.0, rate=50.0).motion)]
    >>> schedule = SequenceSchedule(epochs=1, steps=1, batch=4, directions=4)
    >>> manifold = learn_sequences(sequences, schedule, hidden=6, latent=3)
    >>> manifold.sample(1, np.random.default_rng(0))
    [motion of 50 frames at 25 a second, 21 joints]
    """

    network: SequentialAutoencoder
    mean: np.ndarray
    deviation: np.ndarray
    table: angles.AngleTable
    offsets: np.ndarray
    settings: dict = field(default_factory=dict)
    rate: float = angles.ANGLE_RATE
    frames: int = CLIP

    def normalise(self, clips: np.ndarray) -> np.ndarray:
        """Clips (…, 54) with each column standardised, in the dtype of the network."""
        dtype = self.network.weights["frame_w"].dtype
        return ((clips - self.mean) / self.deviation).astype(dtype)

    def denormalise(self, x: np.ndarray) -> np.ndarray:
        """The inverse of `normalise`, in float64."""
        return x.astype(np.float64) * self.deviation + self.mean

    def random_clips(
        self, sequences: Sequence[angles.AngleSequence], rng: np.random.Generator, count: int
    ) -> np.ndarray:
        """Normalised clips (count, frames, 54) of motions; every first frame is equally likely."""
        return self.normalise(draw_clips(sequences, count, rng, self.frames))

    def motion(self, clip: np.ndarray) -> Motion:
        """A normalised clip (F, 54) as a motion that stands on the floor."""
        return angles.on_floor(angles.motion_of(self.denormalise(clip), self.table, self.offsets))

    def sample(self, count: int, rng: np.random.Generator) -> list[Motion]:
        """New motions of a clip's length, decoded from draws of the prior."""
        return [self.motion(clip) for clip in self.network.sample(count, rng, self.frames)]

    def save(self, path: str | Path) -> None:
        """Write the manifold, completely or not at all; `load_manifold` reads it.

        Raises FileError if the file cannot be written, ModelFileError if it could not be loaded.
        """
        arrays = {
            "format": np.array(FORMAT),
            "table": np.array(self.table.name),
            "columns": np.array(self.table.columns),
            "mean": self.mean,
            "deviation": self.deviation,
            "offsets": self.offsets,
            "rate": np.array(self.rate),
            "frames": np.array(self.frames),
            "burn_in": np.array(self.network.burn_in),
            "settings": np.array(json.dumps(self.settings)),
        }
        require_loadable(SequenceManifold.from_arrays, arrays | self.network.weights, path)
        save_arrays(arrays | self.network.weights, path)

    @staticmethod
    def from_arrays(arrays: dict[str, np.ndarray]) -> "SequenceManifold":
        """The manifold of a model file's arrays; ValueError or KeyError where they do not fit."""
        table = angles.TABLES.get(str(arrays["table"]))
        if table is None or not np.array_equal(arrays["columns"], table.columns):
            raise ValueError("its table of columns is not one of this version")
        columns = len(table.columns)
        latent, hidden = arrays["state_w"].shape
        network = SequentialAutoencoder(columns, hidden=1, latent=1)
        network.burn_in = read_integer(arrays, "burn_in", 0, MAX_FRAMES)
        for name, shape in weight_shapes(columns, hidden, latent).items():
            network.weights[name] = read_numbers(arrays, name, shape).astype(np.float32)
        bones = (len(table.joints), 3)
        return SequenceManifold(
            network,
            read_numbers(arrays, "mean", (columns,)),
            read_numbers(arrays, "deviation", (columns,), SMALLEST),
            table,
            read_numbers(arrays, "offsets", bones, -MAX_LENGTH, MAX_LENGTH),
            frames=read_integer(arrays, "frames", 1, MAX_FRAMES),
        )


def common_bones(sequences: Sequence[angles.AngleSequence]) -> tuple[angles.AngleTable, np.ndarray]:
    """The table and the mean bones of motions that are learned together; ValueError if their rigs
    differ, since the same angles would be other poses."""
    table = sequences[0].table
    if any(sequence.table.name != table.name for sequence in sequences):
        raise ValueError("Human3.6M's own text and other motions have different columns: not both")
    bones = np.stack([sequence.offsets for sequence in sequences])
    mean = bones.mean(axis=0)
    # Lengths of bones differ between people; directions at rest differ between rigs.
    mean_lengths = np.linalg.norm(mean, axis=-1)
    along = np.sum(bones * mean, axis=-1)
    products = np.linalg.norm(bones, axis=-1) * mean_lengths
    differ = (along < np.cos(np.radians(MAX_ANGLE)) * products) & (mean_lengths > MIN_LENGTH)
    if differ.any():
        joint = table.joints[int(np.argwhere(differ)[0][1])]
        raise ValueError(
            f"the motions have different rigs: at rest the bone to {joint} points elsewhere in "
            "some of them, so that their angles mean different poses; learn one rig at a time"
        )
    return table, mean
