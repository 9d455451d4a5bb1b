"""The check of second derivatives: the pullback of a pullback against differences of gradients."""

from collections.abc import Callable
from typing import Any

import numpy as np

from numpy_cae.verify.checks.calls import call_for_array
from numpy_cae.verify.checks.gradients import check_gradients, names_of_arguments

UPSTREAM_NAME = "dy"
"""The name of the upstream gradient in messages: the last argument of the pullback's pullback."""


def check_second_derivatives(
    f: Callable,
    second: Callable,
    *inputs: Any,
    rng: np.random.Generator | None = None,
    tolerance: float = 1e-6,
) -> None:
    """Raise unless the pullback of f's pullback agrees with differences of f's gradients.

    The gradients of f are a function of its arguments and of dy. `second` returns the pullback of
    that function: for a loss it is the product of the Hessian with a vector.

    Parameters
    ----------
    f : (*inputs) -> (value, pullback)
        In the form of `numpy_cae.ops`, with one array or number as its value.
    second : (*inputs, dy) -> pullback
        The pullback takes what the pullback of f returns, one array or a tuple, and returns the
        gradient for each array of floats among the arguments, and last that for dy.
    *inputs : arrays of float64 or float32, and others
    rng : numpy.random.Generator, optional
        For the upstream gradients; the default has a fixed seed.
    tolerance : float
        As that of `check_gradients`.

    Raises
    ------
    AssertionError
        With the argument, the index and both numbers where they disagree.
    TypeError
        If no input is an array of floats, or f does not return a value and its pullback.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae.verify import check_second_derivatives
    >>> cube = lambda x: (x**3, lambda dy: 3 * x**2 * dy)
    >>> x = np.array([0.5, 2.0])
    >>> check_second_derivatives(
    ...     cube, lambda x, dy: lambda v: (6 * x * dy * v, 3 * x**2 * v), x
    ... )
    >>> check_second_derivatives(cube, lambda x, dy: lambda v: (6 * x * v, 3 * x**2 * v), x)
    Traceback (most recent call last):
    AssertionError: of the gradients of f: the gradient for x, shape (2,), is wrong at index (1,)
        ...
    """
    rng = np.random.default_rng(0) if rng is None else rng
    value, _ = call_for_array(f, inputs)
    dy = rng.standard_normal(value.shape)

    def gradients(*arguments: Any) -> tuple[Any, Callable]:
        *arguments_of_f, upstream = arguments
        _, pullback = f(*arguments_of_f)
        return pullback(upstream), second(*arguments_of_f, upstream)

    names = [*names_of_arguments(f, len(inputs)), UPSTREAM_NAME]
    try:
        check_gradients(
            gradients, *inputs, np.asarray(dy), rng=rng, tolerance=tolerance, names=names
        )
    except AssertionError as error:
        raise AssertionError(f"of the gradients of f: {error}") from None
