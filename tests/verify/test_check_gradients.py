from copy import deepcopy

import numpy as np
import pytest

from numpy_cae import ops
from numpy_cae.verify import check_adjoint, check_gradients
from studies.gradients.cases import RIGHT, WRONG


def judged(f, *inputs, **options):
    """What is wrong, or an empty text."""
    try:
        check_gradients(f, *inputs, **options)
    except (AssertionError, TypeError) as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("shape", "index", "error"),
    [((5, 20, 3), (3, 7, 1), 0.5), ((3, 4), (1, 2), 0.5), ((3, 4), (1, 2), 1e-5)],
)
def test_finds_one_wrong_entry_and_shows_both_numbers(shape, index, error):
    def sine(x):
        def pullback(dy):
            dx = dy * np.cos(x)
            dx[index] *= 1 + error
            return dx

        return np.sin(x), pullback

    problem = judged(sine, np.random.default_rng(0).uniform(-1, 1, shape))
    assert f"the gradient for x, shape {shape}, is wrong at index {index}" in problem
    assert "by the pullback" in problem and "by central differences" in problem


def test_does_not_excuse_the_only_entry():
    rectifier = lambda x: (np.maximum(x, 0), lambda dy: 0.7 * dy)  # noqa: E731
    with pytest.raises(AssertionError, match="has a kink in 1 of 1 entries"):
        check_gradients(rectifier, np.zeros(1))
    check_gradients(lambda x: (np.maximum(x, 0), lambda dy: dy * (x > 0)), np.array([0.0, 1.0]))


def test_does_not_excuse_many_kinks():
    problem = judged(lambda x: (np.maximum(x, 0), lambda dy: dy * (x >= 0)), np.zeros(30))
    assert "has a kink in 30 of 30 entries" in problem


@pytest.mark.parametrize("altered", ["x", "the upstream gradient"])
def test_rejects_an_altered_argument(altered):
    def doubled(x):
        def pullback(dy):
            dx = 2 * dy
            array = x if altered == "x" else dy
            array *= 0
            return dx

        return 2 * x, pullback

    assert f"{altered} was altered" in judged(doubled, np.ones(2))


@pytest.mark.parametrize(("kind", "count"), [(RIGHT, 22), (WRONG, 30)], ids=["right", "wrong"])
def test_the_functions_of_the_comparison_in_the_documentation_are_judged_right(kind, count):
    problems = {name: judged(f, *deepcopy(inputs)) for name, (f, *inputs) in kind.items()}
    assert len(problems) == count
    refused = {name for name, problem in problems.items() if problem}
    assert refused == (set(WRONG) if kind is WRONG else set())


def test_small_entries_of_a_large_array_are_checked_too():
    x = np.random.default_rng(0).standard_normal(500)
    x[::2] *= 1e-5
    slope = np.where(np.abs(x) < 1e-4, 2.1, 2) * x
    assert "wrong at index" in judged(lambda x: (x * x, lambda dy: dy * slope), x)
    assert judged(lambda x: (x * x, lambda dy: 2 * dy * x), x) == ""
    x[::50], x[1] = 0, 1e-20  # kinks
    assert judged(lambda x: (np.maximum(x, 0), lambda dy: dy * (x > 0)), x) == ""


def test_an_array_of_floats_is_wanted_and_what_is_none_may_get_none():
    scale = lambda x, n: (x * n, lambda dy: (dy * n, None))  # noqa: E731
    assert judged(scale, np.ones(2), 3) == judged(scale, np.ones(2), np.array([2, 3])) == ""
    assert "no argument is an array of float64 or float32" in judged(scale, 2, 3)
    assert "x must be an array of float64 or float32, not of" in judged(scale, 1j * np.ones(2), 3)


def test_a_number_and_parameters_in_lists_and_dicts_are_checked_and_integers_refused():
    def f(x, params, scale, places):
        w, b = params["layers"]
        y = x @ w

        def pullback(dy):
            dlayers = [scale * x.T @ dy, scale * dy.sum(axis=0) * wrong]
            return scale * dy @ w.T, {"layers": dlayers}, np.sum((y + b) * dy), of_places

        return scale * (y + b), pullback

    rng = np.random.default_rng(0)
    w = rng.standard_normal((3, 2))
    b = rng.standard_normal(2)
    inputs = rng.standard_normal((4, 3)), {"layers": (w, b)}, 0.7, np.array([1, 2])
    wrong = 1.0
    of_places = None
    assert judged(f, *inputs) == ""
    wrong = 3.0
    assert "gradient for params['layers'][1], shape (2,), is wrong" in judged(f, *inputs)
    wrong = 1.0
    of_places = np.ones(2)
    assert "places is an array of int64, shape (2,), which is not" in judged(f, *inputs)
    flat = lambda *a: (f(*a)[0], lambda dy: (dy, [dy], 1.0, None))  # noqa: E731
    assert "expected the structure of argument 1, a dict of 1" in judged(flat, *inputs)


