"""`OPERATIONS`, a table: the arguments of every operation, its definition and its tolerances."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from numpy_cae import ops
from numpy_cae.ops import conv1d, tanh, transpose_filters
from numpy_cae.verify.operations.case import ORDINARY, VALUES, Case, Sizes, drawn, spread

Values = tuple[float, float] | Callable[[np.random.Generator, tuple[int, ...]], np.ndarray]
"""The lowest and the highest number of an argument, or a function that draws it."""


@dataclass(frozen=True)
class Operation:
    """What the properties need to know of an operation.

    Gradients are compared with those of `reference`; without one, with differences of the value.
    """

    name: str
    sizes: Sizes  # the sizes and classes to draw from, the simplest first
    arguments: Callable[[Case], dict[str, object]]  # by name, in the order of the call
    differentiated: tuple[str, ...]
    definition: Callable | None = None  # arguments -> value, if there is no reference
    linear_in: tuple[str, ...] = ()
    reference: Callable | None = None  # arguments -> (value, pullback)
    saturates: bool = False  # derivatives may be far smaller than the terms they come from
    floor: float | None = None  # the rounding allowed per entry, if entries are compared singly
    without_ties: Sizes = field(default_factory=dict)  # classes of values without a kink
    longer: Sizes = field(default_factory=lambda: LONG)  # additional sizes for `special inputs`
    alike: Callable = lambda arguments, gradient: gradient  # equal for all right gradients
    seeded_by: str = ""  # what the cases depend on, by default the name
    drawn_by_caller: tuple[str, ...] = ()  # arguments that no property may alter
    is_single: bool = False  # whether it is tried in float32 only

    def value(self, *arguments: object) -> np.ndarray | float:
        """The right value."""
        return self.reference(*arguments)[0] if self.reference else self.definition(*arguments)

    def floor_of(self, dy: np.ndarray | float) -> float | None:
        """The floor for a gradient, proportional to the upstream gradient."""
        return self.floor and self.floor * max(1.0, float(np.max(np.abs(dy))))


def tied_layer(x: np.ndarray, w: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, Callable]:
    """y = tanh(x * W + b),  x̂ = (y - b) * W̃.

        dL/dW = (as encoding returns it) + (dL/dW̃, transposed back)
        dL/db = (as encoding returns it) - Σ dL/d(y - b)

    x and x̂ are (B, T, C), w (K, C, D), b (D,); the pullback returns (dx, dw, db). Raises a
    ValueError if a shape does not fit. holden2015, section 5, equations 1 and 2.
    """
    a, of_encoding = conv1d(x, w, b)
    y, of_tanh = tanh(a)
    w_tilde, of_transpose = transpose_filters(w)
    x_hat, of_decoding = conv1d(y - b, w_tilde, np.zeros(x.shape[-1], dtype=x.dtype))

    def pullback(dx_hat: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        dy, dw_tilde, _ = of_decoding(dx_hat)
        dx, dw, db = of_encoding(of_tanh(dy))
        return dx, dw + of_transpose(dw_tilde), db - dy.sum(axis=(0, 1))

    return x_hat, pullback


CLASSES = {"values": tuple(VALUES)}
EXTREME = {"values": (*VALUES, "extreme")}
AT_BOUNDS = {"values": (*VALUES, "bound")}
CHANNELS = (1, 2, 3, 17)
WINDOW = {
    "batch": (1, 2, 3, 4, 6, 70),
    "frames": (1, 2, 3, 4, 5, 8, 9, 70),
    "channels": CHANNELS,
}
PAIRS = WINDOW | {"frames": (2, 4, 6, 8, 10, 16, 18, 140)}
FILTERS = {"channels": CHANNELS, "filters": (1, 2, 3, 4, 17), "taps": (1, 3, 5, 7, 9, 15)}
FILTERED = WINDOW | FILTERS | CLASSES | {"frames": (1, 2, 3, 4, 5, 7, 8, 9, 14, 15, 70)}
ANY_SHAPE = WINDOW | {"axes": (3, 4, 2, 1)}
LINEAR = WINDOW | {"features": (1, 2, 3, 4), "axes": (2, 3, 1, 0, 4)} | CLASSES
STATE = {"state": (ORDINARY, "zeros", "huge")}
GRU = {"batch": (1, 2, 3, 6, 70), "channels": CHANNELS, "hidden": (1, 2, 3, 9)} | STATE | CLASSES
BANK = FILTERS | EXTREME | {"taps": (1, 2, 3, 4, 5, 9, 15)}
FRAMES = {"frames": (1, 2, 3, 5, 34)}
POINTS = {
    "points": (1, 2, 3, 4, 5, 7, 8, 13, 300, 530),
    "dimensions": (1, 2, 3, 17),
    "directions": (1, 2, 3, 34),
}
LONG = {
    "batch": (128, 300, 1030, 18),
    "frames": (128, 530, 240),
    "taps": (33, 131, 17),
    "points": (128, 256, 2100),
    "directions": (3, 5, 7, 64, 520),
    "channels": (3, 64, 300, 63),
    **dict.fromkeys(("filters", "features"), (64, 300, 3)),
    **dict.fromkeys(("hidden", "dimensions"), (3, 64, 300, 18)),
    "axes": (3,),
}
"""Additional sizes for the `special inputs` property.

