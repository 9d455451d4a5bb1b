"""The report of a notebook, and what it needs."""

import re
import sys
from dataclasses import replace

import numpy as np
import pytest

from numpy_cae import ops, verify
from numpy_cae.verify.grading.report import report, report_of
from numpy_cae.verify.operations.operation_catalogue import find_exercise
from numpy_cae.verify.operations.trial import C_ORDER, try_property


def my_conv1d(x, w, b):
    y, pullback = ops.conv1d(x, w, b)
    return y, lambda dy: (pullback(dy)[0], pullback(dy)[1], dy.mean(axis=(0, 1)))


def test_a_report_shows_points_counterexample_and_mistake():
    report = verify.report("conv1d", my_conv1d)
    assert (report.points, report.possible, report.held) == (6, 16, False)
    failed, special = (outcome for outcome in report.outcomes if not outcome.held)
    assert (failed.property_.name, special.property_.name) == ("gradient for b", "special inputs")
    assert special.counterexample.startswith("batch 1, frames 2, channels 1, filters 1, taps 1")
    assert failed.mistake == ""  # no planted bug takes the mean over windows and frames
    text = str(report)
    assert text.splitlines()[0].startswith("my_conv1d as conv1d")
    assert text.splitlines()[0].endswith("6 of 16 points")
    assert "FAILED  gradient for b" in text and "hold: value, gradient for x" in text
    assert max(map(len, text.splitlines())) <= 100


def problem_of(operation, name, function):
    """What a report says about one property."""
    tried = next(prop for prop in verify.properties(operation) if prop.name == name)
    outcome = try_property(replace(tried, examples=5), function, shrink=False)
    return " ".join(outcome.problem.split())


def test_one_reason_is_told_once_and_the_same_every_time():
    text, again = (str(verify.report("tanh", lambda x: 1 / 0)) for _ in range(2))
    assert text == again
    assert text.count("ZeroDivisionError") == 1
    assert "not tried: gradient for x" in text and "hold" not in text
    assert "tanh: all 9 properties hold" in str(verify.report("tanh", ops.tanh))


@pytest.mark.parametrize(
    ("tanh", "complaint"),
    [
        (lambda x: np.tanh(x), "a tuple of an array and a function"),
        (lambda x: (np.tanh(x), None), "TypeError: expected a value and its pullback"),
        (lambda x: ("y", lambda dy: dy), "expected a value of floats, got str"),
        (lambda x: (np.tanh(x), lambda dy: None), "returns None: is a return missing"),
        (lambda x: (np.tanh(x), lambda dy: (dy, dy)), "returns 2 gradient(s), expected 1"),
        (lambda x: (np.array([None]), lambda dy: dy), "of floats, got an array of object"),
        (lambda x: (np.sign(x).astype(int), lambda dy: dy), "of floats, got an array of int64"),
        (lambda x: unknown, "NameError: name 'unknown' is not defined (line "),  # noqa: F821
        (lambda x: sys.exit(), "it calls sys.exit (line"),
    ],
)
def test_what_does_not_return_an_operation_is_told_so(tanh, complaint):
    assert complaint in problem_of("tanh", "gradient for x", tanh)


def off_by_little(x):
    y, pullback = ops.tanh(x)
    off = np.where(np.arange(x.size).reshape(x.shape) == 1, 2e-8, 1e-9)
    return y, lambda dy: pullback(dy) + off


def test_an_altered_upstream_gradient_is_told_first_and_no_wrong_adjoint():
    alters = lambda y: (ops.unpool_even(y)[0], lambda d: (ops.unpool_even(y)[1](d), d.fill(0))[0])  # noqa: E731
    assert verify.report("unpool_even", alters).failing()[0].property_.name == "purity"


def test_numbers_have_the_digits_that_differ_and_the_worst_entry_is_shown():
    text = problem_of("tanh", "gradient for x", off_by_little)
    number, expected = re.search(r"is (\S+) at index .*, expected (\S+)", text).groups()
    assert 1e-9 < abs(float(number) - float(expected)) < 3e-8


def test_both_upstream_gradients_of_linearity_are_shown():
    tried = next(prop for prop in verify.properties("tanh") if prop.name == "linearity")
    wrong = lambda x: (np.tanh(x), lambda dy: abs(dy) * (1 - np.tanh(x) ** 2))  # noqa: E731
    outcome = try_property(tried, wrong)
    assert "dy = [[[" in outcome.counterexample and "\ndy' = [[[" in outcome.counterexample


def naive_sigmoid(x):
    y = 1 / (1 + np.exp(-x))
    return y, lambda dy: dy * y * (1 - y)


@pytest.mark.filterwarnings("default")
def test_an_overflow_is_a_warning_and_costs_nothing():
    with pytest.warns(RuntimeWarning, match="overflow encountered in exp"):
        assert verify.report("sigmoid", naive_sigmoid).held
        verify.check_gradients(naive_sigmoid, np.array([0.5, -1000.0]))


def test_smaller_cases_are_called_right_only_where_one_was_tried():
    exercise = find_exercise("tanh")
    first, second, *_ = exercise.properties[0].cases()
    for case, is_said in ((first, False), (second, True)):
        reply = {"failed": "it did not finish", "outcomes": [], "trying": str(case)}
        text = str(report_of(exercise, reply))
        assert ("smaller cases were right" in text) == is_said, text


def test_c_order_is_named_only_where_arrays_in_c_order_give_the_right_result():
    def two_gradients(x_hat, x):
        value, pullback = ops.mean_squared_error(x_hat, x)
        return value, lambda dloss=1.0: (pullback(dloss), -pullback(dloss))

    def read_in_c_order(x):
        _, pullback = ops.tanh(x)
        return np.tanh(np.ravel(x, "K")).reshape(x.shape), pullback

    mistakes = []
    for name, wrong in (("mean_squared_error", two_gradients), ("tanh", read_in_c_order)):
        named = {prop.name: prop for prop in find_exercise(name).properties}
        mistakes.append(try_property(named["strides"], wrong).mistake)
    assert C_ORDER not in mistakes[0] and mistakes[1] == C_ORDER


def test_another_shape_is_no_loss_of_digits():
    def linear_of_rows(x, w, b):
        y, pullback = ops.linear(x, w, b)
        return np.atleast_2d(y), lambda dy: pullback(dy.reshape(y.shape))

    text = str(report("linear", linear_of_rows))
    assert "has shape" in text and "Digits are lost" not in text


def test_what_fails_once_only_is_called_unsteady_with_its_first_error():
    calls = []

    def overflows_once(x):
        calls.append(x)
        if len(calls) == 1:
            raise RuntimeWarning("overflow encountered in matmul")
        return ops.tanh(x)

    outcome = try_property(find_exercise("tanh").properties[0], overflows_once)
    assert not outcome.held and "it returns something else; at first: " in outcome.problem
    assert "RuntimeWarning: overflow encountered in matmul" in outcome.problem
