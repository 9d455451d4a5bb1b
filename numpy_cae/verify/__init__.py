"""Gradients that a stranger can trust: finite differences and adjoint tests.

Everything here takes operations in the form of `numpy_cae.ops`: a function that returns its value
and its pullback. It works on anyone's implementation, a student's included.
"""

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.gradients import check_gradients

__all__ = ["check_adjoint", "check_gradients"]
