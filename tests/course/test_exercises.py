"""The exercises: their solutions, wrong solutions, and the checks that they share."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from numpy_cae import course, ops
from numpy_cae.course.catalogue import EXERCISES, LESSONS
from numpy_cae.course.exercises.exercise import hints_of, with_hint
from numpy_cae.course.stand_in import stand_in
from numpy_cae.models import ConvAutoencoder, ConvLayer, SequentialAutoencoder
from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.operation_catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.operations.patch import read_patches
from numpy_cae.verify.operations.trial import try_property


def with_attribute(model, name, value):
    setattr(model, name, value)
    return model


MEMORY_AND_CALLS = read_patches(Path(__file__).with_name("memory_and_calls"))
OWN = [name for name in EXERCISES if name not in OPERATIONS]  # tests/verify tries the operations
OF_PACKAGE = {
    "encode_layer": lambda x, *of: ConvLayer(*of, 0.9).encode_with_pullback(x)[0],
    "decode_layer": lambda y, *of: ConvLayer(*of).decode_with_pullback(y)[0],
    "layer_loss": lambda x, corrupted, w, b, first, alpha, bound: with_attribute(
        ConvAutoencoder(1, (1,), 1), "layers", [ConvLayer(w, b, bound)]
    ).loss_and_gradients(x, corrupted, alpha, [first])[0],
    "regularised_loss": lambda weights, *given: (
        with_attribute(SequentialAutoencoder(1, 1, 1), "weights", weights)
        .loss_and_gradients(*given)[0]
        .total
    ),
}


def unsolved(*arguments):
    raise NotImplementedError


def zeros(positions, theta):
    return np.zeros((len(positions), 63))


@pytest.mark.parametrize("name", OWN)
def test_the_solution_has_every_property_and_trivial_functions_fail(name):
    tried = EXERCISES[name]
    few = [replace(p, examples=max(1, p.examples // 12)) for p in tried.properties]
    for prop in few:  # pytest -m lessons tries all examples
        outcome = try_property(prop, tried.solution)
        assert outcome.held, f"{prop.name}: {outcome.problem}"
    for trivial in (lambda *arguments: arguments[0], lambda *arguments: None):
        held = [prop for prop in few if failing_case(prop, trivial) is None]
        assert sum(prop.points for prop in held) < tried.points / 2


@pytest.mark.parametrize("name", OF_PACKAGE)
def test_the_key_returns_what_the_package_returns(name):
    stated = EXERCISES[name].properties[0]
    for case in stated.cases()[::6]:
        made, expected = (
            function(*stated.arguments(case).values())
            for function in (EXERCISES[name].solution, OF_PACKAGE[name])
        )
        made = made[0] if isinstance(made, tuple) else made
        np.testing.assert_allclose(made, expected, rtol=1e-12, atol=1e-14)


def test_hints_come_in_stages_and_after_a_first_attempt():
    assert "not solved yet" in str(course.report("to_features", unsolved))
    assert "after your first attempt" in str(course.report("to_features", unsolved, hint=1))

    shown = [str(course.report("to_features", zeros, hint=stage)) for stage in (0, 1, 2)]
    assert 'course.report("to_features", to_features, hint=1) in a cell of your own' in shown[0]
    assert "hint: three steps" in shown[1] and "subtract" not in shown[1]
    assert "hint: subtract the ground position" in shown[2]
    assert "only x and z of the hips" in shown[2]  # of a property
    assert "hint" not in str(course.report("to_features", EXERCISES["to_features"].solution))
    with pytest.raises(ValueError, match="hint is 1 or 2, got 3"):
        course.report("to_features", zeros, hint=3)


def test_every_exercise_has_points_hints_and_a_row_in_the_instructors_table():
    text = Path(__file__).parents[2].joinpath("lessons", "README.md").read_text(encoding="utf-8")
    for name, made in EXERCISES.items():
        assert made.points in (5, 10, 20, 40)
        assert min(stated.points for stated in made.properties) > 0
        stages, stated = hints_of(name)
        assert len(stages) == 2
        of_properties = {p.name: p.hint for p in with_hint(made, 2).properties if p.hint}
        assert of_properties == stated
    for number, exercises in LESSONS.items():
        for each in exercises:
            assert f"| {number} | `{each.name}` | {each.points} | {each.properties[0].name}" in text


def test_later_cells_go_on_with_the_students_own_or_the_packages(capsys):
    with pytest.raises(ValueError, match="no exercise is called 'conv'; there are square, ch"):
        course.solved("conv", ops.tanh)
    replaced = course.solved("square", lambda x: (x * x, lambda dy: 2 * dy))
    assert "the package's own" in capsys.readouterr().out
    assert "hint: a pullback takes" in str(course.report("square", replaced, hint=1))
    package_own = stand_in("conv1d")
    report = course.report("conv1d", package_own)
    assert report.unsolved and report.points == 0
    assert "run the cell with your function again first" in capsys.readouterr().out
    x, w, b = np.ones((1, 4, 2)), np.ones((3, 2, 1)), np.zeros(1)
    np.testing.assert_array_equal(package_own(x, w, b)[0], ops.conv1d(x, w, b)[0])
    assert course.solved("unpool_even", ops.unpool_even) is ops.unpool_even
    assert capsys.readouterr().out == "unpool_even: the next cells use your function\n"


@pytest.mark.filterwarnings("ignore:careful")
def test_nbgrader_gets_the_points_of_the_command(monkeypatch, capsys):
    def half(y):
        warnings.warn("careful", stacklevel=2)
        x, pullback = ops.unpool_even(y)
        return x, lambda dx: 2 * pullback(dx)

    points = course.report("unpool_even", half).points
    capsys.readouterr()
    monkeypatch.setenv("NBGRADER_EXECUTION", "autograde")
    assert 0 < points < 20 and course.report("unpool_even", half) == points
    printed = capsys.readouterr()
    assert f"{points} of 20 points" in printed.out and not printed.err
    assert course.report("unpool_even", ops.unpool_even) == 20


def test_a_counterexample_too_long_to_print_is_returned_by_example():
    assert 'example("to_features", frames=2, seed=0)' in str(course.report("to_features", zeros))
    example = course.example("to_features", frames=2, seed=0)
    assert list(example) == ["positions", "theta"] and example["positions"].shape == (2, 20, 3)
    with pytest.raises(ValueError, match="to_features has the sizes frames, layout, got fr"):
        course.example("to_features", fr=2, seed=0)


@pytest.mark.parametrize("patch", MEMORY_AND_CALLS, ids=lambda patch: patch.operation)
def test_memory_order_and_later_calls_matter_to_every_exercise(patch):
    stated = EXERCISES[patch.operation]
    wrong = patch.applied_to(stated.solution)
    assert [p.name for p in stated.properties if failing_case(p, wrong)] == [patch.caught_by]


def test_a_stack_that_computes_in_float64_is_refused():
    def in_float64(x, corrupted, layers, bound):
        wide = [(w.astype(float), b.astype(float)) for w, b in layers]
        return EXERCISES["stack_loss"].solution(x, corrupted, wide, bound)

    failing = []
    for stated in EXERCISES["stack_loss"].properties:
        if failing_case(stated, in_float64) is not None:
            failing.append(stated.name)
    assert failing == ["dtype"]
