"""Corruption, descent and its decay, and the schedule of holden2015, section 6."""

from numpy_cae.training.corruption import zero_values
from numpy_cae.training.layerwise import DivergedError, History, train_autoencoder
from numpy_cae.training.schedule import Schedule, Stage
from numpy_cae.training.sgd import decayed_rate, descend

__all__ = [
    "DivergedError",
    "History",
    "Schedule",
    "Stage",
    "decayed_rate",
    "descend",
    "train_autoencoder",
    "zero_values",
]