def test_what_computes_in_float32_is_judged_with_its_precision():
    rng = np.random.default_rng(0)
    w = rng.standard_normal((5, 4)).astype(np.float32)
    layer = lambda x: (np.float64(np.float32(x) @ w), lambda dy: dy @ w.T)  # noqa: E731
    assert [judged(layer, x) for x in rng.standard_normal((20, 3, 5))] == 20 * [""]
    larger = lambda x: (layer(x)[0], lambda dy: 1.2 * dy @ w.T)  # noqa: E731
    assert "gradient for x, shape (3, 5), is wrong at" in judged(larger, np.ones((3, 5)))


def test_what_rounding_hides_is_never_wrong():
    hidden = lambda x: (np.r_[1e-8 * x, 1 / 3 + 1e-13 * x], lambda d: 1e-8 * d[:1] + 1e-13 * d[1:])  # noqa: E731
    assert judged(hidden, np.ones(1)) == ""  # no step is seen in the second output
    total = lambda x, w: (x.sum() * w, lambda dy: (np.sum(dy * w) + 0 * x, dy * x.sum()))  # noqa: E731
    assert "is undecided in 3" in judged(total, *np.float32([[0.1, 0.2, -0.3], [1, 2, 3]]))


def test_the_remainder_decides_where_a_tolerance_cannot():
    x = np.random.default_rng(0).standard_normal(50_000)
    slope = 2 * x
    slope[12_345] *= 0.97
    problem = judged(lambda x: (x * x, lambda dy: dy * slope), x)
    assert "wrong at index (12345,)" in problem
    assert "falls with the powers 1.00, 1.00" in problem
    assert judged(lambda x: (x * x, lambda dy: dy * 2 * x), x) == ""


def test_every_wrong_argument_is_named_and_each_output_has_a_gradient_of_its_own():
    x, w = np.random.default_rng(0).standard_normal((2, 3))
    problem = judged(lambda x, w: (x * w, lambda dy: (3 * dy * w, dy)), x, w)
    assert "gradient for x, shape (3,), is wrong" in problem.splitlines()[0]
    assert problem.splitlines()[-1].startswith("also: the gradient for w, shape (3,), is wrong")
    both = lambda x: ((1e6 * x.sum(), x.sum()), lambda dy: (1e6 * dy[0] + 2 * dy[1]) + 0 * x)  # noqa: E731
    for only in (None, ["x"]):
        assert "gradient for x from output 1, shape (3,), is wrong" in judged(both, x, only=only)
    assert "the value is complex" in judged(lambda x: (1j * x, lambda dy: 0 * x), x)


def test_adjoint_of_the_unpooling_holds_and_of_half_of_it_does_not():
    rng = np.random.default_rng(0)
    y = rng.standard_normal((2, 4, 3))
    dx = rng.standard_normal((2, 8, 3))
    check_adjoint(ops.unpool_even, y, dx)
    with pytest.raises(AssertionError, match="not the adjoint"):
        check_adjoint(lambda y: (np.repeat(y / 2, 2, axis=1), lambda dx: dx[:, ::2]), y, dx)


def test_names_of_arguments_come_from_the_caller_or_from_f_and_choose_what_is_checked():
    def half_wrong(angle, w):
        return angle * w, lambda dy: (dy, dy * angle)

    x, w = np.random.default_rng(0).standard_normal((2, 3))
    assert "gradient for angle" in judged(half_wrong, x, w)
    assert "gradient for argument 0" in judged(lambda *both: half_wrong(*both), x, w)
    assert "gradient for theta" in judged(half_wrong, x, w, names=["theta", "w"])
    assert judged(half_wrong, x, w, only=["w"]) == ""


@pytest.mark.parametrize(
    ("f", "problem"),
    [
        (lambda w: (w * 2, lambda dy: 2 * dy.T), r"has shape \(3, 2\), expected \(2, 3\)"),
        (lambda w: (w * 2, lambda dy: None), "returns None: is a return missing"),
        (lambda w: (w * 2, lambda dy: (dy.tolist(),)), "is a list, not an array"),
        (
            lambda w: (w * 2, lambda dy: np.where(w > 1, np.nan, 2 * dy)),
            r"for w is nan at index \(1, 0\)",
        ),
        (lambda w: (w * 2, lambda dy: (2 * dy, dy)), r"returns 2 .* expected 1"),
    ],
)
def test_what_is_no_gradient_is_told_so(f, problem):
    with pytest.raises(AssertionError, match=problem):
        check_gradients(f, np.array([[0.2, 0.3, 0.5], [2.0, 0.1, 0.7]]))


def test_repeated_gradients_may_differ_by_the_tolerance_and_the_numbers_are_shown():
    rng = np.random.default_rng(0)
    noisy = lambda x: (2 * x, lambda dy: 2 * dy * (1 + 1e-4 * rng.random()))  # noqa: E731
    x = np.array([1.0, 2.0])
    check_gradients(noisy, x, tolerance=1e-2)
    with pytest.raises(
        AssertionError, match=r"the gradient for x is .* at index \(\d,\), expected"
    ):
        check_gradients(noisy, x)
