"""Applications of a trained network: project, fill, interpolate, compare and sample features."""

from numpy_cae.array_file import ModelFileError as ModelFileError
from numpy_cae.manifold.compare import G as G
from numpy_cae.manifold.compare import distance_matrix as distance_matrix
from numpy_cae.manifold.compare import hidden_units as hidden_units
from numpy_cae.manifold.compare import signature as signature
from numpy_cae.manifold.fill import fill as fill
from numpy_cae.manifold.fill import keyframe_mask as keyframe_mask
from numpy_cae.manifold.interpolate import interpolate as interpolate
from numpy_cae.manifold.learning import learn_manifold as learn_manifold
from numpy_cae.manifold.learning import learn_sequences as learn_sequences
from numpy_cae.manifold.model_file import load_manifold as load_manifold
from numpy_cae.manifold.model_file import starter as starter
from numpy_cae.manifold.motion_manifold import MotionManifold as MotionManifold
from numpy_cae.manifold.sample import NeighbourPrior as NeighbourPrior
from numpy_cae.manifold.sample import draw_uniform as draw_uniform
from numpy_cae.manifold.sample import sample as sample
from numpy_cae.manifold.sequence_manifold import SequenceManifold as SequenceManifold

__all__ = [name for name in dir() if not name.startswith("_")]
