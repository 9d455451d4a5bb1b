"""What a trained network is for."""

from numpy_cae.manifold.compare import G, distance_matrix, hidden_units, signature
from numpy_cae.manifold.learning import learn_manifold
from numpy_cae.manifold.model_file import ModelFileError, load_manifold, save_manifold
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.repair import repair

__all__ = [
    "G",
    "ModelFileError",
    "MotionManifold",
    "distance_matrix",
    "hidden_units",
    "learn_manifold",
    "load_manifold",
    "repair",
    "save_manifold",
    "signature",
]
