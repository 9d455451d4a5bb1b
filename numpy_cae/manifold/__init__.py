"""Applications of a trained network: project, fill, interpolate, compare and sample features."""

from numpy_cae.array_file import ModelFileError
from numpy_cae.manifold.compare import G, distance_matrix, hidden_units, signature
from numpy_cae.manifold.fill import fill, keyframe_mask
from numpy_cae.manifold.interpolate import interpolate
from numpy_cae.manifold.learning import learn_manifold, learn_sequences
from numpy_cae.manifold.model_file import load_manifold, starter
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.sample import NeighbourPrior, draw_uniform, sample
from numpy_cae.manifold.sequence_manifold import SequenceManifold

__all__ = [name for name in dir() if not name.startswith("_")]
