"""The type of a pullback, and the check of an argument's shape.

A wrong shape that broadcasts gives wrong results without an error, so every operation checks first
and names the argument, the shape it has and the expected shape.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

Pullback = Callable[..., Any]
"""Takes dL/dy, which has the shape of y, and returns dL/dx for each array that is differentiated:
one array, or a tuple in the order of the arguments. The pullback of a number takes 1.0 by default.
"""


def require_shape(name: str, array: np.ndarray, expected: tuple) -> None:
    """Raise unless `array` has the shape `expected`; a string in it means any length.

    Raises
    ------
    ValueError
        Naming the argument, its shape and the expected one, such as (batch, frames, 63).
    """
    shape = np.shape(array)
    if shape == expected:
        return
    fits = len(shape) == len(expected) and all(
        isinstance(want, str) or want == have for have, want in zip(shape, expected, strict=True)
    )
    if not fits:
        lengths = ", ".join(map(str, expected))
        if len(expected) == 1:
            lengths += ","
        raise ValueError(f"{name} has shape {shape}, expected ({lengths})")
