"""What the properties of an operation are stated with, as a table: `OPERATIONS`.

The sizes of its arguments, their names, which of them get a gradient, in which of them it is
linear, the definition of its value, and the definition of value and pullback together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from numpy_cae import ops
from numpy_cae.verify import definitions
from numpy_cae.verify.case import ORDINARY, VALUES, Case, Sizes, drawn
from numpy_cae.verify.tied import tied_layer

Alike = Callable[[dict[str, object], np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Operation:
    """An operation as its properties see it.

    Parameters
    ----------
    name : str
    sizes : mapping of str to tuple
        The sizes and classes to draw from, the simplest first.
    arguments : callable
        Makes the arguments of a case, by name, in the order of the call.
    differentiated : tuple of str
        The arguments that get a gradient.
    definition : callable
        Its value.
    linear_in : tuple of str
    reference : callable, optional
        Its value and pullback. Without it gradients are compared with central differences.
    saturates : bool
        Whether a derivative may be far smaller than the numbers that it is computed from.
    selects : bool
        Whether each result is one of the arguments' numbers, up to a factor: compared entry by
        entry however much larger the others are.
    alike : callable, optional
        Maps a gradient to one that is the same for all gradients that are right.
    """

    name: str
    sizes: Sizes
    arguments: Callable[[Case], dict[str, object]]
    differentiated: tuple[str, ...]
    definition: Callable[..., np.ndarray | float]
    linear_in: tuple[str, ...] = ()
    reference: Callable | None = None
    saturates: bool = False
    selects: bool = False
    alike: Alike = lambda arguments, gradient: gradient


CLASSES = {"values": tuple(VALUES)}
WINDOW = {"batch": (1, 2, 3, 4, 6, 70), "frames": (1, 2, 3, 4, 5, 6, 9), "channels": (1, 2, 3)}
FILTERS = {"channels": (1, 2, 3), "filters": (1, 2, 3, 4), "taps": (1, 3, 5, 7, 9)}
ANY_SHAPE = WINDOW | {"axes": (3, 1, 2, 4)} | CLASSES
LINEAR = {"features": (1, 2, 3, 4), "axes": (0, 1, 2, 3)}
STATE = {"state": (ORDINARY, "zeros", "huge")}
GRU = {"batch": (1, 2, 3, 6), "channels": (1, 2, 3), "hidden": (1, 2, 3)} | STATE | CLASSES
POINTS = {
    "points": (1, 2, 3, 4, 5, 7, 8, 13, 300),
    "dimensions": (1, 2, 3),
    "directions": (1, 2, 5),
}
BOUNDS = (0.5, 0.9, 0.99, 0.999)
WEIGHT_REACH = 0.9
ARCTANH_REACH = 1.31


def _window(case: Case) -> tuple[int, ...]:
    """(batch, frames, channels), with fewer or more axes where the operation takes any shape."""
    return (case["batch"], case["frames"], case["channels"], 2)[: case.get("axes", 3)]


def _conv1d(case: Case) -> dict[str, object]:
    channels, filters = case["channels"], case["filters"]
    w, x = (case["taps"], channels, filters), (case["batch"], case["frames"], channels)
    return drawn(case, case.rng(), x=x, w=w, b=(filters,))


def _transpose_filters(case: Case) -> dict[str, object]:
    return drawn(case, case.rng(), w=(case["taps"], case["channels"], case["filters"]))


def _pool(case: Case) -> dict[str, object]:
    batch, frames, channels = _window(case)
    return drawn(case, case.rng(), x=(batch, 2 * frames, channels))


def _window_x(case: Case) -> dict[str, object]:
    return drawn(case, case.rng(), x=_window(case))


def _window_y(case: Case) -> dict[str, object]:
    return drawn(case, case.rng(), y=_window(case))


def _unpool_random(case: Case) -> dict[str, object]:
    rng = case.rng()
    likely = rng.choice([0.5, 0.5, 0.0, 1.0])
    return drawn(case, rng, y=_window(case)) | {"first": rng.random(_window(case)) < likely}


def _arctanh(case: Case) -> dict[str, object]:
    rng = case.rng()
    bound = float(rng.choice(BOUNDS))
    if case.get("values") == "bound":
        near = [bound, np.nextafter(bound, 0), np.nextafter(bound, 1), bound + 1e-9, bound - 1e-9]
        y = rng.choice([*near, 1.0, 1.5], _window(case)) * rng.choice([-1.0, 1.0], _window(case))
        return {"y": y, "bound": bound}
    return drawn(case, rng, ARCTANH_REACH, y=_window(case)) | {"bound": bound}


def _linear(case: Case) -> dict[str, object]:
    leading = (case["batch"], case["frames"], 2)[: case["axes"]]
    channels, features = case["channels"], case["features"]
    return drawn(case, case.rng(), x=(*leading, channels), w=(channels, features), b=(features,))


def _gru(case: Case) -> dict[str, object]:
    """Those of `gru`, or of `gru_step` where the case has no frames."""
    rng, batch, hidden, channels = case.rng(), case["batch"], case["hidden"], case["channels"]
    gates, frames = 3 * hidden, case.get("frames", 0)
    x, state = ((batch, frames, channels), "h0") if frames else ((batch, channels), "h")
    weights = {"w": (channels, gates), "u": (hidden, gates), "b": (gates,), "c": (gates,)}
    arrays = drawn(case, rng, WEIGHT_REACH, x=x, **{state: (batch, hidden)}, **weights)
    if case.get("state") != ORDINARY:
        arrays[state] = VALUES[case.get("state")](rng, (batch, hidden), 1.0)
    return arrays


def _mean_squared_error(case: Case) -> dict[str, object]:
    arrays = drawn(case, case.rng(), x_hat=_window(case), x=_window(case))
    if case.get("values") == "zeros":  # of the difference
        arrays["x_hat"] = arrays["x"].copy()
    return arrays


def _sliced_wasserstein(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["points"], case["dimensions"])
    directions = rng.standard_normal((case["directions"], case["dimensions"]))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return drawn(case, rng, z=shape, prior=shape) | {"directions": directions}


def _mean_of_equal_points(arguments: dict[str, object], gradient: np.ndarray) -> np.ndarray:
    """Any order of equal points is right, so each gets the mean gradient of its equals."""
    z = arguments["z"] + 0.0
    if np.shape(gradient) != z.shape:
        return gradient
    _, group = np.unique(z, axis=0, return_inverse=True)
    member = (group.ravel()[:, None] == group.ravel()).astype(float)
    return (member / member.sum(axis=1, keepdims=True)) @ gradient


def _operation(
    name: str, sizes: Sizes, arguments: Callable, differentiated: str, linear_in: str = "", **others
) -> Operation:
    names, definition = tuple(differentiated.split()), getattr(definitions, name)
    reference = getattr(ops, name, tied_layer)
    linear = tuple(linear_in.split())
    return Operation(name, sizes, arguments, names, definition, linear, reference, **others)


FILTERED = WINDOW | FILTERS | CLASSES
AT_BOUNDS = {"values": (*VALUES, "bound")}
EXTREME = {"values": (*VALUES, "extreme")}
OPERATIONS: dict[str, Operation] = {
    operation.name: operation
    for operation in (
        _operation("conv1d", FILTERED, _conv1d, "x w b", "x w"),
        _operation(
            "transpose_filters", FILTERS | EXTREME, _transpose_filters, "w", "w", selects=True
        ),
        _operation("max_pool", WINDOW | EXTREME, _pool, "x", selects=True),
        _operation("unpool_even", WINDOW | EXTREME, _window_y, "y", "y", selects=True),
        _operation("unpool_random", WINDOW | EXTREME, _unpool_random, "y", "y", selects=True),
        _operation("tanh", ANY_SHAPE, _window_x, "x", saturates=True),
        _operation("sigmoid", ANY_SHAPE, _window_x, "x", saturates=True),
        _operation("arctanh", ANY_SHAPE | AT_BOUNDS, _arctanh, "y"),
        _operation("linear", WINDOW | LINEAR | CLASSES, _linear, "x w b", "x w"),
        _operation("gru_step", GRU, _gru, "x h w u b c", saturates=True),
        _operation("gru", GRU | {"frames": (1, 2, 3, 4, 9)}, _gru, "x h0 w u b c", saturates=True),
        _operation("mean_squared_error", ANY_SHAPE, _mean_squared_error, "x_hat"),
        _operation("mean_absolute", ANY_SHAPE | EXTREME, _window_y, "y", selects=True),
        _operation("tied_layer", FILTERED, _conv1d, "x w b", saturates=True),
        _operation(
            "sliced_wasserstein",
            POINTS | CLASSES,
            _sliced_wasserstein,
            "z",
            alike=_mean_of_equal_points,
        ),
    )
}
