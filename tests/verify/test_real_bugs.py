"""Real bugs of other projects, re-enacted: docs/wrong_gradients.md lists them with their links."""

import re

import pytest

from numpy_cae import verify
from numpy_cae.verify.operations.counterexample import failing_case
from studies.gradients.real_bugs import FOUND_BY, REAL_BUGS

SIZES = (1, 2, 3, 5)


def properties(bug):
    names = set(re.findall(r"[a-z]\w*", " ".join(bug.shapes.values())))
    sizes = dict.fromkeys(names, SIZES)
    return verify.properties_of(
        bug.function, bug.shapes, values=bug.ranges, dtypes=bug.dtypes, sizes=sizes
    )


each_bug = pytest.mark.parametrize("bug", REAL_BUGS, ids=lambda bug: bug.operation)


@each_bug
def test_a_real_bug_is_found(bug):
    (stated,) = (prop for prop in properties(bug) if prop.name == FOUND_BY[bug.operation])
    assert failing_case(stated, bug.version(fixed=False)) is not None


@each_bug
def test_the_mended_operation_holds(bug):
    f = bug.version(fixed=True)
    assert [stated.name for stated in properties(bug) if failing_case(stated, f)] == []
