"""mine.py: what a solved function leaves there, and what later lessons import of it."""

import json
import linecache
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from numpy_cae import course
from numpy_cae.course.mine_file import EMPTY, with_definitions
from numpy_cae.course.stand_in import is_stand_in, stand_in
from tools.execute_lessons import mine_before

CELL = "%time\n" + Path(__file__).with_name("cell_of_mine.py").read_text()
SGD_STEP = """
def sgd_step(parameter, gradient, rate, decay, epoch):
    return parameter - rate * decay**epoch * gradient
"""


def in_cell(name: str, source: str, **others):
    """A function that a cell defines, as a kernel does it."""
    file = f"<cell of {name} {len(linecache.cache)}>"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    space = {"np": np, "__name__": "__main__", **others}
    exec(compile(source.replace("%time", ""), file, "exec"), space)
    return space[name]


sgd_step = in_cell("sgd_step", SGD_STEP)
without_def = in_cell("sgd_step", "sgd_step = lambda p, g, r, d, e: p - r * d**e * g")
needs_one = in_cell("sgd_step", SGD_STEP.replace("epoch *", "epoch * ONE *"), ONE=1)


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """mine.py in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = Path("mine.py")
    path.write_text(EMPTY)
    monkeypatch.setitem(sys.modules, "mine", None)
    return path


def test_a_solved_function_is_imported_by_later_lessons(mine, capsys):
    course.solved("unpool_even", in_cell("unpool_even", CELL))
    course.solved("sgd_step", sgd_step)
    assert "later lessons (mine.py) use your function" in capsys.readouterr().out
    course.load_mine()
    from mine import conv1d
    from mine import unpool_even as saved

    assert capsys.readouterr().out == "conv1d is not in mine.py yet: the package's own is used.\n"
    assert is_stand_in(conv1d) and saved.__module__ == "mine"
    assert course.report("unpool_even", saved).held
    with pytest.raises(ImportError):
        from mine import conv_1d  # noqa: F401


def test_a_later_version_replaces_the_earlier_one(mine):
    course.solved("sgd_step", sgd_step)
    mine.write_text(mine.read_text() + 'NOTE = "a line of the student"\n')
    course.solved("sgd_step", lambda *arguments: None)  # wrong: the earlier version stays
    course.solved("sgd_step", sgd_step)
    assert mine.read_text().count("def sgd_step") == 1 and "NOTE" in mine.read_text()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import numpy\n\ndef f(:\n", "SyntaxError: invalid syntax (mine.py, line 3)"),
        ("x = 1\ny = z\n", "NameError: name 'z' is not defined (line 2)"),
        (None, "There is no mine.py"),
        (EMPTY + SGD_STEP, ""),  # while nbgrader runs the notebook
    ],
)
def test_the_packages_own_are_used_and_the_file_is_kept(text, message, mine, monkeypatch, capsys):
    mine.write_text(text) if text else mine.unlink()
    if not message:
        monkeypatch.setenv("NBGRADER_EXECUTION", "autograde")
    course.load_mine()
    from mine import sgd_step as imported

    assert is_stand_in(imported) and message in capsys.readouterr().out
    course.solved("sgd_step", sgd_step)
    printed = capsys.readouterr().out
    assert message in printed or text is None
    assert (mine.read_text() if mine.exists() else None) == text


@pytest.mark.parametrize(
    ("function", "problem"),
    [
        (without_def, "no def sgd_step"),
        (partial(sgd_step), "no def sgd_step"),
    ],
)
def test_what_would_not_work_is_not_written(function, problem, mine, capsys):
    assert course.solved("sgd_step", function) is function
    assert f"not saved to mine.py: {problem}" in capsys.readouterr().out
    assert mine.read_text() == EMPTY
    assert "import tanh" not in with_definitions(EMPTY, "from mine import tanh\n" + SGD_STEP)


def test_a_helper_in_another_cell_is_named_at_once(mine, capsys):
    report = course.report("sgd_step", needs_one)
    printed = capsys.readouterr().out
    assert (
        "ONE is defined in another cell. The grader and later lessons have the cell of" in printed
    )
    assert report.points == 0 and "name 'ONE' is not defined" in str(report)


def test_a_function_with_a_helper_in_another_cell_is_not_solved(mine, capsys):
    assert is_stand_in(course.solved("sgd_step", needs_one))
    assert mine.read_text() == EMPTY


COMPUTED = """
unused = rate_of_nothing
base = np.array([1.0])
ONE = base[0] / 1


