"""Files of strangers: whatever they do, the grader survives it and says what it was."""

from __future__ import annotations

import json
import sys
import textwrap
import time

import pytest

from numpy_cae.cli import main
from numpy_cae.verify import grading
from numpy_cae.verify.sandbox import student

RIGHT = """
import numpy as np

def tanh(x):
    y = np.tanh(x)
    return y, lambda dy: dy * (1 - y * y)
"""


@pytest.fixture
def graded(tmp_path):
    def grade(source, **options):
        path = tmp_path / "student.py"
        path.write_text(textwrap.dedent(source), encoding="utf-8")
        return grading.grade(path, **options)

    return grade


def test_a_right_file_gets_all_points(graded):
    report = graded(RIGHT)
    assert report.held and report.points == report.possible == 10
    assert [r.operation for r in report.reports] == ["tanh"]


def test_a_wrong_derivative_is_named_with_counterexample(graded):
    report = graded(RIGHT.replace("y * y", "x * x"))
    assert not report.held and 0 < report.points < report.possible
    assert "1 - x², where it should be 1 - y²" in str(report)
    assert "smallest: batch 1, frames 1, channels 1" in str(report)


def test_a_function_is_tried_under_another_name(graded):
    report = graded(RIGHT.replace("def tanh", "def mine"), named={"tanh": "mine"})
    assert report.held and "mine as tanh" in str(report)


def test_a_name_that_is_not_there_fails_the_file(graded):
    report = graded(RIGHT, named={"conv1d": "mine"})
    assert report.faults == ["it has no function mine to try as conv1d"]


def test_a_file_without_operations_fails(graded):
    assert "no function bears an operation's name" in graded("x = 1").faults[0]


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("import torch", "line 2: torch"),
        ("from jax import vjp", "line 2: jax"),
        ("import numpy_cae.ops as ops", "line 2: numpy_cae.ops"),
        ("from numpy_cae import ops", "line 2: numpy_cae"),
        ("import importlib; t = importlib.import_module('torch.nn')", "line 2: torch.nn"),
        ("t = __import__('autograd')", "line 2: autograd"),
        ("m = __import__('numpy' + '_cae')", "refused: it imports numpy_cae"),
        ("import sys; sys.exit(0)", "at import it calls sys.exit"),
        ("raise SystemExit", "at import it calls sys.exit"),
        ("import os; os._exit(0)", "its process ended"),
        ("1 / 0", "at import: ZeroDivisionError: division by zero (line 2)"),
        ("raise KeyboardInterrupt", "at import: KeyboardInterrupt"),
        ("print('hello')", "at import it prints 'hello'"),
        ("import os; os.write(1, b'hello')", "at import it prints 'hello'"),
        ("import numpy as np; np.tanh = np.sin", "it alters NumPy itself: numpy.tanh"),
        ("import numpy as np; np.testing.assert_allclose = print", "it alters NumPy itself"),
        ("def broken(:", "it is not Python"),
    ],
)
def test_what_a_file_may_not_do_fails_it_alone(graded, line, fault):
    report = graded(f"\n{line}\n{RIGHT}")
    assert not report.held and report.points == 0
    assert fault in report.faults[0]


def test_self_tests_may_import_anything(graded):
    assert graded(RIGHT + "\nif __name__ == '__main__':\n    import torch\n    print(1)\n").held


def test_a_patched_numpy_cannot_reach_the_grader(graded):
    report = graded("""
        import numpy as np

        def tanh(x):
            np.allclose = lambda *a, **k: True
            np.array_equal = np.allclose
            return x, lambda dy: dy
    """)
    assert not report.held
    assert report.points < report.possible
    assert "alters NumPy itself: numpy.allclose" in report.faults[0]


def test_endless_loops_end(graded, monkeypatch):
    monkeypatch.setattr(student, "CALL_SECONDS", 1.0)
    begun = time.monotonic()
    assert "endless loop" in graded("while True: pass").faults[0]
    report = graded(RIGHT + "\ndef sigmoid(x):\n    while True: pass\n")
    assert [r.held for r in report.reports] == [True, False]
    assert "endless loop" in report.reports[1].outcomes[0].problem
    assert "not tried" in report.reports[1].outcomes[1].problem
    assert time.monotonic() - begun < 20


def test_the_time_limit_is_for_the_whole_file(graded):
    report = graded("import time\ntime.sleep(9)", seconds=0.5)
    assert "time limit" in report.faults[0]


