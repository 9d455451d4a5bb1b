"""Real bugs of other projects: what six checks say of twenty operations, wrong and mended.

The operations are re-enacted in `studies/gradients/real_bugs.py`. The libraries' checks have their
default settings and one draw of numbers of shape (6, 4, 5) or its first axes; SciPy's compares the
slope of the sum of the outputs, times random numbers. docs/wrong_gradients.md has the table:

    python -m studies real_bugs
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable

import numpy as np
from scipy.optimize import check_grad

from numpy_cae import verify
from studies.gradient_checks import CHECKS
from studies.gradients.published import SIZES, PublishedOperation, size_of
from studies.gradients.real_bugs import REAL_BUGS
from studies.shared.result import Result, Table

LARGEST_ERROR = 1e-5
"""SciPy returns the norm of the error; it passes if it is at most so much of the gradient's."""


def run() -> Result:
    """Try every check on both versions of every operation."""
    warnings.simplefilter("ignore")
    rows = []
    for bug in REAL_BUGS:
        wrong = [verdict_on_wrong(check, bug) for check in ALL_CHECKS]
        mended = [check for check in ALL_CHECKS if accepts(check, bug, fixed=True) is False]
        name = f"{bug.project}, {bug.operation}"
        rows.append([name, bug.mistake, *wrong, ", ".join(mended)])
    return Result("Real bugs of other projects", [list_verdicts(rows), count_verdicts(rows)])


def list_verdicts(rows: list[list[str]]) -> Table:
    """A row for each operation."""
    return Table("", ["operation", "mistake", *ALL_CHECKS, "mended one refused by"], rows)


def count_verdicts(rows: list[list[str]]) -> Table:
    """How many wrong operations each check finds, and how many mended ones it refuses."""
    counts = []
    for column, check in enumerate(ALL_CHECKS, 2):
        found = sum(row[column] == "found" for row in rows)
        refused = sum(check in row[-1].split(", ") for row in rows)
        if any(row[column] == NOT_INSTALLED for row in rows):
            counts.append([check, NOT_INSTALLED, NOT_INSTALLED])
        else:
            counts.append([check, found, refused])
    of_all = f"of {len(rows)}"
    return Table(
        "", ["check", f"wrong ones found, {of_all}", f"mended ones refused, {of_all}"], counts
    )


def has_properties(f: Callable, bug: PublishedOperation) -> bool:
    """Whether every property holds; nothing but the shapes and the range is known of f."""
    for stated in verify.properties_of(f, bug.shapes, values=bug.ranges, dtypes=bug.dtypes):
        try:
            verify.check_property(stated, f)
        except AssertionError:
            return False
    return True


def passes_scipy(f: Callable, inputs: tuple) -> bool:
    """Whether `scipy.optimize.check_grad` has a small error for each argument."""
    value, _ = f(*inputs)
    dy = np.random.default_rng(1).standard_normal(np.shape(value))
    for place, x in enumerate(inputs):

        def slope_of(row: np.ndarray, place: int = place) -> tuple:
            arguments = list(inputs)
            arguments[place] = row.reshape(inputs[place].shape)
            value, pullback = f(*arguments)
            pulled = pullback(dy.copy() if dy.ndim else float(dy))
            gradients = pulled if isinstance(pulled, tuple) else (pulled,)
            return float(np.sum(dy * value)), np.ravel(gradients[place])

        def loss(row: np.ndarray, of: Callable = slope_of) -> float:
            return of(row)[0]

        def gradient(row: np.ndarray, of: Callable = slope_of) -> np.ndarray:
            return of(row)[1]

        error = check_grad(loss, gradient, np.ravel(x))
        if not error <= LARGEST_ERROR * max(1.0, float(np.linalg.norm(gradient(np.ravel(x))))):
            return False
    return True


ALL_CHECKS: dict[str, Callable] = {
    "properties_of": has_properties,
    **CHECKS,
    "scipy": passes_scipy,
}
NOT_INSTALLED = "not installed"


def inputs_of(bug: PublishedOperation) -> tuple[np.ndarray, ...]:
    """Standard normal numbers, or uniform ones where an argument has a range."""
    rng = np.random.default_rng(0)
    names = dict.fromkeys(re.findall(r"[a-z]\w*", " ".join(bug.shapes.values())))
    sizes = dict(zip(names, SIZES, strict=False))
    arrays = []
    for name, text in bug.shapes.items():
        shape = [size_of(size, sizes) for size in text.split()]
        if name in bug.ranges:
            arrays.append(rng.uniform(*bug.ranges[name], shape))
        else:
            arrays.append(rng.standard_normal(shape))
    return tuple(arrays)


def accepts(check: str, bug: PublishedOperation, fixed: bool) -> bool | None:
    """Whether a check accepts a version of an operation; None if the check is not installed."""
    f = bug.version(fixed)
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        if check == "properties_of":
            return has_properties(f, bug)
        return bool(ALL_CHECKS[check](f, inputs_of(bug)))
    except ImportError:
        return None
    except Exception:
        return False


def verdict_on_wrong(check: str, bug: PublishedOperation) -> str:
    """What a check says of the wrong version."""
    accepted = accepts(check, bug, fixed=False)
    if accepted is None:
        return NOT_INSTALLED
    return "missed" if accepted else "found"
