"""What a bug of the zoo is: a whole wrong implementation, and the property that is to catch it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

BUGS: list[Bug] = []


@dataclass(frozen=True)
class Bug:
    """A classic mistake. `sentence` says what is wrong, `caught_by` names the property."""

    name: str
    operation: str
    sentence: str
    caught_by: str
    implementation: Callable = field(repr=False)


def bug(operation: str, caught_by: str) -> Callable[[Callable], Callable]:
    """Admit a function to the zoo; its name names the bug, its docstring is the sentence."""

    def admit(implementation: Callable) -> Callable:
        sentence = " ".join(implementation.__doc__.split())
        BUGS.append(Bug(implementation.__name__, operation, sentence, caught_by, implementation))
        return implementation

    return admit
