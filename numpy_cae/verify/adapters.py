"""Layers of other forms as operations: a cache, complex numbers, or an object with methods."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from numpy_cae.verify.checks.mismatch import REPEATED, Mismatch

SAME_VALUE = 1e-5
"""A layer used a second time has to return the same value up to so small a part of it."""


def of_cache(forward: Callable, backward: Callable) -> Callable:
    """An operation from forward(*arrays) -> (value, cache) and backward(dy, cache) -> gradients.

    Parameters
    ----------
    forward, backward : callable
        In the form of Stanford's CS231n.

    Returns
    -------
    callable
        (*arrays) -> (value, pullback)

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> affine = verify.of_cache(
    ...     lambda x, w: (x @ w, (x, w)), lambda dy, cache: (dy @ cache[1].T, cache[0].T @ dy)
    ... )
    >>> verify.check_gradients(affine, np.ones((2, 3)), np.ones((3, 4)))
    """

    def operation(*arrays: Any) -> tuple[Any, Callable]:
        value, cache = forward(*arrays)
        return value, lambda dy: backward(dy, cache)

    operation.__wrapped__ = backward  # type: ignore[attr-defined]
    return operation


def of_complex(f: Callable, real_arguments: Sequence[int] = ()) -> Callable:
    """An operation of real arrays from one of complex arrays: each number becomes a pair.

    A pair is an additional last axis of length 2, with the real and the imaginary part, as in
    shapes={"x": "batch frames 2"}. A value that is real stays as it is.

    Parameters
    ----------
    f : (*arrays) -> (value, pullback)
        Of complex arrays. For a real loss L the gradient of x is dL/d(Re x) + i dL/d(Im x), as
        PyTorch has it; that of JAX is its conjugate.
    real_arguments : sequence of int
        The positions of arguments that are real arrays and no pairs.

    Returns
    -------
    callable
        (*arrays) -> (value, pullback)

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> square = verify.of_complex(lambda z: (z * z, lambda dy: 2 * np.conj(z) * dy))
    >>> verify.check_gradients(square, np.array([[1.0, 2.0], [0.5, -1.0]]))
    """

    def operation(*arrays: np.ndarray) -> tuple[np.ndarray, Callable]:
        arguments = []
        for place, array in enumerate(arrays):
            arguments.append(array if place in real_arguments else _complex_of_pairs(array))
        value, pullback = f(*arguments)
        is_complex = np.iscomplexobj(value)

        def pullback_of_pairs(dy: np.ndarray) -> Any:
            pulled = pullback(_complex_of_pairs(dy) if is_complex else dy)
            if not isinstance(pulled, tuple):
                return pulled if 0 in real_arguments else _pairs_of_complex(pulled)
            gradients = []
            for place, gradient in enumerate(pulled):
                is_real = place in real_arguments
                gradients.append(gradient if is_real else _pairs_of_complex(gradient))
            return tuple(gradients)

        return _pairs_of_complex(value) if is_complex else value, pullback_of_pairs

    operation.__wrapped__ = f  # type: ignore[attr-defined]
    return operation


def _complex_of_pairs(pairs: np.ndarray) -> np.ndarray:
    """Complex numbers from pairs along the last axis."""
    return pairs[..., 0] + 1j * pairs[..., 1]


def _pairs_of_complex(numbers: np.ndarray) -> np.ndarray:
    """The real and the imaginary parts along an additional last axis."""
    return np.stack([np.real(numbers), np.imag(numbers)], axis=-1)


def of_layer(
    make: Callable,
    *inputs: np.ndarray,
    weights: Mapping[str, np.ndarray] | None = None,
    gradients: Sequence[str] | None = None,
    forward: str | Callable = "forward",
    backward: str = "backward",
) -> tuple:
    """The value and the pullback of an object that has a method forward and a method backward.

    The object is used several times, as in training: its method forward is called again before each
    call of its method backward. The random numbers of `np.random` are the same in each call, so
    that a mask of dropout is, too, and their state is restored.

    Parameters
    ----------
    make : () -> object
        Makes the layer, such as `lambda: Dense(3, 4)`.
    *inputs : arrays
        The arguments of the method forward. There is a gradient for each array of floats.
    weights : mapping of str to array, optional
        Where the layer keeps its weights, such as {"w": w} for `layer.w` or {"params.w": w} for
        `layer.params["w"]`.
    gradients : sequence of str, optional
        Where the layer keeps the gradient of each weight, in the order of `weights`. Without it the
        method backward has to update the weights with a learning rate of 1.
    forward : str or (layer, *inputs) -> value
        The name of the method, or a function that calls it, perhaps with a flag for training.
    backward : str
        The name of the method that gets the upstream gradient and returns those of the inputs.

    Returns
    -------
    value, pullback
        The pullback returns the gradients of the inputs, then those of the weights.

    Raises
    ------
    AssertionError
        If the object, used a second time, returns another value.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> class Dense:
    ...     def __init__(self):
    ...         self.w = np.random.randn(3, 4)
    ...     def forward(self, x):
    ...         self.x = x
    ...         return x @ self.w
    ...     def backward(self, dy):
    ...         self.dw = self.x.T @ dy
    ...         return dy @ self.w.T
    >>> def dense(x, w):
    ...     return verify.of_layer(Dense, x, weights={"w": w}, gradients=["dw"])
    >>> verify.check_gradients(dense, np.ones((2, 3)), np.ones((3, 4)))
    """
    weights = {place: np.copy(array) for place, array in (weights or {}).items()}
    with _fixed_random_numbers():
        layer = _Layer(make(), weights, gradients, forward, backward)
    inputs_before = [np.copy(x) for x in inputs]
    value = np.copy(layer.value_of(inputs))  # not of copies: a check sees whether they are altered

    def pullback(dy: np.ndarray) -> Any:
        value_again = layer.value_of([x.copy() for x in inputs_before])
        if not np.allclose(value_again, value, rtol=SAME_VALUE, equal_nan=True):
            text = "used a second time, the layer returns another value for the same input"
            raise Mismatch(REPEATED, "the value", text)
        layer.clear_gradients()
        all_gradients = layer.gradients_of_inputs(inputs_before, dy)
        all_gradients += layer.gradients_of_weights()
        return tuple(all_gradients) if len(all_gradients) > 1 else all_gradients[0]

    return value, pullback


@dataclass(frozen=True, eq=False)
class _Layer:
    """An object with its weights and the places of their gradients, as `of_layer` has them."""

    layer: Any
    weights: Mapping[str, np.ndarray]
    gradients: Sequence[str] | None
    forward: str | Callable
    backward: str

    def value_of(self, inputs: Sequence[np.ndarray]) -> Any:
        """The value for some inputs, and for copies of the weights as they were given."""
        for place, array in self.weights.items():
            _put(self.layer, place, array.copy())
        with _fixed_random_numbers():
            if callable(self.forward):
                return self.forward(self.layer, *inputs)
            return getattr(self.layer, self.forward)(*inputs)

    def clear_gradients(self) -> None:
        """Set the gradients of the weights to 0, which some layers add to."""
        for place in self.gradients or ():
            gradient = _at(self.layer, place)
            if isinstance(gradient, np.ndarray):
                _put(self.layer, place, np.zeros_like(gradient))

    def gradients_of_inputs(self, inputs: Sequence[np.ndarray], dy: np.ndarray) -> list:
        """What the method backward returns for the inputs that are floats."""
        pulled = getattr(self.layer, self.backward)(dy)
        if not isinstance(pulled, tuple | list):
            pulled = (pulled,)
        pairs = zip(inputs, pulled, strict=False)
        return [gradient for x, gradient in pairs if x.dtype.kind == "f"]

    def gradients_of_weights(self) -> list:
        """The gradients after a call of backward; without places, what it subtracted."""
        if self.gradients is None:
            return [array - _at(self.layer, place) for place, array in self.weights.items()]
        return [np.copy(_at(self.layer, place)) for place in self.gradients]


def _at(layer: Any, place: str) -> Any:
    """What is at a place such as "w" or "params.w", an attribute or an item; None if nothing is."""
    for name in place.split("."):
        layer = layer.get(name) if isinstance(layer, dict) else getattr(layer, name, None)
    return layer


def _put(layer: Any, place: str, array: np.ndarray) -> None:
    """Replace what is at a place."""
    *owner, name = place.split(".")
    holder = _at(layer, ".".join(owner)) if owner else layer
    if isinstance(holder, dict):
        holder[name] = array
    else:
        setattr(holder, name, array)


@contextmanager
def _fixed_random_numbers() -> Iterator[None]:
    """Let np.random begin with the same numbers each time; restore its state afterwards."""
    state = np.random.get_state()  # noqa: NPY002 (that of other people's layers)
    np.random.seed(0)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(state)  # noqa: NPY002
