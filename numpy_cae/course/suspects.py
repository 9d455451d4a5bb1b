"""The wrong operations of lesson 12: planted bugs, and those to be found by reading."""

from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.operation_catalogue import properties_of_operation
from numpy_cae.verify.operations.patch import BUGS, Patch, bug_named, bugs_of, conventions_of

__all__ = ["BUGS", "SUSPECTS", "accuse", "bug_named", "bugs_of", "conventions_of"]

CATCH_ALL = "special inputs"
"""A property of every operation that nearly every bug violates; naming it says nothing
about the mistake."""
MEANT = {"purity": ("purity", "independence")}
"""A function that keeps something between two calls is not pure either, as programmers use
the word."""


class Suspect:
    """A wrong operation whose mistake is to be found by reading."""

    def __init__(self, bug: Patch) -> None:
        self._bug = bug
        self.operation = bug.operation

    def source(self) -> str:
        """The source of the wrong operation."""
        return self._bug.source()

    def objection(self, named: object) -> str:
        """Why the name of a property is no answer; "" if the operation violates that property."""
        properties = {
            property_.name: property_ for property_ in properties_of_operation(self.operation)
        }
        if named == CATCH_ALL:
            return f"{CATCH_ALL!r} tests every result: name the property that the mistake is about"
        if named not in properties:
            names = ", ".join(name for name in properties if name != CATCH_ALL)
            return f"{self.operation} has no property {named!r}; it has {names}"
        meant = [properties[name] for name in MEANT.get(named, (named,))]
        for tested in meant:
            if failing_case(tested, self._bug.function()) is not None:
                return ""
        return f"this {self.operation} has the property {named!r}: {meant[0].statement}"

    def verdict(self, named: object) -> str:
        """The mistake if the answer is right, else what is wrong with the answer."""
        objection = self.objection(named)
        return f"not yet: {objection}" if objection else self._bug.sentence


NAMES_OF_BUGS = (
    "conv_without_flip",
    "arctanh_gradient_beyond_bound",
    "conv_bias_not_over_windows",
    "step_biases_alike",
    "gru_first_state_dropped",
    "conv_accumulates",
)
SUSPECTS = tuple(Suspect(bug_named(name)) for name in NAMES_OF_BUGS)
"""The bugs to be found by reading, the first one being suspect 1."""


def accuse(suspect: int) -> str:
    """The property that suspect 1, 2, ... violates."""
    return SUSPECTS[suspect - 1]._bug.caught_by
