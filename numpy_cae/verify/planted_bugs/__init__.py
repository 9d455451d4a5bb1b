"""Planted bugs: classic mistakes in derivatives, each a small patch of a right operation.

The properties catch every one of them, each by the property that the bug names; a report compares
a failing implementation with them to name a likely mistake. In lesson 12 students look for the
mistake in the source of some of them.
"""

from __future__ import annotations

from pathlib import Path

from numpy_cae.verify.planted_bugs.bug import (
    PatchError,
    PlantedBug,
    read_bugs,
    right_operation,
)

__all__ = ["BUGS", "PatchError", "PlantedBug", "bug_named", "bugs_of", "right_operation"]

BUGS: tuple[PlantedBug, ...] = tuple(
    bug for path in sorted(Path(__file__).parent.glob("*.txt")) for bug in read_bugs(path)
)


def bugs_of(operation: str) -> tuple[PlantedBug, ...]:
    """The bugs of one operation."""
    return tuple(bug for bug in BUGS if bug.operation == operation)


def bug_named(name: str) -> PlantedBug:
    """The bug of this name.

    Raises
    ------
    KeyError
        If there is none.
    """
    return {bug.name: bug for bug in BUGS}[name]
