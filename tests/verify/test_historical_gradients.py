"""The wrong gradients of studies/gradients/historical are found; `python -m studies
gradient_checks` tries all of their fixed versions, this file every fourth."""

import pytest

from numpy_cae import verify
from numpy_cae.verify.operations.property import failing_case, failure
from studies.gradients.bugs import LAYERS, bugs

BUGS = bugs()
OF_LAYERS = bugs(LAYERS)
WRONG_LAYERS = [layer for layer in OF_LAYERS if not layer.is_right]


def properties(bug):
    options = {"skip": ["dtype"], "dtypes": bug.dtypes} if bug.is_layer else {}
    return verify.properties_of(bug.function(False), bug.shapes, values=bug.ranges, **options)


@pytest.mark.parametrize("bug", BUGS + WRONG_LAYERS, ids=lambda bug: bug.name)
def test_the_wrong_version_is_found(bug):
    assert any(failing_case(stated, bug.function(fixed=False)) for stated in properties(bug))


@pytest.mark.parametrize("bug", BUGS[::4] + OF_LAYERS[2::4], ids=lambda bug: bug.name)
def test_the_fixed_version_holds(bug):
    """In every third case, another third for each property."""
    for number, stated in enumerate(properties(bug)):
        for case in stated.cases()[number % 3 :: 3]:
            assert failure(stated, bug.function(fixed=True), case) is None, stated.name


def test_each_has_its_thread_and_its_fix_and_is_short():
    assert len(BUGS) >= 40
    for bug in BUGS:
        assert bug.fields["thread"].startswith("https://github.com/")
        assert bug.fields["fix"].startswith("https://github.com/")
        assert 4 <= len(bug.code.splitlines()) <= 30
        assert bug.fields["mistake"].endswith(".")
