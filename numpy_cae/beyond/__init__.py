"""Extensions that the papers leave to future work: projection under constraints."""

from numpy_cae.beyond.constrained import project_constrained

__all__ = ["project_constrained"]
