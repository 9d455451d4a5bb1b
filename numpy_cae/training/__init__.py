"""Training of both networks, holden2015's and jang2018's.

Read `step` first, one step of each network, then `layerwise` and `sequential`, whose loop over
epochs and batches is `TrainingState.steps_of`. `checkpoint` saves this state, and `report`
functions are given it.
"""

from numpy_cae.training.checkpoint import Checkpoint, CheckpointError
from numpy_cae.training.layerwise import train_autoencoder
from numpy_cae.training.loop import DivergedError, History, TrainingState
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
from numpy_cae.training.sequential import train_sequential
from numpy_cae.training.step import unit_directions, zero_values

__all__ = [name for name in dir() if not name.startswith("_")]
