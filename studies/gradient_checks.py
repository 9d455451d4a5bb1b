"""`check_gradients` compared with the checks of PyTorch, JAX and autograd, as far as installed.

Functions with pullbacks written in NumPy, right and wrong, are wrapped for each library and checked
with its default settings (in reverse mode, which alone uses the pullback). Then the layers of small
projects in NumPy are tried as they are, and both versions, the wrong and the fixed one, of the
wrong gradients that libraries really had, also with the properties of `verify.properties_of` and
with differences of the sum of the outputs.
docs/verify.md and docs/historical_gradients.md have the tables:

    python -m studies gradient_checks
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from copy import deepcopy

import numpy as np

from studies.gradients.bugs import LAYERS, bugs
from studies.gradients.cases import RIGHT, WRONG
from studies.gradients.libraries import CHECKS, ON_BUGS, by_numpy_cae, verdict, with_arrays
from studies.shared.result import Result, Table


def run() -> Result:
    """Try every check on every function and every bug."""
    warnings.simplefilter("ignore")
    return Result("Checks of gradients", [_on_functions(), _on_layers(), *_on_bugs()])


def _on_functions() -> Table:
    """A row for each function, and how often each check was right."""
    rows = []
    for word, cases in (("right", RIGHT), ("wrong", WRONG)):
        for name, case in cases.items():
            verdicts = (judged(check, case, word == "right") for check in CHECKS.values())
            rows.append([name, word, *verdicts])
    return _counted("function", list(CHECKS), rows)


def _on_layers() -> Table:
    """A row for each layer of a small project, in the version that the project has."""
    rows = []
    for layer in bugs(LAYERS):
        said = [verdict(check, layer, fixed=False) for check in ON_BUGS]
        words = {layer.is_right: "right", not layer.is_right: "false alarm", None: "not installed"}
        words |= {} if layer.is_right else {True: "missed"}
        project, operation, thread = (layer.fields[n] for n in ("project", "operation", "thread"))
        word = "right" if layer.is_right else "wrong"
        rows.append([f"[{project}, {operation}]({thread})", word, *(words[each] for each in said)])
    return _counted("layer", list(ON_BUGS), rows)


def _counted(what: str, checks: list[str], rows: list[list[str]]) -> Table:
    """A table of verdicts, whose last row has how many of them were right."""
    counts = [sum(row[2 + i] == "right" for row in rows) for i in range(len(checks))]
    last = [f"right of {len(rows)}", "", *(count or "not installed" for count in counts)]
    return Table("", [what, "pullback", *checks], [*rows, last])


def _on_bugs() -> list[Table]:
    """A row for each bug, with the checks that miss it, and what each check found and refused."""
    found = dict.fromkeys(ON_BUGS, 0)
    refused = dict.fromkeys(ON_BUGS, 0)
    rows = []
    every = bugs()
    for bug in every:
        missed = []
        for check in ON_BUGS:
            accepted = verdict(check, bug, fixed=False)
            missed += [check] if accepted else []
            found[check] += accepted is False
            refused[check] += verdict(check, bug, fixed=True) is False
        project, thread, fix = (bug.fields[name] for name in ("project", "thread", "fix"))
        links = f"[{project}, {bug.fields['operation']}]({thread}) ([fix]({fix}))"
        rows.append([links, bug.fields["mistake"], ", ".join(missed)])
    of = f"of {len(every)}"
    header = ["check", f"wrong ones found, {of}", f"right ones refused, {of}"]
    counts = [[name, found[name] or "not installed", refused[name]] for name in ON_BUGS]
    return [Table("", ["wrong gradient", "mistake", "missed by"], rows), Table("", header, counts)]


def judged(check: Callable, case: tuple, is_right: bool) -> str:
    """What a check makes of a case."""
    f, *inputs = case
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        if check is not by_numpy_cae:
            f, inputs = with_arrays(f, tuple(inputs))
        passed = check(f, tuple(deepcopy(inputs)))
    except ImportError:
        return "not installed"
    except Exception as error:
        return type(error).__name__
    if passed == is_right:
        return "right"
    return "false alarm" if is_right else "missed"
