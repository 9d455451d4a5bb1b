"""The classes of upstream gradients that pullbacks are tried with."""

from collections.abc import Callable

import numpy as np

from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.values import LAYOUTS, ORDINARY, spread

Upstream = np.ndarray | float

THE_UPSTREAM = "the upstream gradient"
"""Its name among the inputs of a call, where it follows the arguments."""


def _single_entry(rng: np.random.Generator, dy: np.ndarray) -> np.ndarray:
    """One entry of the array, 0 in all others."""
    return np.where(np.arange(dy.size).reshape(dy.shape) == rng.integers(dy.size), dy, 0.0)


NUMBERS: dict[str, float] = {
    "zeros": 0,
    "integers": -3,
    "random": 0.7,
    "sparse": 0.0,
    "strided": 1.7,
    "constant": 1,
    "large": 1e3,
    "tiny": 1e-5,
}
"""The upstream number of a value that is a number, by class."""
ARRAYS: dict[str, Callable[[np.random.Generator, np.ndarray], np.ndarray]] = {
    "integers": lambda rng, dy: rng.choice([-3.0, 1.0, 2.0], dy.shape),
    "random": lambda rng, dy: rng.uniform(-8, 8, dy.shape),
    "sparse": _single_entry,
    "strided": lambda rng, dy: LAYOUTS["every other entry"](dy),
    "constant": lambda rng, dy: np.broadcast_to(2.0, dy.shape),
}
"""How the upstream gradient of an array is made of ordinary entries, by class.

Those of all other classes are the ordinary entries times the number of the class.
"""
UPSTREAM: dict[str, tuple] = {"upstream": (ORDINARY, *NUMBERS)}
"""One class of upstream gradients: of arrays, or of numbers if the value is a number."""


def draw_upstream(case: Case, value: Upstream) -> Upstream:
    """An upstream gradient for a value, of the case's class; never all ones if ordinary.

    That of a number is a Python number, which leaves float32 arrays float32.
    """
    rng = np.random.default_rng([case.seed, 1])
    kind = case.get("upstream")
    if not np.shape(value):
        return NUMBERS.get(kind, float(rng.uniform(1.5, 2.5)))
    dy = spread(rng, np.shape(value))
    if kind in ARRAYS:
        dy = ARRAYS[kind](rng, dy)
    else:
        dy = dy * NUMBERS.get(kind, 1)
    return dy.astype(np.float32) if np.asarray(value).dtype == np.float32 else dy


def copy_upstream(dy: Upstream) -> Upstream:
    """An upstream gradient that the pullback may overwrite."""
    return dy.copy() if isinstance(dy, np.ndarray) else dy
