"""The check of a forward derivative: against differences of the value, and against the pullback."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from numpy_cae.verify.checks.calls import call_for_array, gradients_of_leaves
from numpy_cae.verify.checks.differences import SINGLE_TOLERANCE
from numpy_cae.verify.checks.gradients import check_gradients, names_of_arguments
from numpy_cae.verify.checks.leaves import has_gradient
from numpy_cae.verify.checks.messages import texts_that_differ
from numpy_cae.verify.checks.mismatch import require_shape

PRODUCT_TOLERANCE = 1e-10
"""Both inner products may differ by so much, relative to the norms of their factors."""
NUMBER_DIGITS = 10
"""The two inner products are printed with at least this many digits."""


def check_jvp(
    f: Callable,
    jvp: Callable,
    *inputs: np.ndarray,
    rng: np.random.Generator | None = None,
    tolerance: float = 1e-6,
) -> None:
    """Raise unless a forward derivative agrees with differences of f, and with its pullback.

    With J for the matrix of all derivatives, forward mode computes J v for a tangent v of the
    arguments, and the pullback Jᵀ dy. So <dy, J v> = <Jᵀ dy, v>, to rounding.

    Parameters
    ----------
    f : (*inputs) -> (value, pullback)
        In the form of `numpy_cae.ops`, with one array or number as its value.
    jvp : (*inputs) -> (value, pushforward)
        The pushforward takes a tangent in the shape of each array of floats, and returns the
        tangent of the value.
    *inputs : arrays of float64 or float32, and others
        Other arguments have no tangent.
    rng : numpy.random.Generator, optional
        For the tangents and the upstream gradient; the default has a fixed seed.
    tolerance : float
        Of the comparison with differences, as that of `check_gradients`.

    Raises
    ------
    AssertionError
        With the argument along which both numbers disagree, or where the values differ.
    TypeError
        If no input is an array of floats, or f or jvp does not return a value and a function.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae.verify import check_jvp
    >>> square = lambda x: (x * x, lambda dy: 2 * x * dy)
    >>> x = np.array([0.5, 2.0])
    >>> check_jvp(square, lambda x: (x * x, lambda v: 2 * x * v), x)
    >>> check_jvp(square, lambda x: (x * x, lambda v: 2 * v), x)
    Traceback (most recent call last):
    AssertionError: the forward derivative along x is not that of differences of the value
        ...
    """
    rng = np.random.default_rng(0) if rng is None else rng
    names = names_of_arguments(f, len(inputs))
    value, pullback = call_for_array(f, inputs)
    value_of_jvp, pushforward = call_for_array(jvp, inputs)
    _require_same_value(value_of_jvp, value)
    dy = rng.standard_normal(value.shape)
    gradients = gradients_of_leaves(inputs, names, pullback(dy.copy() if value.ndim else float(dy)))
    places = [place for place, x in enumerate(inputs) if has_gradient(names[place], x)]
    if not places:
        raise TypeError("no argument is an array of float64 or float32")
    is_single = any(inputs[place].dtype == np.float32 for place in places)
    for place in places:
        v = rng.standard_normal(inputs[place].shape)
        tangents = [v if other == place else np.zeros_like(inputs[other]) for other in places]
        pushed = np.asarray(pushforward(*tangents))
        require_shape(f"the forward derivative along {names[place]}", pushed, value.shape)
        _compare_with_differences(f, inputs, place, v, pushed, names[place], tolerance)
        allowed = SINGLE_TOLERANCE if is_single else PRODUCT_TOLERANCE
        _compare_products(dy, pushed, gradients[place], v, names[place], allowed)


def _require_same_value(value: np.ndarray, expected: np.ndarray) -> None:
    """Raise unless forward mode returns the value of f."""
    require_shape("the value of forward mode", value, expected.shape)
    if not np.allclose(value, expected, rtol=SINGLE_TOLERANCE, atol=0, equal_nan=True):
        raise AssertionError("forward mode returns another value than f")


def _compare_with_differences(
    f: Callable,
    inputs: Sequence,
    place: int,
    v: np.ndarray,
    pushed: np.ndarray,
    name: str,
    tolerance: float,
) -> None:
    """Compare J v with the slope of f along v, as the gradient of a function of one number."""

    def along(t: np.ndarray) -> tuple[Any, Callable]:
        moved = list(inputs)
        moved[place] = inputs[place] + t[0] * v
        value, _ = f(*moved)
        return value, lambda dy: np.array([np.sum(dy * pushed)])

    try:
        check_gradients(along, np.zeros(1), tolerance=tolerance)
    except AssertionError as error:
        first = f"the forward derivative along {name} is not that of differences of the value"
        numbers = "\n".join(str(error).splitlines()[1:3])
        numbers = numbers.replace("by the pullback    ", "by forward mode    ")
        raise AssertionError(f"{first}\n{numbers}") from None


def _compare_products(
    dy: np.ndarray,
    pushed: np.ndarray,
    gradient: np.ndarray,
    v: np.ndarray,
    name: str,
    allowed: float,
) -> None:
    """Compare <dy, J v> with <Jᵀ dy, v>."""
    forward = float(np.sum(dy * pushed))
    backward = float(np.sum(gradient * v))
    scale = np.linalg.norm(dy) * np.linalg.norm(pushed)
    scale += np.linalg.norm(gradient) * np.linalg.norm(v)
    if not abs(forward - backward) <= allowed * scale:
        texts = texts_that_differ(forward, backward, NUMBER_DIGITS)
        products = f"<dy, J v> = {texts[0]}, but <J' dy, v> = {texts[1]}"
        raise AssertionError(f"the pullback disagrees with forward mode along {name}: {products}")
