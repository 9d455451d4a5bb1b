"""Tests of derivatives written by hand: gradient checks, and the properties of each operation.

An operation is a function that returns its value and its pullback. `check_gradients`,
`check_adjoint`, `check_jvp` and `check_second_derivatives` raise; `properties` lists what must hold
of an operation of `numpy_cae.ops`, and `properties_of` of one of your own, which `operation_test`
turns into tests of pytest. `of_layer`, `of_cache` and `of_complex` make operations of functions of
other forms. `report` tests an operation for all of it, and `numpy-cae verify student.py` a file, in
a process of its own.
"""

from numpy_cae.verify.adapters import of_cache, of_complex, of_layer
from numpy_cae.verify.checks.forward_mode import check_jvp
from numpy_cae.verify.checks.gradients import check_adjoint, check_gradients
from numpy_cae.verify.checks.second_derivatives import check_second_derivatives
from numpy_cae.verify.grading.report import report
from numpy_cae.verify.operations.operation_catalogue import example, properties
from numpy_cae.verify.operations.own_operation import operation_test, properties_of
from numpy_cae.verify.operations.property import Property
from numpy_cae.verify.operations.trial import check_property

__all__ = [
    "Property",
    "check_adjoint",
    "check_gradients",
    "check_jvp",
    "check_property",
    "check_second_derivatives",
    "example",
    "of_cache",
    "of_complex",
    "of_layer",
    "operation_test",
    "properties",
    "properties_of",
    "report",
]
