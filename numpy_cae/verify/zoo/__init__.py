"""The bug zoo: classic mistakes in derivatives, each whole, to be found before a test tells.

Each bug is a complete implementation of its operation with one thing wrong. The suite catches all
of them, each by the property that names it; a report compares a failing implementation with them
to say what the mistake probably is. Reading one without its docstring is lesson 12's game.
"""

from numpy_cae.verify.zoo import (  # noqa: F401 (importing a room fills it)
    activations,
    convolution,
    filters,
    linear,
    losses,
    pooling,
    recurrent,
    through_time,
    tied,
    unpooling,
    wasserstein,
)
from numpy_cae.verify.zoo.bug import BUGS, Bug

__all__ = ["BUGS", "Bug", "bugs_of"]


def bugs_of(operation: str) -> tuple[Bug, ...]:
    """The bugs of one operation."""
    return tuple(bug for bug in BUGS if bug.operation == operation)
