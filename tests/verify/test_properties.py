"""Every property of every operation: no alarm on what is right, and every class is drawn."""

from dataclasses import replace

import numpy as np
import pytest
from written_otherwise import RIGHT, conv1d_by_einsum, conv1d_by_fft, sliced_by_ranks

from numpy_cae import verify
from numpy_cae.verify.checks import mismatch
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation_catalogue import CATALOGUE
from numpy_cae.verify.operations.trial import try_property
from numpy_cae.verify.operations.values import VALUES


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


@pytest.mark.parametrize("most_cases", [10, pytest.param(None, marks=pytest.mark.thorough)])
@pytest.mark.parametrize(
    ("name", "function"), [pytest.param(name, f, id=f.__name__) for name, f in RIGHT]
)
def test_what_is_written_otherwise_holds(name, function, most_cases):
    for stated in CATALOGUE[name].properties:
        outcome = try_property(replace(stated, most_cases=most_cases), function)
        assert outcome.held, f"{outcome.problem}\n{outcome.counterexample}"


@pytest.mark.parametrize(
    ("function", "operation", "name", "sizes", "seed"),
    [
        (conv1d_by_einsum, "conv1d", "linearity", {"batch": 70, "upstream": "large"}, 1613),
        (conv1d_by_fft, "conv1d", "adjoint in x", {"taps": 3, "values": "constant", "of": "w"}, 0),
        (sliced_by_ranks, "sliced_wasserstein", "dtype", {"values": "near ties", "of": "z"}, 1028),
    ],
)
def test_where_terms_cancel_rounding_is_no_mistake(function, operation, name, sizes, seed):
    # Each was refused with one of thirty seeds.
    simple = {"frames": 14 if "upstream" in sizes else 2, "channels": 1, "filters": 1, "taps": 1}
    simple |= {"batch": 1, "points": 2, "dimensions": 3, "directions": 2} | sizes
    (stated,) = (prop for prop in verify.properties(operation) if prop.name == name)
    stated.check(function, Case(tuple(simple.items()), seed))


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
    with pytest.raises(ValueError, match="tanh is not tried with small"):
        verify.example("tanh", seed=0, **sizes, values="small")


@pytest.mark.parametrize("widens", [False, True])
def test_a_scalar_has_no_dtype_to_lose_where_numpy_widens_scalars(widens, monkeypatch):
    """Before NumPy 2, a scalar of float32 times a Python number is float64."""
    monkeypatch.setattr(mismatch, "WIDENS_SCALARS", widens)
    assert mismatch.has_dtype(np.float64(1.0), np.float32) == widens
    assert not mismatch.has_dtype(np.ones(3), np.float32)
    assert mismatch.has_dtype(np.ones(3, np.float32), np.float32)
    assert mismatch.has_dtype(1.0, np.float32)
