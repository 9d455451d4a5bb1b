"""The exact test of a linear operation's pullback: no differences, no step, no truncation.

A linear map A and its adjoint A' satisfy <A x, y> = <x, A' y> for every x and y, and the pullback
of a linear operation is its adjoint.
"""

from collections.abc import Callable

import numpy as np

from numpy_cae.verify.checks.call import gradients_of, require_shape


def check_adjoint(f: Callable, x: np.ndarray, y: np.ndarray, tolerance: float = 1e-12) -> None:
    """Raise unless <f(x), y> = <x, pullback(y)>.

    Parameters
    ----------
    f : x -> (value, pullback)
        Linear in x, with a gradient for x alone.
    x, y : arrays of float64
        An argument, and an array in the shape of f(x).
    tolerance : float
        Relative to |f(x)| |y| + |x| |pullback(y)|, which rounding is proportional to.

    Raises
    ------
    AssertionError
        With both inner products, or the shapes where they do not fit.

    Examples
    --------
    The adjoint of repeating each frame adds up the two frames of each pair.

    >>> import numpy as np
    >>> from numpy_cae.verify import check_adjoint
    >>> x, y = np.array([1.0, 2.0]), np.array([1.0, 2.0, 3.0, 5.0])
    >>> check_adjoint(lambda x: (np.repeat(x, 2), lambda dy: dy[::2] + dy[1::2]), x, y)
    >>> check_adjoint(lambda x: (np.repeat(x, 2), lambda dy: dy[::2]), x, y)
    Traceback (most recent call last):
    AssertionError: the pullback is not the adjoint: <A x, y> = 19, but <x, A' y> = 7
    """
    value, pullback = f(x)
    require_shape("the value", value, np.shape(y))
    (pulled,) = gradients_of(pullback(y), 1)
    require_shape("what the pullback returns", pulled, np.shape(x))
    forward = float(np.sum(value * y))
    backward = float(np.sum(x * pulled))
    scale = np.linalg.norm(value) * np.linalg.norm(y) + np.linalg.norm(x) * np.linalg.norm(pulled)
    if not abs(forward - backward) <= tolerance * scale:
        raise AssertionError(
            f"the pullback is not the adjoint: <A x, y> = {forward:.12g}, "
            f"but <x, A' y> = {backward:.12g}"
        )
