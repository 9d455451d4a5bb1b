"""What a trained network is for."""

from numpy_cae.manifold.compare import G, distance_matrix, hidden_units, signature
from numpy_cae.manifold.constrained import Pins, project_constrained
from numpy_cae.manifold.fill import fill_joint, fill_keyframes
from numpy_cae.manifold.filled_motion import fill_motion_joint, fill_motion_keyframes
from numpy_cae.manifold.geodesic import Geodesic, geodesic
from numpy_cae.manifold.interpolate import interpolate
from numpy_cae.manifold.learning import learn_manifold
from numpy_cae.manifold.model_file import ModelFileError, load_manifold, save_manifold
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.observed import project_observed
from numpy_cae.manifold.repair import repair
from numpy_cae.manifold.sample import NeighbourPrior, sample

__all__ = [
    "G",
    "Geodesic",
    "ModelFileError",
    "MotionManifold",
    "NeighbourPrior",
    "Pins",
    "distance_matrix",
    "fill_joint",
    "fill_keyframes",
    "fill_motion_joint",
    "fill_motion_keyframes",
    "geodesic",
    "hidden_units",
    "interpolate",
    "learn_manifold",
    "load_manifold",
    "project_constrained",
    "project_observed",
    "repair",
    "sample",
    "save_manifold",
    "signature",
]