def sgd_step(parameter, gradient, rate, decay, epoch):
    unused = rate
    return parameter - unused * decay ** (ONE * epoch) * gradient
"""


def test_what_the_cell_computes_for_its_function_is_saved(mine, capsys):
    in_kernel = in_cell("sgd_step", COMPUTED, rate_of_nothing=0)
    assert course.report("sgd_step", in_kernel).held
    assert course.solved("sgd_step", in_kernel) is in_kernel
    assert "ONE = base[0] / 1" in mine.read_text() and "rate_of_nothing" not in mine.read_text()


def test_what_a_cell_computed_is_replaced_with_its_function(mine):
    for _ in range(2):
        course.solved("sgd_step", in_cell("sgd_step", COMPUTED, rate_of_nothing=0))
    assert mine.read_text().count("ONE = ") == 1


def test_a_helper_that_only_the_pullback_calls_is_named(mine, capsys):
    source = "def tanh(x):\n    y = np.tanh(x)\n    return y, lambda dy: dy * slope(y)\n"
    tanh = in_cell("tanh", source, slope=lambda y: 1 - y * y)
    report = course.report("tanh", tanh)
    assert "slope is defined in another cell" in capsys.readouterr().out
    assert report.points == 4  # of the value


def test_a_cell_that_imports_the_package_has_no_points(mine, capsys):
    source = "def sgd_step(*arguments):\n    import numpy_cae\n    return arguments[0]\n"
    assert course.report("sgd_step", in_cell("sgd_step", source)).points == 0
    assert "the grader refuses the import of numpy_cae" in capsys.readouterr().out


def test_a_function_of_another_name_has_no_points(mine, capsys):
    source = SGD_STEP.replace("sgd_step", "my_step")
    assert course.report("sgd_step", in_cell("my_step", source)).points == 0
    assert "what a `def sgd_step` defines" in capsys.readouterr().out


def test_progress_counts_what_is_in_mine(mine, capsys):
    lesson = Path(__file__).parents[2] / "lessons" / "02_what_to_learn_from.ipynb"
    mine.write_text(mine_before(lesson), encoding="utf-8")
    course.progress()
    count, made, after = capsys.readouterr().out.splitlines()
    assert count == "5 of 63 functions are yours" and made.endswith("positions from a motion file.")
    assert after == "Next: the features and the way back (lesson 02)."


def test_an_attempt_under_another_name_is_reported(mine, capsys):
    source = "def my_tanh(x):\n    y = np.tanh(x)\n    return y, lambda dy: 1 - y * y\n"
    report = str(course.report("tanh", in_cell("my_tanh", source)))
    assert "0 of 0 points" in report
    assert "FAILED  gradient for x" in report
    assert "hold: value" in report


def test_lesson_07_lists_what_is_the_packages_own(mine, capsys):
    lesson = Path(__file__).parents[2] / "lessons" / "07_going_deep.ipynb"
    cells = {
        cell["id"]: "".join(cell["source"]) for cell in json.loads(lesson.read_text())["cells"]
    }
    mine.write_text("def conv1d(x, w, b):\n    return x\n", encoding="utf-8")
    course.load_mine()
    names = {"course": course, "stack_loss": stand_in("stack_loss")}
    names["stage_inputs"] = stand_in("stage_inputs")
    exec(cells["own-functions"], names)
    exec(cells["whose"], names)
    lines = [line.split(maxsplit=1) for line in capsys.readouterr().out.splitlines()]
    own = {line[0] for line in lines if line[1] == "the package's own"}
    assert ["conv1d", "yours"] in lines
    assert {"max_pool", "tanh", "encode_layer", "stack_loss"} <= own
