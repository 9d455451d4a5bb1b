"""What the properties of an operation are stated with.

The sizes of its arguments, their names, which of them get a gradient, in which of them it is
linear, and the definition of its value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.convention import PYTORCH, Convention

Sizes = Mapping[str, tuple[int, ...]]


@dataclass(frozen=True)
class Operation:
    """An operation as its properties see it."""

    name: str
    sizes: Sizes  # the sizes to draw from, the simplest first
    arguments: Callable[[Case], dict[str, object]]  # by name, in the order of the call
    differentiated: tuple[str, ...]
    definition: Callable[..., np.ndarray | float]
    linear_in: tuple[str, ...] = ()
    convention: Convention = PYTORCH

    def in_convention(self, convention: Convention) -> Operation:
        """The same operation with its definition in another convention of the GRU."""
        definition = partial(getattr(definitions, self.name), convention=convention)
        return replace(self, definition=definition, convention=convention)


WINDOW = {"batch": (1, 2, 3), "frames": (1, 2, 3, 4, 5, 6), "channels": (1, 2, 3)}
FILTERS = {"channels": (1, 2, 3), "filters": (1, 2, 3), "taps": (1, 3, 5, 7, 9)}
LINEAR = {"features": (1, 2, 3), "axes": (0, 1, 2)}
GRU = {"batch": (1, 2, 3), "channels": (1, 2, 3), "hidden": (1, 2, 3)}
POINTS = {"points": (1, 2, 3, 4, 5, 6), "dimensions": (1, 2, 3), "directions": (1, 2, 3)}
WEIGHT_REACH = 0.9
ARCTANH_REACH = 1.31  # no entry of the grid falls on a bound of 0.5 or 0.9


def _window(case: Case) -> tuple[int, int, int]:
    return case["batch"], case["frames"], case["channels"]


def _drawn(rng: np.random.Generator, reach: float = 2.0, **shapes: tuple[int, ...]) -> dict:
    """Arrays by name."""
    return {name: spread(rng, shape, reach) for name, shape in shapes.items()}


def _conv1d(case: Case) -> dict[str, object]:
    channels, filters = case["channels"], case["filters"]
    w = (case["taps"], channels, filters)
    return _drawn(case.rng(), x=_window(case), w=w, b=(filters,))


def _transpose_filters(case: Case) -> dict[str, object]:
    return _drawn(case.rng(), w=(case["taps"], case["channels"], case["filters"]))


def _pool(case: Case) -> dict[str, object]:
    batch, frames, channels = _window(case)
    return _drawn(case.rng(), x=(batch, 2 * frames, channels))


def _window_x(case: Case) -> dict[str, object]:
    return _drawn(case.rng(), x=_window(case))


def _window_y(case: Case) -> dict[str, object]:
    return _drawn(case.rng(), y=_window(case))


def _unpool_random(case: Case) -> dict[str, object]:
    rng = case.rng()
    return {"y": spread(rng, _window(case)), "first": rng.random(_window(case)) < 0.5}


def _arctanh(case: Case) -> dict[str, object]:
    rng = case.rng()
    y = spread(rng, _window(case), ARCTANH_REACH)
    return {"y": y, "bound": float(rng.choice([0.5, 0.9, 0.99]))}


def _linear(case: Case) -> dict[str, object]:
    leading = (case["batch"], case["frames"])[: case["axes"]]
    channels, features = case["channels"], case["features"]
    return _drawn(case.rng(), x=(*leading, channels), w=(channels, features), b=(features,))


def _gru_weights(case: Case, rng: np.random.Generator) -> dict[str, object]:
    hidden, gates = case["hidden"], 3 * case["hidden"]
    w, u = (case["channels"], gates), (hidden, gates)
    return _drawn(rng, WEIGHT_REACH, w=w, u=u, b=(gates,), c=(gates,))


def _gru_step(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = spread(rng, (case["batch"], case["channels"]))
    h = spread(rng, (case["batch"], case["hidden"]), 1.0)
    return {"x": x, "h": h, **_gru_weights(case, rng)}


def _gru(case: Case) -> dict[str, object]:
    rng = case.rng()
    x = spread(rng, _window(case))
    h0 = spread(rng, (case["batch"], case["hidden"]), 1.0)
    return {"x": x, "h0": h0, **_gru_weights(case, rng)}


def _mean_squared_error(case: Case) -> dict[str, object]:
    return _drawn(case.rng(), x_hat=_window(case), x=_window(case))


def _sliced_wasserstein(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["points"], case["dimensions"])
    directions = rng.standard_normal((case["directions"], case["dimensions"]))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return {"z": spread(rng, shape), "prior": spread(rng, shape), "directions": directions}


OPERATIONS: dict[str, Operation] = {}


def _add(name: str, sizes: Sizes, arguments: Callable, differentiated: str, linear_in: str = ""):
    names, linear = tuple(differentiated.split()), tuple(linear_in.split())
    definition = getattr(definitions, name)
    OPERATIONS[name] = Operation(name, sizes, arguments, names, definition, linear)


_add("conv1d", WINDOW | FILTERS, _conv1d, "x w b", linear_in="x w")
_add("transpose_filters", FILTERS, _transpose_filters, "w", linear_in="w")
_add("max_pool", WINDOW, _pool, "x")
_add("unpool_even", WINDOW, _window_y, "y", linear_in="y")
_add("unpool_random", WINDOW, _unpool_random, "y", linear_in="y")
_add("tanh", WINDOW, _window_x, "x")
_add("sigmoid", WINDOW, _window_x, "x")
_add("arctanh", WINDOW, _arctanh, "y")
_add("linear", WINDOW | LINEAR, _linear, "x w b", linear_in="x w")
_add("gru_step", GRU, _gru_step, "x h w u b c")
_add("gru", GRU | {"frames": (1, 2, 3, 4)}, _gru, "x h0 w u b c")
_add("mean_squared_error", WINDOW, _mean_squared_error, "x_hat")
_add("mean_absolute", WINDOW, _window_y, "y")
_add("tied_layer", WINDOW | FILTERS, _conv1d, "x w b")
_add("sliced_wasserstein", POINTS, _sliced_wasserstein, "z")
