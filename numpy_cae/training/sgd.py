"""Stochastic gradient descent (holden2015, section 6), with momentum, with a bounded norm."""

from collections.abc import Iterable, Sequence

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
    """v ← μ v - η · dL/dθ,   θ ← θ + v   (Polyak 1964), both in place; holden2015 has none of it.

    With a constant gradient the step grows to 1 / (1 - μ) times the plain step. Steps of
    alternating sign partly cancel.
    """
    for parameter, velocity, gradient in zip(parameters, velocities, gradients, strict=True):
        velocity *= momentum
        velocity -= rate * gradient
        parameter += velocity


def clip_norm(gradients: Sequence[np.ndarray], bound: float) -> float:
    """g ← g · min(1, bound / |g|), in place, |g| over all the gradients together; return |g|.

    Backpropagation through fifty steps can return a gradient a thousand times as long as the one
    before, and one such step would ruin the weights (Pascanu, Mikolov and Bengio, "On the
    difficulty of training recurrent neural networks", ICML 2013, algorithm 1).
    """
    if not bound > 0:
        raise ValueError(f"the bound on the gradient's norm is {bound}, expected it above 0")
    norm = float(np.sqrt(sum(float(np.vdot(each, each)) for each in gradients)))
    if norm > bound:
        for each in gradients:
            each *= bound / norm
    return norm


class Sgd:
    """Gradient descent on named parameters; `state` holds the velocities for a checkpoint."""

    def __init__(self, parameters: dict[str, np.ndarray], momentum: float = 0.0):
        self.parameters, self.momentum = parameters, momentum
        named = parameters.items() if momentum else ()
        self.state = {f"velocity of {name}": np.zeros_like(array) for name, array in named}

    def update(self, gradients: Iterable[np.ndarray], rate: float) -> None:
        """Take one step; the gradients are in the order of the parameters."""
        parameters, velocities = self.parameters.values(), self.state.values()
        if self.momentum:
            descend_with_momentum(parameters, velocities, gradients, rate, self.momentum)
        else:
            descend(parameters, gradients, rate)
