"""`OPERATIONS`: the arguments of every operation, its definition and its tolerances.

Sizes and tolerances are in the table `operations.toml`.
"""

import math
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from numpy_cae import ops
from numpy_cae.ops import conv1d, tanh, transpose_filters
from numpy_cae.verify.operations.case import ORDINARY, VALUES, Case, Sizes, drawn, spread

Values = tuple[float, float] | Callable[[np.random.Generator, tuple[int, ...]], np.ndarray]
"""The lowest and the highest number of an argument, or a function that draws it."""


@dataclass(frozen=True)
class Operation:
    """What the properties need to know of an operation.

    Gradients are compared with those of `reference`; without one, or `by_differences`, with
    differences of the value.
    """

    name: str
    sizes: Sizes  # the sizes and classes to draw from, the simplest first
    arguments: Callable[[Case], dict[str, object]]  # by name, in the order of the call
    differentiated: tuple[str, ...]
    definition: Callable | None = None  # arguments -> value, if there is no reference
    linear_in: tuple[str, ...] = ()
    reference: Callable | None = None  # arguments -> (value, pullback)
    by_differences: bool = False  # then a right gradient of the reference is only shown
    saturates: bool = False  # derivatives may be far smaller than the terms they come from
    floor: float | None = None  # the rounding allowed per entry, if entries are compared singly
    without_ties: Sizes = field(default_factory=dict)  # classes of values without a kink
    longer: Sizes = field(default_factory=lambda: LONG)  # additional sizes for `special inputs`
    alike: Callable = lambda arguments, gradient: gradient  # equal for all right gradients
    seeded_by: str = ""  # what the cases depend on, by default the name
    drawn_by_caller: tuple[str, ...] = ()  # arguments that no property may alter

    def value(self, *arguments: object) -> np.ndarray | float:
        """The right value."""
        return self.reference(*arguments)[0] if self.reference else self.definition(*arguments)

    @property
    def has_right_gradients(self) -> bool:
        return self.reference is not None and not self.by_differences

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


TABLE = tomllib.loads(Path(__file__).with_name("operations.toml").read_text(encoding="utf-8"))
"""TABLE: sizes, shapes and tolerances of the operations, and the properties of single ones."""
CLASSES = {"values": tuple(VALUES)}


def sizes_of(options: Mapping[str, list]) -> dict[str, tuple]:
    """Sizes and classes as they are written in the table, "*" for every class of values."""
    every = {name: VALUES if given[0] == "*" else given[:1] for name, given in options.items()}
    return {name: (*every[name], *given[1:]) for name, given in options.items()}


LONG = sizes_of(TABLE["longer"])
BOUNDS = (0.5, 0.9, 0.99, 0.999)
WEIGHT_REACH = 1.0
"""WEIGHT_REACH: ordinary weights of a GRU are at most this; of one hidden unit, quarters."""
ARCTANH_REACH = 1.31
"""ARCTANH_REACH: ordinary arguments of arctanh are at most this, which is beyond every bound."""
CHAOTIC = 34
"""CHAOTIC: with more frames or hidden units, large weights of a GRU amplify rounding errors."""


def arguments_of(
    shapes: Mapping[str, str], values: Mapping[str, Values], dtype: type = np.float64
) -> Callable[[Case], dict[str, object]]:
    """Arguments whose shapes are sizes, such as w="taps channels filters".

    A size may be a number, a product or sum such as 2*frames or in+out, or "...", which is any
    number of axes. Numbers outside of the range that `values` states are replaced by its ends.
    Floats have the dtype.
    """
    leading = leading_axes(shapes)

    def arguments(case: Case) -> dict[str, object]:
        rng = case.rng()
        any_axes = " ".join(leading[: case.get("axes", 0)])
        texts = {name: text.replace("...", any_axes) for name, text in shapes.items()}
        arrays = drawn(case, rng, **{name: shape_of(case, text) for name, text in texts.items()})
        for name, wanted in values.items():
            if callable(wanted):
                arrays[name] = wanted(rng, arrays[name].shape)
            else:
                low, high = wanted
                steps = np.clip(arrays[name], -2, 2)
                arrays[name] = np.clip((low + high) / 2 + (high - low) / 4 * steps, low, high)
        floats = {n: a.astype(dtype, copy=False) for n, a in arrays.items() if a.dtype.kind == "f"}
        return arrays | floats

    return arguments


