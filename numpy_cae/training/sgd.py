"""Stochastic gradient descent (holden2015, section 6), and the same with momentum."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np


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

    Steps along a direction in which the gradient keeps its sign add up to 1 / (1 - μ) times one
    step; where the gradient changes its sign they cancel. holden2015 has no momentum: see "The
    network that repairs best" in docs/lab_book.md.
    """
    for parameter, velocity, gradient in zip(parameters, velocities, gradients, strict=True):
        velocity *= momentum
        velocity -= rate * gradient
        parameter += velocity


class Sgd:
    """Gradient descent on named parameters.

    Parameters
    ----------
    parameters : dict of name to array
        Changed in place by `update`.
    momentum : float
        μ, at least 0 and below 1; 0 is plain descent.

    Attributes
    ----------
    state : dict of name to array
        The velocities; empty without momentum. A checkpoint keeps them.
    """

    def __init__(self, parameters: dict[str, np.ndarray], momentum: float = 0.0):
        self.parameters, self.momentum = parameters, momentum
        moving = parameters if momentum else {}
        self.state = {f"velocity of {name}": np.zeros_like(w) for name, w in moving.items()}

    def update(self, gradients: Iterable[np.ndarray], rate: float) -> None:
        """Take one step; the gradients are in the order of the parameters."""
        parameters = self.parameters.values()
        if self.momentum:
            velocities = self.state.values()
            descend_with_momentum(parameters, velocities, gradients, rate, self.momentum)
        else:
            descend(parameters, gradients, rate)
