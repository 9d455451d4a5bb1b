"""Training of both networks, holden2015's and jang2018's.

Read `layerwise` and `sequential` first, the training of each network, whose loop over epochs and
batches is `TrainingState.steps_of`. A `Checkpoint` saves this state, and `report` functions are
given it.
"""

from numpy_cae.training.corruption import zero_values
from numpy_cae.training.layerwise import train_autoencoder
from numpy_cae.training.loop import Checkpoint, CheckpointError, DivergedError, TrainingState
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
    "clip_norm",
    "recipe",
    "train_autoencoder",
    "train_sequential",
    "unit_directions",
    "zero_values",
]
