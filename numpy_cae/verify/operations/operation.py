"""`OPERATIONS`: the arguments of every operation, its definition and its tolerances.

Sizes and tolerances are in the table `operations.toml`.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from numpy_cae import ops
from numpy_cae.ops import conv1d, tanh, transpose_filters
from numpy_cae.verify.operations.case import ORDINARY, Case, Sizes
from numpy_cae.verify.operations.shapes import (
    Arguments,
    add_choice_of_array,
    arguments_of,
    draw_arrays,
    shape_of,
)
from numpy_cae.verify.operations.values import VALUES, spread

TABLE = tomllib.loads(Path(__file__).with_name("operations.toml").read_text(encoding="utf-8"))
"""Sizes, shapes and tolerances of the operations, and the properties of single ones."""


def sizes_of(options: Mapping[str, list]) -> dict[str, tuple]:
    """Sizes and classes as they are written in the table, "*" for every class of values."""
    sizes = {}
    for name, listed in options.items():
        sizes[name] = (*VALUES, *listed[1:]) if listed[0] == "*" else tuple(listed)
    return sizes


LONGER = sizes_of(TABLE["longer"])
"""Additional sizes for the property "special inputs"."""


def _keep_gradient(arguments: Mapping[str, Any], gradient: Any) -> Any:
    """The gradient itself: of most operations there is one right gradient."""
    return gradient


@dataclass(frozen=True)
class Operation:
    """What the properties need to know of an operation.

    Gradients are compared with those of `reference`; without one, or `by_differences`, with
    differences of the value.
    """

    name: str
    sizes: Sizes  # the sizes and classes to draw from, the simplest first
    arguments: Arguments
    differentiated: tuple[str, ...]
    definition: Callable | None = None  # arguments -> value, if there is no reference
    linear_in: tuple[str, ...] = ()
    reference: Callable | None = None  # arguments -> (value, pullback)
    by_differences: bool = False  # then a right gradient of the reference is only shown
    saturates: bool = False  # derivatives may be far smaller than the terms they come from
    floor: float | None = None  # the rounding allowed per entry, if entries are compared singly
    without_ties: Sizes = field(default_factory=dict)  # classes of values without a kink
    longer: Sizes = field(default_factory=lambda: LONGER)  # additional sizes, "special inputs"
    canonical: Callable[[Mapping[str, Any], Any], Any] = _keep_gradient  # equal for all right ones
    seeded_by: str = ""  # what the cases depend on, by default the name
    drawn_by_caller: tuple[str, ...] = ()  # arguments that no property may alter
    nondeterminism: float = 0.0  # by how much repeated results may differ, relatively

    def value(self, *arguments: Any) -> Any:
        """The right value; an operation with neither reference nor definition has none."""
        if self.reference is not None:
            return self.reference(*arguments)[0]
        if self.definition is not None:
            return self.definition(*arguments)
        raise ValueError(f"{self.name} has no definition")

    @property
    def is_own(self) -> bool:
        """Whether it is an operation of one's own, of `properties_of`."""
        return bool(self.seeded_by)

    def takes_float32(self, case: Case) -> bool:
        """Whether an argument of a case is an array of float32."""
        arrays = self.arguments(case).values()
        return any(getattr(array, "dtype", None) == np.float32 for array in arrays)

    @property
    def has_right_value(self) -> bool:
        return self.reference is not None or self.definition is not None

    @property
    def has_right_gradients(self) -> bool:
        return self.reference is not None and not self.by_differences

    def floor_of(self, dy: np.ndarray | float) -> float | None:
        """The floor for a gradient, proportional to the upstream gradient."""
        if self.floor is None:
            return None
        return self.floor * max(1.0, float(np.max(np.abs(dy))))


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


BOUNDS = (0.5, 0.9, 0.99, 0.999)
WEIGHT_REACH = 1.0
"""Ordinary weights of a GRU are at most this; of one hidden unit, quarters."""
ARCTANH_REACH = 1.31
"""Ordinary arguments of arctanh are at most this, which is beyond every bound."""
CHAOTIC = 34
"""With more frames or hidden units, large weights of a GRU amplify rounding errors."""


