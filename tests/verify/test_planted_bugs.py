"""Every planted bug is caught by the property that it names, and told from the others."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from numpy_cae.verify.grading.report import holds
from numpy_cae.verify.operations.operation_catalogue import CATALOGUE
from numpy_cae.verify.operations.patch import BUGS, Patch, read_patches
from numpy_cae.verify.operations.property import GRADIENT
from numpy_cae.verify.operations.trial import try_property

SIZES_AND_HISTORY = read_patches(Path(__file__).parent / "sizes_and_history")
"""Mistakes that show only at the project's own sizes, in long sequences, or after several calls."""

LONG = ("gru_in_parts_of_1000_frames", "gru_carried_200_frames")
"""Mistakes that only hundreds of frames show."""
FEW_FRAMES = [patch for patch in SIZES_AND_HISTORY if patch.name not in LONG]
MANY_FRAMES = [
    pytest.param(patch, marks=pytest.mark.thorough)
    for patch in SIZES_AND_HISTORY
    if patch.name in LONG
]

every_bug = pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.name)


def property_of(operation, name):
    return next(tried for tried in CATALOGUE[operation].properties if tried.name == name)


@every_bug
def test_each_is_caught_by_the_property_that_it_names_and_recognised(bug):
    tried = replace(property_of(bug.operation, bug.caught_by), examples=8)
    outcome = try_property(tried, bug.function(), shrink=False)
    assert not outcome.held
    assert outcome.mistake == bug.sentence


@every_bug
def test_the_source_shows_neither_name_nor_sentence(bug):
    (function,) = ast.parse(bug.source()).body
    assert function.name == "suspect" and ast.get_docstring(function) is None
    assert bug.name not in bug.source() and "#" not in bug.source()
    assert isinstance(function.body[-1], ast.Return)


@pytest.mark.parametrize("bug", FEW_FRAMES + MANY_FRAMES, ids=lambda bug: bug.name)
def test_mistakes_of_large_sizes_and_of_several_calls_are_caught(bug):
    assert not holds(CATALOGUE[bug.operation], bug.function())


@pytest.mark.filterwarnings("ignore:divide by zero", "ignore:invalid value")
@pytest.mark.parametrize(
    ("name", "change", "sentence"),
    [
        ("mean_absolute", lambda x, y, dx: 1.7 * dx, ""),
        ("mean_absolute", lambda x, y, dx: dx * len(y), "It is the right result times batch."),
        ("tanh", lambda x, y, dx: dx.astype(np.float32), "Digits are lost: "),
        ("unpool_even", lambda x, y, dx: dx * (y.shape[1] % 2), "It fails only where frames is e"),
        ("unpool_even", lambda x, y, dx: dx * (y.shape[1] < 3), "It fails only where frames is ab"),
        ("mean_absolute", lambda x, y, dx: dx / y.all(), "It fails only where y has a 0"),
    ],
)
def test_what_is_wrong_in_its_own_way_has_no_bug_but_what_was_seen(name, change, sentence):
    def wrong(y):
        x, pullback = CATALOGUE[name].solution(y)
        return x, lambda dx: change(x, y, pullback(dx))

    (tried,) = (prop for prop in CATALOGUE[name].properties if prop.group == GRADIENT)
    outcome = try_property(tried, wrong)
    assert not outcome.held and outcome.mistake.startswith(sentence)
    assert bool(outcome.mistake) == bool(sentence)


def test_a_patch_that_does_not_fit_the_source_fails_loudly():
    replaced = "return dy * 17", "return dy"
    bug = Patch("stale", "tanh", "value", "Made for another source.", (replaced,))
    with pytest.raises(ValueError, match=r"stale: found 0 times, expected once: return dy \* 17"):
        bug.function()