@pytest.mark.skipif(sys.platform != "linux", reason="RLIMIT_AS binds on Linux only")
def test_memory_is_limited(graded):
    report = graded("import numpy as np\nx = np.ones(10**9)", megabytes=1500)
    assert "at import: MemoryError" in report.faults[0] or "its process ended" in report.faults[0]


def test_sys_exit_in_a_call_fails_that_property(graded):
    report = graded("import sys\ndef tanh(x):\n    sys.exit()\n")
    assert "it calls sys.exit" in str(report) and not report.held


def test_printing_in_a_call_is_a_fault(graded):
    report = graded(RIGHT.replace("y = np", "print('x is', x.shape); y = np"))
    assert "tanh prints 'x is" in report.faults[0]


def test_alterations_are_seen_across_processes(graded):
    report = graded(RIGHT.replace("y = np.tanh(x)", "y = np.tanh(x); x[...] = 0"))
    purity = next(o for o in report.reports[0].outcomes if o.property.name == "purity")
    assert "the call alters x" in purity.problem


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        ("return np.tanh(x)", "a tuple of an array and a function"),
        ("return 'y', lambda dy: dy", "it returns str, expected an array of floats"),
        ("return np.tanh(x), lambda dy: None", "is None, expected shape"),
        ("return np.tanh(x), lambda dy: (dy, dy)", "returns 2 gradient(s), expected 1"),
        ("return np.array([None]), lambda dy: dy", "expected an array of floats"),
        ("return np.sign(x).astype(int), lambda dy: dy", "array of int64, expected floats"),
        ("return UnknownName", "NameError: name 'UnknownName' is not defined (line 3)"),
    ],
)
def test_what_does_not_return_an_operation_is_told_so(graded, body, complaint):
    report = graded(f"import numpy as np\ndef tanh(x):\n    {body}\n")
    assert not report.held
    assert complaint in " ".join(str(report).split())


def test_a_garbled_answer_fails_the_file_only(graded):
    report = graded("""
        import os
        for descriptor in range(3, 20):
            try:
                os.write(descriptor, b"x" * 4096)
            except OSError:
                pass
    """)
    assert not report.held


def test_another_convention_is_reported_as_that(graded):
    report = graded("""
        import numpy as np

        def sigmoid_(a):
            return 1 / (1 + np.exp(-a))

        def gru_step(x, h, w, u, b, c):
            H = h.shape[1]
            a, s = x @ w + b, h @ u + c
            r, z = sigmoid_(a[:, :H] + s[:, :H]), sigmoid_(a[:, H:2*H] + s[:, H:2*H])
            n = np.tanh(a[:, 2*H:] + r * s[:, 2*H:])

            def pullback(g):
                dn = g * z * (1 - n * n)
                dz = g * (n - h) * z * (1 - z)
                dr = dn * s[:, 2*H:] * r * (1 - r)
                da, ds = np.hstack([dr, dz, dn]), np.hstack([dr, dz, dn * r])
                return da @ w.T, g * (1 - z) + ds @ u.T, x.T @ da, h.T @ ds, da.sum(0), ds.sum(0)

            return z * n + (1 - z) * h, pullback
    """)
    assert report.held
    assert "A right GRU, in another convention" in str(report)
    assert "z and 1 - z are exchanged" in str(report)


def test_the_command_prints_json_and_its_status_tells(tmp_path, capsys):
    right, wrong = tmp_path / "right.py", tmp_path / "wrong.py"
    right.write_text(RIGHT)
    wrong.write_text("import torch")
    assert main(["verify", str(right)]) == 0
    assert "10 of 10 points, every property held" in capsys.readouterr().out
    assert main(["verify", str(right), str(wrong), "--json"]) == 1
    files = json.loads(capsys.readouterr().out)
    assert [file["points"] for file in files] == [10, 0]
    names = [p["name"] for p in files[0]["operations"][0]["properties"]]
    assert "gradient for x" in names
    assert "refused" in files[1]["faults"][0]


def test_the_command_wants_a_file_that_is_there(tmp_path, capsys):
    assert main(["verify", str(tmp_path / "nowhere.py")]) == 2
    assert "nowhere.py" in capsys.readouterr().err
    right = tmp_path / "right.py"
    right.write_text(RIGHT)
    assert main(["verify", str(right), "--as", "convolve=tanh"]) == 2
    assert "no operation is called 'convolve'" in capsys.readouterr().err
