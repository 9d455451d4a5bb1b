"""The exercises: their solutions, wrong solutions, and the checks that they share."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from numpy_cae import course, ops
from numpy_cae.course.exercises import EASY, EXERCISES, HARD, LESSONS
from numpy_cae.course.exercises.checks import PULLBACK, Differentiated, drawn, require_same
from numpy_cae.course.exercises.exercise import differentiated_exercise, exercise
from numpy_cae.course.exercises.hints import read_hints, with_hint
from numpy_cae.verify.operations.catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.operations.trial import try_property

OWN = [name for name in EXERCISES if name not in OPERATIONS]  # tests/verify tries the operations
SIZES = {"rows": (1, 2)}


def unsolved(*arguments):
    raise NotImplementedError


@pytest.mark.parametrize("name", OWN)
def test_the_solution_has_every_property_and_trivial_functions_fail(name):
    tried = EXERCISES[name]
    few = [replace(p, examples=min(4, p.examples)) for p in tried.properties]
    for prop in few:  # pytest -m lessons tries all examples
        outcome = try_property(prop, tried.solution)
        assert outcome.held, f"{prop.name}: {outcome.problem}"
    for trivial in (lambda *arguments: arguments[0], lambda *arguments: None):
        outcomes = [try_property(prop, trivial, shrink=False) for prop in few]
        assert sum(o.stated.points for o in outcomes if o.held) < tried.points / 2


def test_hints_come_in_stages_and_after_a_first_attempt():
    report = course.report("to_features", unsolved)
    assert report.unsolved and report.points == 0
    assert "not solved yet" in str(report) and "hint" not in str(report)
    assert "after your first attempt" in str(course.report("to_features", unsolved, hint=1))

    def wrong(positions, theta):
        return np.zeros((len(positions), 63))

    shown = [str(course.report("to_features", wrong, hint=stage)) for stage in (0, 1, 2)]
    assert 'course.report("to_features", to_features, hint=1) in a cell of your own' in shown[0]
    assert "hint: three steps" in shown[1] and "subtract" not in shown[1]
    assert "hint: subtract the ground position" in shown[2]
    assert "only x and z of the hips" in shown[2]  # of a property
    assert "hint" not in str(course.report("to_features", EXERCISES["to_features"].solution))
    with pytest.raises(ValueError, match="hint is 1 or 2, got 3"):
        course.report("to_features", wrong, hint=3)


def test_points_are_those_of_the_difficulty_and_each_property_has_some():
    assert EASY | HARD <= EXERCISES.keys() and not EASY & HARD
    points = {name: EXERCISES[name].points for name in ("tanh", "max_pool", "conv1d")}
    assert points == {"tanh": 10, "max_pool": 20, "conv1d": 40}
    for made in EXERCISES.values():
        assert made.points in (10, 20, 40)
        assert min(stated.points for stated in made.properties) >= 1


def test_later_cells_go_on_with_the_students_own_or_the_packages(capsys):
    with pytest.raises(ValueError, match="no exercise is called 'conv'; there are square, ch"):
        course.solved("conv", ops.tanh)
    assert course.solved("conv1d", ops.tanh) is not ops.tanh
    assert "the package's own" in capsys.readouterr().out
    stand_in = course.solved("conv1d", unsolved)
    report = course.report("conv1d", stand_in)
    assert report.unsolved and report.points == 0
    assert "run the cell with your function again first" in capsys.readouterr().out
    x, w, b = np.ones((1, 4, 2)), np.ones((3, 2, 1)), np.zeros(1)
    np.testing.assert_array_equal(stand_in(x, w, b)[0], ops.conv1d(x, w, b)[0])

    def mine(x, w, b):
        return ops.conv1d(x, w, b)

    assert course.solved("conv1d", mine) is mine
    assert capsys.readouterr().out == "conv1d: the next cells use your function\n"


@pytest.mark.filterwarnings("ignore:careful")
def test_nbgrader_gets_the_points_of_the_command(monkeypatch, capsys):
    def half(x, w, b):
        warnings.warn("careful", stacklevel=2)
        y, pullback = ops.conv1d(x, w, b)
        return y, lambda dy: (pullback(dy)[0], 2 * pullback(dy)[1], pullback(dy)[2])

    points = course.report("conv1d", half).points
    capsys.readouterr()
    monkeypatch.setenv("NBGRADER_EXECUTION", "autograde")
    assert 0 < points < 40 and course.report("conv1d", half) == points
    printed = capsys.readouterr()
    assert f"{points} of 40 points" in printed.out and not printed.err
    assert course.report("conv1d", ops.conv1d) == 40 and course.report("conv1d", unsolved) == 0


def doubled(x):
    return 2 * x


def doubled_in_place(x):
    x *= 2
    return x


def test_purity_finds_a_changed_argument():
    doubling = exercise(doubled, drawn(x="rows 3"), SIZES, value="it is doubled")
    value, purity = doubling.properties
    assert try_property(value, doubled_in_place).held
    outcome = try_property(purity, doubled_in_place)
    assert not outcome.held and outcome.problem == "the call changes x"
    assert try_property(purity, doubled).held


def half_of_gradients(weights, x):
    """x · w + b with a pullback that returns half of dw."""
    y, back = ops.linear(x, weights["w"], weights["b"])
    return y, lambda dy: {"w": 0.5 * back(dy)[1], "b": back(dy)[2]}


def without_bias(weights, x):
    y, back = ops.linear(x, weights["w"], weights["b"])
    return y, lambda dy: {"w": back(dy)[1]}


@pytest.mark.parametrize(
    ("function", "failing", "problem"),
    [
        (half_of_gradients, {"of w", "of both"}, "w"),
        (without_bias, {"of w", "of both", "dtype"}, "no gradient for b"),
        (lambda weights, x: x, {"value", "of w", "of both", "dtype"}, "does not return 2 things"),
    ],
)
def test_gradients_by_name_are_compared_with_differences(function, failing, problem):
    def weights(case, rng):
        return {"w": rng.uniform(-1, 1, (3, 2)), "b": rng.uniform(-1, 1, 2)}

    linear = Differentiated(
        drawn(weights=weights, x="rows 3"),
        lambda weights, x: x @ weights["w"] + weights["b"],
        ("weights",),
        ("y", PULLBACK),
    )
    gradients = {"of w": (2, ("w",)), "of both": (2,)}
    tried = differentiated_exercise(
        function, linear, SIZES, value="", gradients=gradients, float32=True
    )
    outcomes = {p.name: try_property(p, function) for p in tried.properties}
    assert {name for name, outcome in outcomes.items() if not outcome.held} == failing
    assert any(problem in outcome.problem for outcome in outcomes.values())


@pytest.mark.parametrize(
    ("found", "expected", "message"),
    [
        (None, np.ones(2), "is None: is a return missing"),
        ("two", np.ones(2), "is str, expected numbers"),
        (np.ones(3), np.ones(2), r"shape \(3,\), expected \(2,\)"),
        (np.ones(2), (1.0, 2.0), "it returns ndarray, expected a, b"),
        ((1.0, 3.0), (1.0, 2.0), "b is 3, expected 2"),
    ],
)
def test_a_difference_is_described(found, expected, message):
    with pytest.raises(AssertionError, match=message):
        require_same(found, expected, ("a", "b"))


def test_a_counterexample_too_long_to_print_is_returned_by_example():
    def locally(parents, rotations, translations):
        positions = translations.copy()
        for joint, parent in enumerate(parents):
            if parent != -1:
                bone = rotations[:, parent] @ translations[:, joint, :, None]
                positions[:, joint] = positions[:, parent] + bone[..., 0]
        return positions

    text = str(course.report("forward_kinematics", locally))
    assert "FAILED  value" in text
    assert 'example("forward_kinematics", frames=1, joints=3, seed=0)' in text
    example = course.example("forward_kinematics", frames=1, joints=3, seed=0)
    assert list(example) == ["parents", "rotations", "translations"]
    right = EXERCISES["forward_kinematics"].solution(**example)
    assert np.abs(locally(**example) - right).max() > 0.1
    with pytest.raises(ValueError, match="forward_kinematics has the sizes frames, joints, got fr"):
        course.example("forward_kinematics", frames=1, seed=0)


def test_every_exercise_has_two_hints_and_every_hint_an_exercise():
    hints = read_hints()
    assert list(hints) == list(EXERCISES)
    for name, made in EXERCISES.items():
        assert len(hints[name].stages) == 2
        hinted = with_hint(made, 2)
        of_properties = {prop.name: prop.hint for prop in hinted.properties if prop.hint}
        assert of_properties == hints[name].of_properties


def test_the_instructors_table_has_every_exercise_with_its_properties():
    text = Path(__file__).parents[2].joinpath("lessons", "README.md").read_text(encoding="utf-8")
    for number, exercises in LESSONS.items():
        for each in exercises:
            assert f"| {number} | `{each.name}` | {each.points} | {each.properties[0].name}" in text
