"""Stochastic gradient descent (holden2015, section 6), with momentum, with a bounded norm; and
Adam: steps whose length does not depend on the size of the gradient.
"""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from numpy_cae.training.schedule import SequenceSchedule, Stage

Arrays = Iterable[np.ndarray]


def descend(parameters: Arrays, gradients: Arrays, rate: float) -> None:
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
    parameters: Arrays, velocities: Arrays, gradients: Arrays, rate: float, momentum: float
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
    norm = float(np.sqrt(sum(float(np.vdot(gradient, gradient)) for gradient in gradients)))
    if norm > bound:
        for gradient in gradients:
            gradient *= bound / norm
    return norm


class Sgd:
    """Gradient descent on named parameters; `arrays` holds the velocities for a checkpoint."""

    def __init__(self, parameters: dict[str, np.ndarray], momentum: float = 0.0):
        self.parameters = parameters
        self.momentum = momentum
        self.arrays: dict[str, np.ndarray] = {}
        if momentum:
            for name, array in parameters.items():
                self.arrays[f"velocity of {name}"] = np.zeros_like(array)

    def update(self, gradients: Arrays, rate: float) -> None:
        """Take one step; the gradients are in the order of the parameters."""
        parameters = self.parameters.values()
        if self.momentum:
            velocities = self.arrays.values()
            descend_with_momentum(parameters, velocities, gradients, rate, self.momentum)
        else:
            descend(parameters, gradients, rate)


BETA_1 = 0.9
"""The value of Kingma and Ba."""
BETA_2 = 0.99
"""Kingma and Ba suggest 0.999; 0.99 left a smaller error here (docs/lab_book/end_to_end.md)."""
EPSILON = 1e-8
"""The value of Kingma and Ba."""
BLOCK = 32_768
"""So many numbers of an array are updated together; they stay in the processor's cache."""


class Adam:
    """Adam on named parameters.

        m ← β₁ m + (1 - β₁) g        v ← β₂ v + (1 - β₂) g²          g = dL/dθ
        θ ← θ - η · m̂ / (√v̂ + ε)     m̂ = m / (1 - β₁ᵗ),   v̂ = v / (1 - β₂ᵗ)

    m and v estimate the means of g and g². They start at 0, so they are too small at first. If g
    has the same mean E[g] at all steps i = 1, …, t, then, by the geometric series,

        m = (1 - β₁) Σ β₁^(t-i) g_i,      E[m] = E[g] · (1 - β₁) Σ β₁^(t-i) = E[g] · (1 - β₁ᵗ)

    Dividing by 1 - β₁ᵗ corrects this bias; v likewise. So the first step is η · g / (|g| + ε).

    `arrays` holds m, v and t for a checkpoint.

    References
    ----------
    Kingma and Ba, "Adam: a method for stochastic optimization", ICLR 2015, algorithm 1.

    Examples
    --------
    >>> w = np.zeros(2)
    >>> adam = Adam({"w": w})
    >>> adam.update([np.array([0.001, -1000.0])], rate=0.1)
    >>> w.round(3)  # the first step has the length of the rate, whatever the gradient's size
    array([-0.1,  0.1])
    """

    def __init__(self, parameters: dict[str, np.ndarray]):
        self.parameters = parameters
        self.means = {f"mean of {name}": np.zeros_like(w) for name, w in parameters.items()}
        self.squares = {f"square of {name}": np.zeros_like(w) for name, w in parameters.items()}
        self.count = np.zeros((), dtype=np.int64)
        self.arrays = {**self.means, **self.squares, "steps of Adam": self.count}

    def update(self, gradients: Arrays, rate: float) -> None:
        """Take one step in place; the gradients are in the order of the parameters."""
        self.count += 1
        # η · m̂ / (√v̂ + ε) = η r · m / (√v + ε · √(1 - β₂ᵗ)) with r = √(1 - β₂ᵗ) / (1 - β₁ᵗ)
        root = (1 - BETA_2 ** int(self.count)) ** 0.5
        rate = rate * root / (1 - BETA_1 ** int(self.count))
        epsilon = EPSILON * root
        parts = self.parameters.values(), self.means.values(), self.squares.values(), gradients
        for arrays in zip(*parts, strict=True):
            for w, m, v, g in _blocks(arrays):
                m += (1 - BETA_1) * (g - m)
                v += (1 - BETA_2) * (g * g - v)
                w -= rate * m / (np.sqrt(v) + epsilon)


def _blocks(arrays: tuple[np.ndarray, ...]) -> Iterator[tuple[np.ndarray, ...]]:
    """Views of the same rows of arrays of one shape, about `BLOCK` numbers of each at a time."""
    first = arrays[0]
    rows = max(1, BLOCK * len(first) // first.size)
    for start in range(0, len(first), rows):
        yield tuple(array[start : start + rows] for array in arrays)


def make_optimiser(
    stage: Stage | SequenceSchedule, parameters: dict[str, np.ndarray]
) -> Sgd | Adam:
    """The optimiser of a stage, which changes these arrays in place."""
    if stage.optimiser == "adam":
        return Adam(parameters)
    return Sgd(parameters, stage.momentum)
