"""What a student sees of a report, in a notebook and elsewhere, and what is kept from them."""

import inspect

import numpy as np
import pytest

from numpy_cae import course, ops
from numpy_cae.course.stand_in import is_stand_in, stand_in


def talkative(x):
    print("shape", x.shape)
    y, pullback = ops.max_pool(x)
    return y, lambda dy: 2 * pullback(dy)


def test_what_a_function_prints_stays_small(capsys):
    tested = course.report("max_pool", talkative)
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == 11 and printed[0].startswith("shape") and "more lines" in printed[-1]
    assert is_stand_in(course.solved("max_pool", talkative))
    assert len(capsys.readouterr().out.splitlines()) == 1
    assert not tested.held and len(str(tested).splitlines()) <= 30
    assert "smallest: batch 1, frames 2, channels 1" in str(tested)  # x has two frames


def test_a_notebook_shows_the_first_failing_property_and_folds_the_rest():
    shown = course.report("max_pool", talkative)._repr_html_()
    before, _, folded = shown.partition("<details>")
    assert "FAILED  gradient for x" in before and "hint" not in before
    assert "hold: value" in folded and "ties" in folded and "hint=1" in folded
    right = course.report("unpool_even", ops.unpool_even)
    assert str(right) == f"unpool_even: all 9 properties hold{'20 of 20 points':>64}"
    assert "adjoint in y: &lt;A y, dy&gt;" in right._repr_html_().partition("<details>")[2]
    unsolved = course.report("unfold", stand_in("unfold"))
    assert "row t holds" in unsolved._repr_html_().partition("<details>")[2]


@pytest.mark.parametrize(
    ("name", "broken", "message"),
    [
        ("conv1d", lambda x, w, b: x, "expected a value and its pullback"),
        ("layer_loss", lambda *arguments: 0.0, "it returns float, expected 3: the loss, dw, db"),
        ("chain_to_root", lambda parents: parents, "takes 1 positional argument but 2 were given"),
        ("G", lambda y_0, y_1: unknown, "name 'unknown' is not defined"),  # noqa: F821
    ],
)
def test_a_broken_contract_gets_one_message(name, broken, message):
    tested = course.report(name, broken)
    assert tested.points == 0 and str(tested).count("what:") == 1
    assert message in " ".join(str(tested).split())
    assert len(tested.outcomes) == 1 or "not tried: " in str(tested)


def test_what_the_student_reads_is_no_riddle():
    """A wrong result of the student's own is never called expected; a wrong count is explained."""
    filled = course.report("complete", lambda x, known, p, *_: np.where(known, x, p(x.clip(-9))))
    assert "FAILED  nothing there: NaN in place of the unknown" in str(filled)
    assert str(filled).count("expected") == 2  # both are those of the value
    staged = course.report("stage_inputs", lambda x, layers: [x] * (len(layers) + 1))
    assert "returns is 2, expected 1: inputs[0]" in " ".join(str(staged).split())

    def in_place(x):
        x *= x
        return x, lambda dy: 2 * x * dy

    assert course.report("square", in_place).failing()[0].property_.name == "purity"


def test_tab_completion_and_source_show_no_solution():
    assert dir(course) == course.__all__
    assert dir(course.report("tanh", np.tanh)) == ["held", "points", "possible"]
    function = stand_in("conv1d")
    assert "solution(*arguments" in inspect.getsource(function)
    assert not hasattr(function, "__wrapped__")
    assert list(inspect.signature(function).parameters) == ["x", "w", "b"]
