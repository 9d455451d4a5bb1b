"""Training of both networks, holden2015's and jang2018's.

Read `layerwise` and `sequential` first: the training of each network is one function, with its
loops over stages, epochs and batches, and a function for one step. After each step `state` says
where the training stands, a `report` function is given this state, and a `Checkpoint` saves it.
"""

from numpy_cae.training.checkpoint import Checkpoint, CheckpointError
from numpy_cae.training.corruption import zero_values
from numpy_cae.training.divergence import DivergedError
from numpy_cae.training.layerwise import train_autoencoder
from numpy_cae.training.optimisers import Adam, clip_norm
from numpy_cae.training.progress import ProgressPrinter
from numpy_cae.training.schedule import (
    RECIPES,
    SEQUENCE_RECIPES,
    Schedule,
    SequenceSchedule,
    Stage,
    recipe,
)
from numpy_cae.training.sequential import train_sequential, unit_directions
from numpy_cae.training.state import TrainingState
from numpy_cae.training.windows import Windows

__all__ = [
    "RECIPES",
    "SEQUENCE_RECIPES",
    "Adam",
    "Checkpoint",
    "CheckpointError",
    "DivergedError",
    "ProgressPrinter",
    "Schedule",
    "SequenceSchedule",
    "Stage",
    "TrainingState",
    "Windows",
    "clip_norm",
    "recipe",
    "train_autoencoder",
    "train_sequential",
    "unit_directions",
    "zero_values",
]
