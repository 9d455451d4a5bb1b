"""Descent and its decay, and the training of both networks, holden2015's and jang2018's."""

from numpy_cae.training.checkpoint import Checkpoint, CheckpointError
from numpy_cae.training.clipping import clip_norm
from numpy_cae.training.corruption import zero_values
from numpy_cae.training.directions import unit_directions
from numpy_cae.training.divergence import DivergedError
from numpy_cae.training.layerwise import History, train_autoencoder
from numpy_cae.training.schedule import Schedule, SequenceSchedule, Stage
from numpy_cae.training.sequential import SequenceHistory, train_sequential
from numpy_cae.training.sgd import decayed_rate, descend, descend_with_momentum

__all__ = [
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
    "train_autoencoder",
    "train_sequential",
    "unit_directions",
    "zero_values",
]
