"""A bound on the length of a step: what backpropagation through time needs beside a rate.

A gradient that has come through fifty steps of one and the same matrix may be a thousand times the
one before it, and a single such step throws the weights away.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def clip_norm(gradients: Sequence[np.ndarray], bound: float) -> float:
    """g ← g · min(1, bound / |g|), in place, |g| over all the gradients together.

    One factor for all of them: the step keeps its direction and only its length is bounded.

    Parameters
    ----------
    gradients : sequence of arrays of float
    bound : float
        Above 0.

    Returns
    -------
    norm : float
        |g| as it was.

    Raises
    ------
    ValueError
        If the bound is not above 0.

    References
    ----------
    Pascanu, Mikolov and Bengio, "On the difficulty of training recurrent neural networks", ICML
    2013, algorithm 1.
    """
    if not bound > 0:
        raise ValueError(f"the bound on the gradient's norm is {bound}, expected it above 0")
    norm = float(np.sqrt(sum(float(np.vdot(each, each)) for each in gradients)))
    if norm > bound:
        for each in gradients:
            each *= bound / norm
    return norm
