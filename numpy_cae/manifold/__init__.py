"""Applications of a trained network: repair, fill, interpolate, compare and sample motions."""

from numpy_cae.array_file import ModelFileError
from numpy_cae.manifold.compare import G, distance_matrix, hidden_units, signature
from numpy_cae.manifold.fill import (
    fill_joint,
    fill_keyframes,
    fill_motion_joint,
    fill_motion_keyframes,
)
from numpy_cae.manifold.interpolate import interpolate
from numpy_cae.manifold.learning import learn_manifold, learn_sequences
from numpy_cae.manifold.long_sequences import project_sequence, repair_sequence, sample_sequence
from numpy_cae.manifold.model_file import load_manifold, save_manifold
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.repair import repair
from numpy_cae.manifold.sample import NeighbourPrior, draw_uniform, sample
from numpy_cae.manifold.sequence_manifold import SequenceManifold

__all__ = [
    "G",
    "ModelFileError",
    "MotionManifold",
    "NeighbourPrior",
    "SequenceManifold",
    "distance_matrix",
    "draw_uniform",
    "fill_joint",
    "fill_keyframes",
    "fill_motion_joint",
    "fill_motion_keyframes",
    "hidden_units",
    "interpolate",
    "learn_manifold",
    "learn_sequences",
    "load_manifold",
    "project_sequence",
    "repair",
    "repair_sequence",
    "sample",
    "sample_sequence",
    "save_manifold",
    "signature",
]