def _arctanh_arguments(case: Case) -> dict[str, Any]:
    """Numbers within and beyond a bound; of the class "bound" also at it and beside it."""
    rng = case.rng()
    bound = float(rng.choice(BOUNDS))
    y = arguments_of({"y": "..."}, {})(case)["y"]
    if case.get("values") == "bound":
        bound = float(rng.choice([0.1, *BOUNDS, 0.99999, 1 - 1e-7]))
        near = [bound, np.nextafter(bound, 0), np.nextafter(bound, 1), bound + 1e-9, bound - 1e-9]
        y = rng.choice([*near, bound / 2, 1.0, 1.5], y.shape) * rng.choice([-1.0, 1.0], y.shape)
    return {"y": y if case.get("values") == "bound" else ARCTANH_REACH / 2 * y, "bound": bound}


def _mask(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """A mask that is mixed, all False or all True."""
    return rng.random(shape) < rng.choice([0.5, 0.5, 0.0, 1.0])


def _gru_arguments(name: str, case: Case) -> dict[str, Any]:
    """The arguments of `gru` or of `gru_step`."""
    rng = case.rng()
    texts = TABLE["operations"][name]["shapes"]
    shapes = {argument: shape_of(case, text) for argument, text in texts.items()}
    arrays = draw_arrays(case, rng, shapes, WEIGHT_REACH)
    _, state, *_ = arrays
    if case.get("state") != ORDINARY:
        arrays[state] = VALUES[case.get("state")](rng, shapes[state], 1.0)
    if max(case.get("frames", 0), case["hidden"]) > CHAOTIC:
        arrays["u"] = 0.1 * arrays["u"]
    return arrays


def _sliced_wasserstein_arguments(case: Case) -> dict[str, Any]:
    """Points, points of the prior and directions of length 1."""
    rng = case.rng()
    shape = (case["points"], case["dimensions"])
    towards = (case["directions"], case["dimensions"])
    if case.get("of") == "directions":  # points of a grid would tie along its diagonals
        arrays = {"z": rng.uniform(-2, 2, shape), "prior": rng.uniform(-2, 2, shape)}
        directions = draw_arrays(case, rng, {"directions": towards})["directions"]
        if case.get("values") == "identity":
            directions = np.eye(shape[1])  # the axes, whatever number the case states
    else:
        arrays = draw_arrays(case, rng, {"z": shape, "prior": shape})
        if case.get("values") in (ORDINARY, "near ties"):  # the same points, or as near as rounding
            arrays["prior"] = spread(rng, shape, 1.4)
        directions = rng.standard_normal(towards)
    directions = np.where(directions.any(axis=1, keepdims=True), directions, np.eye(1, shape[1]))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return arrays | {"directions": directions}


def _mean_of_equal_points(arguments: Mapping[str, Any], gradient: np.ndarray) -> np.ndarray:
    """The gradient, averaged over equal points: any order of equal points is right."""
    z = arguments["z"] + 0.0
    if np.shape(gradient) != z.shape:
        return gradient
    _, group = np.unique(z, axis=0, return_inverse=True)
    member = (group.ravel()[:, None] == group.ravel()).astype(float)
    return (member / member.sum(axis=1, keepdims=True)) @ gradient


_ARGUMENTS: dict[str, Arguments] = {
    "unpool_random": arguments_of(TABLE["operations"]["unpool_random"]["shapes"], {"first": _mask}),
    "arctanh": _arctanh_arguments,
    "gru_step": partial(_gru_arguments, "gru_step"),
    "gru": partial(_gru_arguments, "gru"),
    "sliced_wasserstein": _sliced_wasserstein_arguments,
}
"""How the arguments of an operation are drawn, if not by their shapes alone."""


def _operation(name: str, row: Mapping[str, Any]) -> Operation:
    """The operation that a row of the table describes."""
    arguments = _ARGUMENTS.get(name) or arguments_of(row["shapes"], {})
    floor = None
    if "floor" in row:
        floor = row["floor"] * float(np.finfo(float).eps)
    return Operation(
        name,
        add_choice_of_array(sizes_of(row["sizes"]), arguments),
        arguments,
        tuple(row["differentiated"].split()),
        linear_in=tuple(row.get("linear_in", "").split()),
        reference=getattr(ops, name, tied_layer),  # for the code of others; that of ops: by loops
        saturates=row.get("saturates", False),
        floor=floor,
        without_ties=sizes_of(row.get("without_ties", {})),
        longer=LONGER | sizes_of(row.get("longer", {})),
    )


OPERATIONS = {name: _operation(name, row) for name, row in TABLE["operations"].items()}
OPERATIONS["sliced_wasserstein"] = replace(
    OPERATIONS["sliced_wasserstein"], canonical=_mean_of_equal_points
)
