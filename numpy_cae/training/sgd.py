"""Stochastic gradient descent (holden2015, section 6), with momentum, with a bounded norm."""

from collections.abc import Iterable, Sequence

import numpy as np


def descend(parameters: Iterable[np.ndarray], gradients: Iterable[np.ndarray], rate: float) -> None:
    """θ ← θ - η · dL/dθ, each parameter in place.

    Parameters
    ----------
    parameters, gradients : iterables of arrays
        The gradient of each parameter, in the same order.
    rate : float
        η.

    Examples
    --------
    >>> w = np.array([1.0, 2.0])
    >>> descend([w], [np.array([10.0, -10.0])], rate=0.1)
    >>> w
    array([0., 3.])
    """
    for parameter, gradient in zip(parameters, gradients, strict=True):
        parameter -= rate * gradient


def descend_with_momentum(
    parameters: Iterable[np.ndarray],
    velocities: Iterable[np.ndarray],
    gradients: Iterable[np.ndarray],
    rate: float,
    momentum: float,
) -> None:
    """v ← μ v - η · dL/dθ,   θ ← θ + v   (Polyak 1964), both in place; holden2015 has no momentum.

    With a constant gradient the step grows to 1 / (1 - μ) times the plain step. Steps of
    alternating sign partly cancel.

    Parameters
    ----------
    parameters, velocities, gradients : iterables of arrays
        θ, v (zero at first) and dL/dθ, in the same order.
    rate, momentum : float
        η and μ.

    Examples
    --------
    >>> w, v = np.zeros(1), np.zeros(1)
    >>> for _ in range(3):
    ...     descend_with_momentum([w], [v], [np.ones(1)], rate=0.1, momentum=0.5)
    >>> v  # approaches -0.2, twice the plain step
    array([-0.175])
    """
    for parameter, velocity, gradient in zip(parameters, velocities, gradients, strict=True):
        velocity *= momentum
        velocity -= rate * gradient
        parameter += velocity


def clip_norm(gradients: Sequence[np.ndarray], bound: float) -> float:
    """g ← g · min(1, bound / |g|), in place, with |g| over all the gradients together.

    Backpropagation through fifty steps can return a gradient a thousand times as long as the one
    before, and one such step would ruin the weights (Pascanu, Mikolov and Bengio, "On the
    difficulty of training recurrent neural networks", ICML 2013, algorithm 1).

    Parameters
    ----------
    gradients : sequence of arrays
    bound : float
        Above 0.

    Returns
    -------
    norm : float
        |g| before clipping.

    Examples
    --------
    >>> gradient = np.array([30.0, 40.0])
    >>> clip_norm([gradient], bound=1.0), gradient
    (50.0, array([0.6, 0.8]))
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
        self.parameters = parameters
        self.momentum = momentum
        named = parameters.items() if momentum else ()
        self.state = {f"velocity of {name}": np.zeros_like(array) for name, array in named}

    def update(self, gradients: Iterable[np.ndarray], rate: float) -> None:
        """Take one step; the gradients are in the order of the parameters."""
        parameters = self.parameters.values()
        if self.momentum:
            velocities = self.state.values()
            descend_with_momentum(parameters, velocities, gradients, rate, self.momentum)
        else:
            descend(parameters, gradients, rate)
