"""Extensions that the papers leave to future work: constraints, pins and known holes."""

from numpy_cae.beyond.constrained import project_constrained, repair_constrained
from numpy_cae.beyond.observed import fill_observed, pose_pca, project_observed
from numpy_cae.beyond.pins import Pin, Pins, read_pins

__all__ = [
    "Pin",
    "Pins",
    "fill_observed",
    "pose_pca",
    "project_constrained",
    "project_observed",
    "read_pins",
    "repair_constrained",
]