def shape_of(case: Case, sizes: str) -> tuple[int, ...]:
    """The shape "batch 3*hidden 2" in a case."""
    return tuple(_size(text, case) for text in sizes.split())


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


def with_each_array(sizes: Sizes, arguments: Callable[[Case], dict[str, object]]) -> Sizes:
    """The sizes, and which array is of a class of values, if there are several."""
    arrays = [name for name, a in arguments(simplest_case(sizes)).items() if np.ndim(a)]
    return sizes if len(arrays) == 1 else {**sizes, "of": (ORDINARY, *arrays)}


def simplest_case(sizes: Sizes) -> Case:
    return Case(tuple((name, options[0]) for name, options in sizes.items()), 0)


def _arctanh(case: Case) -> dict[str, object]:
    rng = case.rng()
    bound = float(rng.choice(BOUNDS))
    y = arguments_of({"y": "..."}, {})(case)["y"]
    if case.get("values") == "bound":
        bound = float(rng.choice([0.1, *BOUNDS, 0.99999, 1 - 1e-7]))
        near = [bound, np.nextafter(bound, 0), np.nextafter(bound, 1), bound + 1e-9, bound - 1e-9]
        y = rng.choice([*near, bound / 2, 1.0, 1.5], y.shape) * rng.choice([-1.0, 1.0], y.shape)
    return {"y": y if case.get("values") == "bound" else ARCTANH_REACH / 2 * y, "bound": bound}


def _mask(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    return rng.random(shape) < rng.choice([0.5, 0.5, 0.0, 1.0])


def _gru(name: str, case: Case) -> dict[str, object]:
    """The arguments of `gru` or of `gru_step`."""
    rng = case.rng()
    texts = TABLE["operations"][name]["shapes"]
    shapes = {x: shape_of(case, text) for x, text in texts.items()}
    arrays = drawn(case, rng, WEIGHT_REACH, **shapes)
    _, state, *_ = arrays
    if case.get("state") != ORDINARY:
        arrays[state] = VALUES[case.get("state")](rng, shapes[state], 1.0)
    if max(case.get("frames", 0), case["hidden"]) > CHAOTIC:
        arrays["u"] = 0.1 * arrays["u"]
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


_DRAWN = {
    "unpool_random": arguments_of(TABLE["operations"]["unpool_random"]["shapes"], {"first": _mask}),
    "arctanh": _arctanh,
    "gru_step": partial(_gru, "gru_step"),
    "gru": partial(_gru, "gru"),
    "sliced_wasserstein": _sliced_wasserstein,
}
"""How the arguments of an operation are drawn, if not by their shapes alone."""


def _operation(name: str, row: Mapping) -> Operation:
    """The operation that a row of the table describes."""
    arguments = _DRAWN.get(name) or arguments_of(row["shapes"], {})
    alike = {"alike": _mean_of_equal_points} if name == "sliced_wasserstein" else {}
    return Operation(
        name,
        with_each_array(sizes_of(row["sizes"]), arguments),
        arguments,
        tuple(row["differentiated"].split()),
        linear_in=tuple(row.get("linear_in", "").split()),
        reference=getattr(ops, name, tied_layer),  # for the code of others; that of ops: by loops
        saturates=row.get("saturates", False),
        floor=row["floor"] * float(np.finfo(float).eps) if "floor" in row else None,
        without_ties=sizes_of(row.get("without_ties", {})),
        longer=LONG | sizes_of(row.get("longer", {})),
        **alike,
    )


OPERATIONS = {name: _operation(name, row) for name, row in TABLE["operations"].items()}
