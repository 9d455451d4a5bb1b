"""What the papers leave to future work: constraints, pins and holes that are known."""

from numpy_cae.beyond.constrained import project_constrained
from numpy_cae.beyond.observed import poses_of, project_observed
from numpy_cae.beyond.pins import Pin, Pins, read_pins

__all__ = ["Pin", "Pins", "poses_of", "project_constrained", "project_observed", "read_pins"]
