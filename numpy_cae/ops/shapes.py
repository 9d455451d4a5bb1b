"""The check of an argument's shape.

A wrong shape that broadcasts gives wrong results without an error, so every operation checks first
and names the argument, the shape it has and the expected shape.
"""

import numpy as np


def require_shape(name: str, array: np.ndarray, expected: tuple) -> None:
    """Raise unless `array` has the shape `expected`; a string in it means any length.

    Raises
    ------
    ValueError
        Naming the argument, its shape and the expected one, such as (batch, frames, 63).
    """
    shape = np.shape(array)
    fits = len(shape) == len(expected) and all(
        isinstance(want, str) or want == have for have, want in zip(shape, expected, strict=True)
    )
    if not fits:
        wanted = "(" + ", ".join(map(str, expected)) + ("," if len(expected) == 1 else "") + ")"
        raise ValueError(f"{name} has shape {shape}, expected {wanted}")