The last size of every axis is that of the project's own networks, or above it: 240 frames of 63
channels. All last sizes are tried together; few filters keep that fast for code with loops.
"""
SHORTER = {"longer": LONG | {"batch": (128, 300, 1030, 2), "frames": (1100, 240)}}
BOUNDS = (0.5, 0.9, 0.99, 0.999)
WEIGHT_REACH = 1.0
"""WEIGHT_REACH: ordinary weights of a GRU are at most this; of one hidden unit, quarters."""
ARCTANH_REACH = 1.31
"""ARCTANH_REACH: ordinary arguments of arctanh are at most this, which is beyond every bound."""
CHAOTIC = 34
"""CHAOTIC: with more frames or hidden units, large weights of a GRU amplify rounding errors."""


def arguments_of(
    shapes: Mapping[str, str], values: Mapping[str, Values]
) -> Callable[[Case], dict[str, object]]:
    """Arguments whose shapes are sizes, such as w="taps channels filters".

    A size may be a number, a product or sum such as 2*frames or in+out, or "...", which is any
    number of axes. Numbers outside of the range that `values` states are replaced by its ends.
    """
    leading = leading_axes(shapes)

    def arguments(case: Case) -> dict[str, object]:
        rng = case.rng()
        any_axes = " ".join(leading[: case.get("axes", 0)])
        sizes = {name: text.replace("...", any_axes).split() for name, text in shapes.items()}
        arrays = drawn(
            case, rng, **{n: tuple(_size(s, case) for s in each) for n, each in sizes.items()}
        )
        for name, wanted in values.items():
            if callable(wanted):
                arrays[name] = wanted(rng, arrays[name].shape)
            else:
                low, high = wanted
                steps = np.clip(arrays[name], -2, 2)
                arrays[name] = np.clip((low + high) / 2 + (high - low) / 4 * steps, low, high)
        return arrays

    return arguments


def _size(text: str, case: Case) -> int:
    """The number that a size stands for in a case, such as 2*frames+1."""
    terms = (term.split("*") for term in text.split("+"))
    return sum(math.prod(int(f) if f.isdigit() else case[f] for f in term) for term in terms)


def names_in(shapes: Mapping[str, str]) -> list[str]:
    """The names of the sizes in shapes, in their order."""
    text = " ".join(shapes.values()).replace("...", " ").replace("*", " ").replace("+", " ")
    return [name for name in dict.fromkeys(text.split()) if not name.isdigit()]


def leading_axes(shapes: Mapping[str, str]) -> list[str]:
    """The sizes of the axes for which "..." may stand."""
    used = names_in(shapes)
    names = [name for name in ("batch", "frames", "channels") if name not in used]
    return [*names, *"22"[: 5 - len(names) if used else 1]]


def _elementwise(*names: str) -> Callable[[Case], dict[str, object]]:
    """Arguments of one shape, which has one to four axes."""
    return arguments_of(dict.fromkeys(names, "..."), {})


def with_each_array(sizes: Sizes, arguments: Callable[[Case], dict[str, object]]) -> Sizes:
    """The sizes, and which array is of a class of values, if there are several."""
    arrays = [name for name, a in arguments(simplest_case(sizes)).items() if np.ndim(a)]
    return sizes if len(arrays) == 1 else {**sizes, "of": (ORDINARY, *arrays)}


def simplest_case(sizes: Sizes) -> Case:
    return Case(tuple((name, options[0]) for name, options in sizes.items()), 0)


def _arctanh(case: Case) -> dict[str, object]:
    rng = case.rng()
    bound = float(rng.choice(BOUNDS))
    y = _elementwise("y")(case)["y"]
    if case.get("values") == "bound":
        bound = float(rng.choice([0.1, *BOUNDS, 0.99999, 1 - 1e-7]))
        near = [bound, np.nextafter(bound, 0), np.nextafter(bound, 1), bound + 1e-9, bound - 1e-9]
        y = rng.choice([*near, bound / 2, 1.0, 1.5], y.shape) * rng.choice([-1.0, 1.0], y.shape)
    return {"y": y if case.get("values") == "bound" else ARCTANH_REACH / 2 * y, "bound": bound}


def _mask(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return rng.random(shape) < rng.choice([0.5, 0.5, 0.0, 1.0])


def _gru(case: Case) -> dict[str, object]:
    """The arguments of `gru`, or of `gru_step` if the case has no frames."""
    rng = case.rng()
    batch, hidden, channels = (case[size] for size in ("batch", "hidden", "channels"))
    gates = 3 * hidden
    frames = case.get("frames", 0)
    x, state = ((batch, frames, channels), "h0") if frames else ((batch, channels), "h")
    weights = {"w": (channels, gates), "u": (hidden, gates), "b": (gates,), "c": (gates,)}
    arrays = drawn(case, rng, WEIGHT_REACH, x=x, **{state: (batch, hidden)}, **weights)
    if case.get("state") != ORDINARY:
        arrays[state] = VALUES[case.get("state")](rng, (batch, hidden), 1.0)
    if max(frames, hidden) > CHAOTIC:
        arrays["u"] = 0.1 * arrays["u"]
    return arrays


def _mean_squared_error(case: Case) -> dict[str, object]:
    arrays = _elementwise("x_hat", "x")(case)
    if case.get("values") == "zeros":  # of the difference
        arrays["x_hat"] = arrays["x"].copy()
    if case.get("values") == "near ties":
        arrays["x_hat"] = arrays["x"] * (1 + 1e-6)
    return arrays


def _sliced_wasserstein(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["points"], case["dimensions"])
    towards = (case["directions"], case["dimensions"])
    if case.get("of") == "directions":  # points of a grid would tie along its diagonals
        arrays = {"z": rng.uniform(-2, 2, shape), "prior": rng.uniform(-2, 2, shape)}
        directions = drawn(case, rng, directions=towards)["directions"]
        if case.get("values") == "identity":
            directions = np.eye(shape[1])  # the axes, whatever number the case states
    else:
        arrays = drawn(case, rng, z=shape, prior=shape)
        if case.get("values") in (ORDINARY, "near ties"):  # the same points, or as near as rounding
            arrays["prior"] = spread(rng, shape, 1.4)
        directions = rng.standard_normal(towards)
    directions = np.where(directions.any(axis=1, keepdims=True), directions, np.eye(1, shape[1]))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return arrays | {"directions": directions}


def _mean_of_equal_points(arguments: dict[str, object], gradient: np.ndarray) -> np.ndarray:
    """The gradient, averaged over equal points: any order of equal points is right."""
    z = arguments["z"] + 0.0
    if np.shape(gradient) != z.shape:
        return gradient
    _, group = np.unique(z, axis=0, return_inverse=True)
    member = (group.ravel()[:, None] == group.ravel()).astype(float)
    return (member / member.sum(axis=1, keepdims=True)) @ gradient


WITHOUT_TIES = {"values": (ORDINARY, "random", "near ties", "tiny", "large", "offset")}
TIED = tuple(name for name in EXTREME["values"] if name not in WITHOUT_TIES["values"])
SATURATES = {"saturates": True}
SELECTS = {"floor": 0.0}
ELEMENTWISE = {"floor": 64 * float(np.finfo(float).eps)}
POINTS_ALIKE = {"alike": _mean_of_equal_points}
_WINDOW = "batch frames channels"
_BANK = "taps channels filters"
_conv1d = arguments_of({"x": _WINDOW, "w": _BANK, "b": "filters"}, {})
_linear = arguments_of({"x": "... channels", "w": "channels features", "b": "features"}, {})
_pool = arguments_of({"x": _WINDOW}, {})
_unpool_random = arguments_of({"y": _WINDOW, "first": _WINDOW}, {"first": _mask})
_TABLE = (
    ("conv1d", FILTERED, _conv1d, "x w b", "x w", {}),
    ("transpose_filters", BANK, arguments_of({"w": _BANK}, {}), "w", "w", SELECTS),
    ("max_pool", PAIRS | EXTREME, _pool, "x", "", SELECTS | {"without_ties": WITHOUT_TIES}),
    ("unpool_even", WINDOW | EXTREME, arguments_of({"y": _WINDOW}, {}), "y", "y", SELECTS),
    ("unpool_random", WINDOW | EXTREME, _unpool_random, "y", "y", SELECTS),
    ("tanh", ANY_SHAPE | CLASSES, _elementwise("x"), "x", "", SATURATES | ELEMENTWISE),
    ("sigmoid", ANY_SHAPE | CLASSES, _elementwise("x"), "x", "", SATURATES | ELEMENTWISE),
    ("arctanh", ANY_SHAPE | AT_BOUNDS, _arctanh, "y", "", ELEMENTWISE),
    ("linear", LINEAR, _linear, "x w b", "x w", {}),
    ("gru_step", GRU, _gru, "x h w u b c", "", SATURATES),
    ("gru", GRU | FRAMES, _gru, "x h0 w u b c", "", SATURATES | SHORTER),
    ("mean_squared_error", ANY_SHAPE | CLASSES, _mean_squared_error, "x_hat", "", {}),
    ("mean_absolute", ANY_SHAPE | EXTREME, _elementwise("y"), "y", "", SELECTS),
    ("tied_layer", FILTERED, _conv1d, "x w b", "", SATURATES),
    ("sliced_wasserstein", POINTS | CLASSES, _sliced_wasserstein, "z", "", POINTS_ALIKE),
)


OPERATIONS: dict[str, Operation] = {
    name: Operation(
        name,
        with_each_array(sizes, arguments),
        arguments,
        tuple(differentiated.split()),
        linear_in=tuple(linear_in.split()),
        reference=getattr(ops, name, tied_layer),  # for the code of others; that of ops: by loops
        **others,
    )
    for name, sizes, arguments, differentiated, linear_in, others in _TABLE
}
