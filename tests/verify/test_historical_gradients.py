"""The wrong gradients of studies/gradients are found; `python -m studies gradient_checks` tries all
of their fixed versions, this file every eighth and, marked thorough, every fourth."""

from inspect import getsource

import pytest

from numpy_cae import verify
from numpy_cae.verify.operations.counterexample import failing_case, failure
from studies.gradients.published import historical_bugs, layers

BUGS = historical_bugs()
LAYERS = layers()
WRONG_LAYERS = [layer for layer in LAYERS if not layer.is_right]

EVERY_EIGHTH = BUGS[::8] + LAYERS[2::8]
FURTHER = [
    pytest.param(operation, marks=pytest.mark.thorough) for operation in BUGS[4::8] + LAYERS[6::8]
]


def properties(operation):
    f = operation.version(fixed=False)
    options = {"skip": ["dtype"], "dtypes": operation.dtypes} if operation.is_layer else {}
    return verify.properties_of(f, operation.shapes, values=operation.ranges, **options)


@pytest.mark.parametrize("operation", BUGS + WRONG_LAYERS, ids=lambda operation: operation.name)
def test_the_wrong_version_is_found(operation):
    f = operation.version(fixed=False)
    assert any(failing_case(stated, f) for stated in properties(operation))


@pytest.mark.parametrize("operation", EVERY_EIGHTH + FURTHER, ids=lambda operation: operation.name)
def test_the_fixed_version_holds(operation):
    """In every third case, another third for each property."""
    f = operation.version(fixed=True)
    for number, stated in enumerate(properties(operation)):
        for case in stated.cases()[number % 3 :: 3]:
            assert failure(stated, f, case) is None, stated.name


def test_there_are_forty_and_each_has_its_mistake():
    assert len(BUGS) >= 40
    assert all(bug.mistake.endswith(".") for bug in BUGS)


@pytest.mark.parametrize("link", ["thread", "fix"])
def test_each_has_its_thread_and_its_fix(link):
    assert all(getattr(bug, link).startswith("https://github.com/") for bug in BUGS)


def test_each_is_short():
    lines = [len(getsource(bug.function).splitlines()) for bug in BUGS]
    assert 4 <= min(lines) <= max(lines) <= 35
