"""Extensions that the papers leave to future work: constraints and pins."""

from numpy_cae.beyond.constrained import project_constrained
from numpy_cae.beyond.in_rig import constrain
from numpy_cae.beyond.pins import Pin, Pins, read_pins

__all__ = [
    "Pin",
    "Pins",
    "constrain",
    "project_constrained",
    "read_pins",
]
