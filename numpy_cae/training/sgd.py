"""Stochastic gradient descent and its decay (holden2015, section 6)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np


def decayed_rate(initial: float, decay: float, epoch: int) -> float:
    """η_e = η_0 · decay^e: "initially set to the value of 0.5 and slowly decayed by a factor of
    0.9 at each epoch". Epochs count from 0.
    """
    return initial * decay**epoch


def descend(parameters: Iterable[np.ndarray], gradients: Iterable[np.ndarray], rate: float) -> None:
    """θ ← θ - η · dL/dθ, each parameter in place."""
    for parameter, gradient in zip(parameters, gradients, strict=True):
        parameter -= rate * gradient


def descend_with_momentum(
    parameters: Iterable[np.ndarray],
    velocities: Iterable[np.ndarray],
    gradients: Iterable[np.ndarray],
    rate: float,
    momentum: float,
) -> None:
    """v ← μ v - η · dL/dθ,   θ ← θ + v   (Polyak 1964), both in place.

    Along a direction in which the gradient keeps its sign steps add up to 1 / (1 - μ) of one; where
    it changes its sign they cancel. Not in holden2015: see "The network that repairs best" in
    lessons/papers_to_code.md.
    """
    for parameter, velocity, gradient in zip(parameters, velocities, gradients, strict=True):
        velocity *= momentum
        velocity -= rate * gradient
        parameter += velocity
