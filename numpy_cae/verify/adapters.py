"""Layers of other forms as operations: an object with forward and backward, or a cache."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial

import numpy as np

from numpy_cae.verify.checks.call import REPEATED, Mismatch


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

    def operation(*arrays):
        value, cache = forward(*arrays)
        return value, lambda dy: backward(dy, cache)

    operation.__wrapped__ = backward  # type: ignore[attr-defined]
    return operation


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
    placed = {place: np.copy(array) for place, array in (weights or {}).items()}
    kept = [np.copy(x) for x in inputs]
    with _fixed_random_numbers():
        layer = make()

    def value_of(*arrays: np.ndarray) -> object:
        for place, array in placed.items():
            _put(layer, place, array.copy())
        with _fixed_random_numbers():
            method = partial(forward, layer) if callable(forward) else getattr(layer, forward)
            return method(*arrays)

    value = np.copy(value_of(*inputs))

    def pullback(dy):
        again = value_of(*map(np.copy, kept))
        if not np.allclose(again, value, rtol=1e-5, equal_nan=True):
            text = "used a second time, the layer returns another value for the same input"
            raise Mismatch(REPEATED, "the value", text)
        for place in gradients or ():
            if isinstance(_at(layer, place), np.ndarray):
                _put(layer, place, np.zeros_like(_at(layer, place)))
        pulled = getattr(layer, backward)(dy)
        pulled = pulled if isinstance(pulled, tuple | list) else (pulled,)
        of_inputs = [g for x, g in zip(kept, pulled, strict=False) if x.dtype.kind == "f"]
        of_weights = [np.copy(_at(layer, place)) for place in gradients or ()]
        if gradients is None:
            of_weights = [array - _at(layer, place) for place, array in placed.items()]
        made = (*of_inputs, *of_weights)
        return made if len(made) > 1 else made[0]

    return value, pullback


def _at(layer: object, place: str) -> object:
    """What is at a place such as "w" or "params.w", an attribute or an item; None if nothing is."""
    for name in place.split("."):
        layer = layer.get(name) if isinstance(layer, dict) else getattr(layer, name, None)
    return layer


def _put(layer: object, place: str, array: np.ndarray) -> None:
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
