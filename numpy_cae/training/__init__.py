"""Training of both networks, holden2015's and jang2018's.

Read `step` first, one step of each network, then the loops in `layerwise` and `sequential`. Both
loops keep a `TrainingState`, which `checkpoint` saves and `report` functions are given.
"""

from numpy_cae.training.adam import Adam as Adam
from numpy_cae.training.checkpoint import Checkpoint as Checkpoint
from numpy_cae.training.checkpoint import CheckpointError as CheckpointError
from numpy_cae.training.layerwise import train_autoencoder as train_autoencoder
from numpy_cae.training.progress import ProgressPrinter as ProgressPrinter
from numpy_cae.training.schedule import RECIPES as RECIPES
from numpy_cae.training.schedule import SEQUENCE_RECIPES as SEQUENCE_RECIPES
from numpy_cae.training.schedule import Schedule as Schedule
from numpy_cae.training.schedule import SequenceSchedule as SequenceSchedule
from numpy_cae.training.schedule import Stage as Stage
from numpy_cae.training.schedule import recipe as recipe
from numpy_cae.training.sequential import train_sequential as train_sequential
from numpy_cae.training.sgd import clip_norm as clip_norm
from numpy_cae.training.state import DivergedError as DivergedError
from numpy_cae.training.state import History as History
from numpy_cae.training.state import TrainingState as TrainingState
from numpy_cae.training.step import unit_directions as unit_directions
from numpy_cae.training.step import zero_values as zero_values

__all__ = [name for name in dir() if not name.startswith("_")]
