"""Every property of every operation: no alarm on what is right, and every class is drawn."""

import numpy as np
import pytest
from written_otherwise import RIGHT

from numpy_cae import verify
from numpy_cae.verify.grading.report import holds
from numpy_cae.verify.operations.case import VALUES
from numpy_cae.verify.operations.catalogue import CATALOGUE, in_other_conventions
from numpy_cae.verify.operations.patch import conventions_of

FEWER = {"gru_step": slice(-1, None), "gru": slice(1)}
"""Of the conventions of a GRU step all are combined; a GRU repeats one of its step."""


def test_every_property_draws_every_class_and_size_in_cases_of_its_own():
    seeds = set()
    for operation, exercise in CATALOGUE.items():
        assert len({tried.name for tried in exercise.properties}) == len(exercise.properties) >= 8
        for tried in exercise.properties:
            assert tried.operation == operation and tried.statement
            cases = tried.cases()
            for name, options in tried.sizes.items():
                assert {case[name] for case in cases} == set(options)
            assert len(tried.sizes["values"]) < len(VALUES) or "ties" in tried.sizes["values"]
            seeds.add(tuple(case.seed for case in cases))
    assert len(seeds) == sum(len(exercise.properties) for exercise in CATALOGUE.values())


@pytest.mark.parametrize(
    ("name", "function"), [pytest.param(*each, id=each[1].__name__) for each in RIGHT]
)
def test_what_is_written_otherwise_holds(name, function):
    report = verify.report(name, function)
    assert report.held, str(report)


@pytest.mark.parametrize(
    "other",
    [
        pytest.param(other, id=f"{name}: {other.sentence}")
        for name in CATALOGUE
        for other in conventions_of(name)[FEWER.get(name, slice(None))]
    ],
)
def test_another_convention_fails_unless_it_is_allowed(other):
    # A report follows the first convention that holds, and the contract's is tried first.
    allowed = verify.report(other.operation, other.function(), any_convention=True)
    assert allowed.held and allowed.exercise.convention == other.sentence
    assert f"another convention than numpy_cae's: {other.sentence}"[:60] in str(allowed)


def test_a_wrong_function_is_right_in_no_convention():
    def wrong(x, h, w, u, b, c):
        value, pullback = conventions_of("gru_step")[1].function()(x, h, w, u, b, c)
        return value, lambda dy: (*pullback(dy)[:5], 2 * pullback(dy)[5])

    tried = (CATALOGUE["gru_step"], *in_other_conventions(CATALOGUE["gru_step"]))
    assert not any(holds(exercise, wrong) for exercise in tried)


def test_an_example_is_what_a_report_prints():
    wrong = lambda x: (np.tanh(x), lambda dy: 3 * dy)  # noqa: E731
    text = next(o for o in verify.report("tanh", wrong).outcomes if not o.held).counterexample
    sizes = {"batch": 1, "frames": 1, "channels": 1, "axes": 3}
    example = verify.example("tanh", seed=0, **sizes)
    assert text.startswith("batch 1, frames 1, channels 1, axes 3, seed 0\n")
    assert f"x = {example.arguments['x'].tolist()}" in text
    assert f"upstream gradient = {example.upstream.tolist()}" in text
    with pytest.raises(ValueError, match=r"tanh has the sizes batch, frames, .* got frames"):
        verify.example("tanh", frames=2, seed=0)
    with pytest.raises(ValueError, match="values is 'small', expected one of ordinary, random"):
        verify.example("tanh", seed=0, **sizes, values="small")
