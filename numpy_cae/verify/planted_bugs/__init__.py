"""Planted bugs: classic mistakes in derivatives, each a small patch of a right operation.

Each is caught by the property that it names; a report compares a failing implementation with them
to name a likely mistake. In lesson 12 students look for some of them.
"""

from pathlib import Path

from numpy_cae.verify.patch import Patch, read_patches

BUGS = read_patches(Path(__file__).parent)


def bugs_of(operation: str) -> tuple[Patch, ...]:
    """The bugs of one operation."""
    return tuple(bug for bug in BUGS if bug.operation == operation)


def bug_named(name: str) -> Patch:
    """The bug of this name; a KeyError if there is none."""
    return {bug.name: bug for bug in BUGS}[name]
