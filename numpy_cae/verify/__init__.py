"""Tests of derivatives written by hand: gradient checks, and the properties of each operation.

Everything here takes operations in the form of `numpy_cae.ops`: a function that returns its value
and its pullback. `check_gradients` and `check_adjoint` raise with a readable message;
`properties` lists what must hold of an operation, as data; `report` tests an implementation for
all of it. `numpy-cae verify student.py` does the same to a file, in a process of its own.
"""

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.catalogue import properties
from numpy_cae.verify.gradients import check_gradients
from numpy_cae.verify.reporting import report
from numpy_cae.verify.trial import check_property, example

__all__ = ["check_adjoint", "check_gradients", "check_property", "example", "properties", "report"]
