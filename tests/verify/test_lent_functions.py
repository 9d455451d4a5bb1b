"""Exercises that are given functions: those stay with the grader and are called from there.

Operations of the project are the exception, and run where the student calls them.
"""

import textwrap
import time

import numpy as np
import pytest

from numpy_cae import ops
from numpy_cae.verify.sandbox.student import Abandoned, Student


@pytest.fixture
def student(tmp_path):
    started = []

    def start(source, seconds=60.0, given=None):
        path = tmp_path / "student.py"
        path.write_text("import numpy as np\n" + textwrap.dedent(source), encoding="utf-8")
        process = Student(path, time.monotonic() + seconds, 2048)
        started.append(process)
        process.load(given)
        return process

    yield start
    for process in started:
        process.__exit__()


def test_a_lent_function_gives_value_and_pullback(student):
    slopes = student("""
        def slopes(f, x):
            value, pullback = f(x)
            return pullback(np.ones_like(value))
    """).function("slopes")
    x = np.array([0.5, -1.0])
    np.testing.assert_array_equal(slopes(ops.tanh, x), ops.tanh(x)[1](np.ones(2)))


def test_what_a_lent_function_raises_is_raised_in_the_students_process(student):
    tried = student("""
        def tried(f, x):
            try:
                f(x)
            except ValueError as error:
                return str(error)
    """).function("tried", numbers_only=False)
    assert "x has shape (2,)" in tried(ops.max_pool, np.ones(2))


def test_text_is_returned_where_it_may_be(student):
    process = student("def name(x): return 'y'")
    assert process.function("name", numbers_only=False)(np.ones(2)) == "y"
    with pytest.raises(TypeError, match="it returns str, expected an array of floats"):
        process.function("name")(np.ones(2))
    odd = student("def odd(x): return {1, 2}").function("odd", numbers_only=False)
    with pytest.raises(TypeError, match="it returns set"):
        odd(np.ones(2))


def test_an_array_altered_inside_a_dict_is_altered_here(student):
    process = student("""
        def spoil(f, inputs):
            inputs["x"] += 1
    """)
    inputs = {"x": np.zeros(2), "y": np.zeros(2)}
    process.function("spoil")(ops.tanh, inputs)
    assert inputs["x"].tolist() == [1, 1] and inputs["y"].tolist() == [0, 0]


def test_calling_for_ever_ends(student):
    process = student("def call(f, x):\n    while True: f(x)", seconds=1.5)
    with pytest.raises(Abandoned, match="time limit"):
        process.function("call")(ops.tanh, np.ones(2))


def test_a_lent_function_is_forgotten_and_none_is_there_that_was_not_lent(student):
    process = student("""
        kept = []

        def keep(f, x):
            kept.append(f)
            return x

        def again(x):
            return kept[0](x)[0]
    """)
    process.function("keep")(ops.tanh, np.ones(2))
    assert process.function("again")(np.ones(2)).shape == (2,)
    process.forget()
    with pytest.raises(IndexError):
        process.function("again")(np.ones(2))


def test_given_operations_run_in_the_students_process_without_the_package(student):
    names = ("gru", "linear", "mean_squared_error", "tanh")
    process = student(
        """
        import sys

        def same(x):
            return tanh(x)

        def found():
            return " ".join(name for name in sys.modules if name.startswith("numpy_cae"))

        def reached():
            return " ".join(sorted(tanh.__globals__))
        """,
        given={name: getattr(ops, name) for name in names},
    )
    assert process.functions == ["found", "reached", "same"]
    process._called_back = None  # nothing comes back to the grader
    y, pullback = process.function("same")(x := np.array([0.5, -1.0]))
    np.testing.assert_array_equal(y, np.tanh(x))
    np.testing.assert_array_equal(pullback(x), ops.tanh(x)[1](x))
    assert process.function("found", numbers_only=False)() == ""
    assert process.function("reached", numbers_only=False)() == "__builtins__ np require_shape"
