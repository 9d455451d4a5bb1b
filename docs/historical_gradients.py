"""Which check would have found the wrong gradients that deep learning libraries really had?

Each file of tests/verify/historical re-enacts one of them in NumPy: the links to the public thread
and to the fix, the shapes of the arguments, and a function in which the lines with a minus are
those of the wrong version and the lines with a plus those of the fixed one. This script tries both
versions with the properties of `verify.properties_of`, with `check_gradients`, with the checks of
PyTorch, JAX and autograd, as far as installed, and with differences of the sum of the outputs.
docs/historical_gradients.md has the table that this prints:

    python docs/historical_gradients.py
"""

from __future__ import annotations

import re
import runpy
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae import verify

HERE = Path(__file__).parent
FOLDER = HERE.parent / "tests" / "verify" / "historical"
SIZES = (6, 4, 5)
"""The sizes of the first, second and third axis of the arrays that checks of one point get."""


def in_memory_order(array: np.ndarray) -> np.ndarray:
    """The array as a kernel reads it that takes it for contiguous: the numbers behind its first.

    Where its memory ends, zeros follow.
    """
    owner = array
    while isinstance(owner.base, np.ndarray):
        owner = owner.base
    starts = [a.__array_interface__["data"][0] for a in (owner, array)]
    memory = owner.ravel(order="K")[(starts[1] - starts[0]) // array.itemsize :][: array.size]
    return np.append(memory, np.zeros(array.size - memory.size, array.dtype)).reshape(array.shape)


@dataclass(frozen=True)
class Bug:
    """A wrong gradient of a library, re-enacted."""

    name: str
    fields: dict[str, str]  # project, operation, thread, fix, mistake, shapes, values
    code: str

    @property
    def shapes(self) -> dict[str, str]:
        """The shape of each argument, such as {"x": "batch channels"}."""
        return self._pairs("shapes")

    @property
    def ranges(self) -> dict[str, tuple[float, ...]]:
        """The range of an argument, where it is not -2 to 2."""
        return {name: tuple(map(float, v.split())) for name, v in self._pairs("values").items()}

    def _pairs(self, field: str) -> dict[str, str]:
        pairs = (part.split("=") for part in self.fields.get(field, "").split(",") if part)
        return {name.strip(): text.strip() for name, text in pairs}

    def function(self, fixed: bool) -> Callable:
        """The operation, with the lines of the wrong or of the fixed version."""
        kept, dropped = ("+", "-") if fixed else ("-", "+")
        lines = [line for line in self.code.splitlines() if not line.startswith(dropped)]
        source = "\n".join(" " + line[1:] if line.startswith(kept) else line for line in lines)
        namespace = {"np": np, "in_memory_order": in_memory_order}
        exec(compile(source, f"<{self.name}>", "exec"), namespace)
        return namespace[re.match(r"def (\w+)", source)[1]]

    def inputs(self) -> tuple[np.ndarray, ...]:
        """Standard normal numbers: what the documentation of each library gives to its check."""
        rng = np.random.default_rng(0)
        names = dict.fromkeys(" ".join(self.shapes.values()).split())
        sizes = dict(zip(names, SIZES, strict=False))
        shapes = (tuple(sizes[size] for size in shape.split()) for shape in self.shapes.values())
        return tuple(rng.standard_normal(shape) for shape in shapes)


def bugs() -> list[Bug]:
    """Every historical bug, in the order of the names."""
    return [_read(path) for path in sorted(FOLDER.glob("*.txt"))]


def _read(path: Path) -> Bug:
    header, code = path.read_text(encoding="utf-8").split("\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.splitlines())
    return Bug(path.stem, fields, code)


def by_properties(f: Callable, bug: Bug) -> bool:
    """Whether every property holds; nothing but the shapes and the domain is known of f."""
    for stated in verify.properties_of(f, bug.shapes, values=bug.ranges):
        try:
            verify.check_property(stated, f)
        except AssertionError:
            return False
    return True


def by_ones(f: Callable, inputs: tuple) -> bool:
    """Stanford's CS231n: `eval_numerical_gradient_array(f, x, df)` with ones for df.

    The differences, with steps of 1e-5, are those of the sum of the outputs. (The notebooks of the
    course pass random numbers for df; ones are what `y.sum().backward()` passes.)
    """
    value, pullback = f(*inputs)
    df = np.ones_like(value)
    pulled = pullback(df.copy())
    gradients = pulled if isinstance(pulled, tuple) else (pulled,)
    for x, gradient in zip(inputs, gradients, strict=True):
        numeric = np.zeros_like(x)
        for entry in np.ndindex(x.shape):
            kept = x[entry]
            x[entry] = kept + 1e-5
            ahead = np.copy(f(*inputs)[0])
            x[entry] = kept - 1e-5
            behind = np.copy(f(*inputs)[0])
            x[entry] = kept
            numeric[entry] = np.sum((ahead - behind) * df) / 2e-5
        if numeric.shape != gradient.shape or not np.allclose(numeric, gradient):
            return False
    return True


LIBRARIES = runpy.run_path(str(HERE / "compare_gradient_checks.py"))["CHECKS"]
CHECKS: dict[str, Callable] = {
    "properties": by_properties,
    **LIBRARIES,
    "all ones": by_ones,
}


def verdict(check: str, bug: Bug, fixed: bool) -> bool | None:
    """Whether a check accepts a version of a bug's operation; None if it is not installed."""
    f = bug.function(fixed)
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        return CHECKS[check](f, bug if check == "properties" else bug.inputs())
    except ImportError:
        return None
    except Exception:
        return False


def main() -> None:
    """Print a row for each bug, with the checks that miss it, and what each found and refused."""
    warnings.simplefilter("ignore")
    print("| wrong gradient | mistake | missed by |\n|---|---|---|")
    found, refused, every = dict.fromkeys(CHECKS, 0), dict.fromkeys(CHECKS, 0), bugs()
    for bug in every:
        missed = []
        for check in CHECKS:
            accepted = verdict(check, bug, fixed=False)
            missed += [check] if accepted else []
            found[check] += accepted is False
            refused[check] += verdict(check, bug, fixed=True) is False
        project, thread, fix = (bug.fields[name] for name in ("project", "thread", "fix"))
        links = f"[{project}, {bug.fields['operation']}]({thread}) ([fix]({fix}))"
        print(f"| {links} | {bug.fields['mistake']} | {', '.join(missed)} |", flush=True)
    of = f"of {len(every)}"
    print(f"\n| check | wrong ones found, {of} | right ones refused, {of} |\n|---|--:|--:|")
    for check in CHECKS:
        print(f"| {check} | {found[check]} | {refused[check]} |")


if __name__ == "__main__":
    main()
