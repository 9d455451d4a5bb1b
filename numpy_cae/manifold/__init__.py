"""Applications of a trained network: repair, fill, interpolate, compare and sample motions."""

from numpy_cae.array_file import ModelFileError
from numpy_cae.manifold.compare import G, distance_matrix, hidden_units, signature
from numpy_cae.manifold.detect import find_unlikely
from numpy_cae.manifold.evidence.finding import Finding, write_findings
from numpy_cae.manifold.evidence.presets import PRESETS, Preset
from numpy_cae.manifold.fill import fill, keyframe_mask
from numpy_cae.manifold.interpolate import interpolate
from numpy_cae.manifold.learning import learn_manifold, learn_sequences
from numpy_cae.manifold.model_file import load_manifold, save_manifold, starter
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.project_motion import project_motion
from numpy_cae.manifold.repair import fill_motion, repair
from numpy_cae.manifold.repaired import Repaired
from numpy_cae.manifold.sample import NeighbourPrior, draw_uniform, sample
from numpy_cae.manifold.sequence_manifold import SequenceManifold

__all__ = [
    "PRESETS",
    "Finding",
    "G",
    "ModelFileError",
    "MotionManifold",
    "NeighbourPrior",
    "Preset",
    "Repaired",
    "SequenceManifold",
    "distance_matrix",
    "draw_uniform",
    "fill",
    "fill_motion",
    "find_unlikely",
    "hidden_units",
    "interpolate",
    "keyframe_mask",
    "learn_manifold",
    "learn_sequences",
    "load_manifold",
    "project_motion",
    "repair",
    "sample",
    "save_manifold",
    "signature",
    "starter",
    "write_findings",
]
