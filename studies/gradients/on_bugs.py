"""The checks that are tried on the wrong gradients of libraries.

They are those of `libraries`, the properties of `verify.properties_of`, and differences of the sum
of the outputs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae import verify
from studies.gradients.bugs import Bug
from studies.gradients.libraries import CHECKS as LIBRARIES


def by_properties(f: Callable, bug: Bug) -> bool:
    """Whether every property holds; nothing but the shapes and the domain is known of f.

    Small projects do not promise to keep float32.
    """
    options = {"skip": ("dtype",) if bug.is_layer else (), "dtypes": bug.dtypes}
    for stated in verify.properties_of(f, bug.shapes, values=bug.ranges, **options):
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


CHECKS: dict[str, Callable] = {"properties": by_properties, **LIBRARIES, "all ones": by_ones}


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
