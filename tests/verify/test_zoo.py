"""The bugs of the zoo: every one is caught, by the property that names it."""

import pytest

from numpy_cae.verify.catalogue import CATALOGUE
from numpy_cae.verify.trial import try_property
from numpy_cae.verify.zoo import BUGS, bugs_of

EXAMPLES = 25  # what a report tries


def property_of(operation, name):
    return next(tried for tried in CATALOGUE[operation].properties if tried.name == name)


def test_the_zoo_is_large_and_every_operation_has_its_bugs():
    assert len(BUGS) >= 60
    assert len({bug.name for bug in BUGS}) == len(BUGS)
    assert all(bugs_of(operation) for operation in CATALOGUE)


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.name)
def test_each_is_caught_by_the_property_that_names_it(bug):
    tried = property_of(bug.operation, bug.caught_by)
    outcome = try_property(tried, bug.implementation, EXAMPLES, shrink=False)
    assert not outcome.held
    assert outcome.mistake


@pytest.mark.parametrize(
    "bug", [b for b in BUGS if b.caught_by.startswith("gradient for")], ids=lambda bug: bug.name
)
def test_a_wrong_gradient_leaves_the_value_alone(bug):
    value = property_of(bug.operation, "value")
    assert try_property(value, bug.implementation, EXAMPLES, shrink=False).held


@pytest.mark.parametrize("operation", CATALOGUE)
def test_every_bug_is_told_from_the_others(operation):
    """The likely mistake is the bug's own sentence, though it was found by behaviour alone."""
    taken_for = {}
    for bug in bugs_of(operation):
        tried = property_of(operation, bug.caught_by)
        outcome = try_property(tried, bug.implementation, EXAMPLES, shrink=False)
        if outcome.mistake != bug.sentence:
            taken_for[bug.name] = outcome.mistake
    assert not taken_for
