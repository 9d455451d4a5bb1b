"""Applications of a trained network: project, fill, interpolate, compare and sample features."""

from numpy_cae.array_file import ModelFileError
from numpy_cae.manifold.comparison import G, distance_matrix, hidden_units, signature
from numpy_cae.manifold.filling import fill, keyframe_mask
from numpy_cae.manifold.interpolation import interpolate
from numpy_cae.manifold.learning import learn_manifold, learn_sequences
from numpy_cae.manifold.model_file import load_manifold, starter
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.sampling import NeighbourPrior, draw_uniform, sample
from numpy_cae.manifold.sequence_manifold import SequenceManifold

__all__ = [
    "G",
    "ModelFileError",
    "MotionManifold",
    "NeighbourPrior",
    "SequenceManifold",
    "distance_matrix",
    "draw_uniform",
    "fill",
    "hidden_units",
    "interpolate",
    "keyframe_mask",
    "learn_manifold",
    "learn_sequences",
    "load_manifold",
    "sample",
    "signature",
    "starter",
]
