"""Training of both networks, holden2015's and jang2018's.

Read `step` first: one step of each. `layerwise` and `sequential` describe the stages, `loop` runs
them; it calls `checkpoint` and `progress` between its steps.
"""

from numpy_cae.training.adam import Adam
from numpy_cae.training.checkpoint import Checkpoint, CheckpointError
from numpy_cae.training.corruption import zero_values
from numpy_cae.training.layerwise import History, train_autoencoder
from numpy_cae.training.progress import DivergedError
from numpy_cae.training.schedule import Schedule, SequenceSchedule, Stage, decayed_rate, one_cycle
from numpy_cae.training.sequential import SequenceHistory, train_sequential
from numpy_cae.training.sgd import clip_norm, descend, descend_with_momentum
from numpy_cae.training.step import unit_directions

__all__ = [
    "Adam",
    "Checkpoint",
    "CheckpointError",
    "DivergedError",
    "History",
    "Schedule",
    "SequenceHistory",
    "SequenceSchedule",
    "Stage",
    "clip_norm",
    "decayed_rate",
    "descend",
    "descend_with_momentum",
    "one_cycle",
    "train_autoencoder",
    "train_sequential",
    "unit_directions",
    "zero_values",
]
