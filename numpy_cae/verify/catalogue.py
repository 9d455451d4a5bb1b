"""The properties of every operation, as data: what the tests, the lessons and a grader all run."""

from __future__ import annotations

from numpy_cae.verify.convention import PYTORCH, Convention
from numpy_cae.verify.operation import OPERATIONS
from numpy_cae.verify.particulars import particular_properties
from numpy_cae.verify.property import Property, shared_properties


def properties_of(name: str, convention: Convention = PYTORCH) -> tuple[Property, ...]:
    """Every property of an operation; of a GRU, in any convention."""
    operation = OPERATIONS[name]
    if convention != PYTORCH:
        operation = operation.in_convention(convention)
    return (*shared_properties(operation), *particular_properties(operation))


properties: dict[str, tuple[Property, ...]] = {name: properties_of(name) for name in OPERATIONS}
