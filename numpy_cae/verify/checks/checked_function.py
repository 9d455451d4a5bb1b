"""A function under a gradient check: its outputs, its gradients, and calls that repeat both."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from numpy_cae.verify.checks.calls import call_operation, gradients_of_leaves
from numpy_cae.verify.checks.differences import SINGLE
from numpy_cae.verify.checks.leaves import (
    all_leaves,
    copy_arrays,
    flatten_floats,
    is_float,
    outputs_of,
    rebuild,
)
from numpy_cae.verify.checks.messages import texts_that_differ
from numpy_cae.verify.checks.mismatch import ALTERED, REPEATED, Mismatch, require_finite

TOGETHER = "all arguments together"
"""The name in `only` for the check that moves equal entries by equal amounts."""

Upstream = Callable[[Any], Any]
"""(output) -> an upstream gradient in its shape."""


@dataclass(frozen=True, eq=False)
class OutputGradients:
    """One output's upstream gradient, and the gradients for each array from this output alone."""

    number: int  # of the output
    dy: Any
    gradients: list  # None for a part of the arguments without a gradient
    rounding: list  # what rounding the arrays of float32 once more may change of each gradient


ROUNDED = 2
"""Arrays of float32 are rounded so often to see what that changes of the gradients."""
AGAIN_FACTOR = -4.0
"""The pullback is called again with so many times the upstream gradient: an exact product."""
AGAIN = (
    "called again with -4 times the upstream gradient, the pullback does not return -4 times the "
    "gradients: it is not linear, or keeps something between calls"
)
OTHERWISE = (
    "called again, f returns another {}: if it draws random numbers, give it the mask, or seed its "
    "generator in each call"
)
OVERWRITTEN = "the gradient that was returned first is overwritten by the second"


@dataclass(frozen=True, eq=False)
class CheckedFunction:
    """A function, and the arguments that it is called with."""

    f: Callable
    inputs: Sequence
    names: Sequence[str]
    only: Sequence[str] | None
    tolerance: float = 0.0  # by how much repeated results may differ, relative to the largest

    @property
    def named_leaves(self) -> list[tuple[str, Any]]:
        """The parts of the arguments by name."""
        return all_leaves(self.inputs, self.names)

    @property
    def leaves(self) -> list:
        """The parts of the arguments."""
        return [leaf for _, leaf in self.named_leaves]

    def chooses(self, name: str) -> bool:
        """Whether this argument, or the argument that it is a part of, is to be checked."""
        if self.only is None:
            return True
        return name in self.only or name.partition("[")[0] in self.only

    def outputs(self, leaves: Sequence) -> tuple[Sequence, Callable]:
        """The outputs for some arrays in place of those of the arguments, and the pullback."""
        value, pullback = call_operation(self.f, rebuild(self.inputs, iter(leaves)))
        if isinstance(value, tuple | list):
            return value, lambda dys: pullback(tuple(dys))
        return [value], lambda dys: pullback(dys[0])

    def output_at(self, leaves: list, places: Sequence[int], output: int) -> Callable:
        """One output, flat, as a function of the arrays at some places, given in one row."""
        ends = np.cumsum([leaves[place].size for place in places])

        def output_of_row(row: np.ndarray) -> np.ndarray:
            arrays = copy_arrays(leaves)
            entries = np.ravel(row)
            for place, end in zip(places, ends, strict=True):
                shape = leaves[place].shape
                arrays[place] = entries[end - leaves[place].size : end].reshape(shape)
            with np.errstate(all="ignore"):
                value = self.f(*rebuild(self.inputs, iter(arrays)))[0]
            return np.ravel(outputs_of(value)[output])

        return output_of_row

    def pull(self, pullback: Callable, dys: Sequence) -> list:
        """The gradient for each array; raise a Mismatch if the upstream gradient is altered."""
        upstreams = copy_arrays(dys)
        gradients = gradients_of_leaves(self.inputs, self.names, pullback(upstreams))
        for after, before in zip(upstreams, dys, strict=True):
            _require_unaltered("the upstream gradient", after, before)
        for (name, _), gradient in zip(self.named_leaves, gradients, strict=True):
            if self.chooses(name) or self.chooses(TOGETHER):
                require_finite(f"the gradient for {name}", gradient)
        return gradients

    def gradients_by_output(self, upstream: Upstream) -> list[OutputGradients]:
        """For each output the gradients where the upstream gradients of all others are 0.

        Raise unless no argument is altered, a second call returns the same, and the pullback is
        proportional to the upstream gradient, one result independent of the next.
        """
        before = copy_arrays(self.leaves)
        value, pullback = self.outputs(self.leaves)
        outputs = copy_arrays(value)
        for output in outputs:
            require_finite("the value", output)
        dys = [_upstream_of(output, upstream) for output in outputs]
        gradients = self.pull(pullback, dys)
        first_gradients = copy_arrays(gradients)
        for (name, leaf), leaf_before in zip(self.named_leaves, before, strict=True):
            _require_unaltered(name, leaf, leaf_before)
        self._require_linear(pullback, dys, first_gradients, before)
        self._require_same(OVERWRITTEN, self._gradient_names, first_gradients, gradients)
        self._require_repeatable(before, outputs, dys, first_gradients)
        return self._gradients_of_each(pullback, dys, first_gradients)

    def _require_linear(
        self, pullback: Callable, dys: Sequence, gradients: Sequence, leaves: Sequence
    ) -> None:
        """Raise unless the pullback called again returns a multiple for a multiple."""
        multiples = self.pull(pullback, _multiply([AGAIN_FACTOR] * len(dys), dys))
        expected = _multiply([AGAIN_FACTOR] * len(gradients), gradients)
        sizes = [float(np.max(np.abs(leaf), initial=0.0)) for leaf in leaves if is_float(leaf)]
        self._require_same(AGAIN, self._gradient_names, expected, multiples, max(sizes))

    def _require_repeatable(
        self, leaves: Sequence, outputs: Sequence, dys: Sequence, gradients: Sequence
    ) -> None:
        """Raise unless a second call returns the same value and the same gradients."""
        outputs_again, pullback_again = self.outputs(copy_arrays(leaves))
        values = [f"value {number}" for number in range(len(outputs))]
        if len(outputs) == 1:
            values = ["the value"]
        self._require_same(OTHERWISE.format("value"), values, outputs, outputs_again)
        gradients_again = self.pull(pullback_again, dys)
        problem = OTHERWISE.format("gradient")
        self._require_same(problem, self._gradient_names, gradients, gradients_again)

    @property
    def _gradient_names(self) -> list[str]:
        """What the gradient for each part of the arguments is called."""
        return [f"the gradient for {name}" for name, _ in self.named_leaves]

    def _require_same(
        self,
        problem: str,
        subjects: Sequence[str],
        first: Sequence,
        second: Sequence,
        size: float = 0.0,
    ) -> None:
        """Raise a Mismatch with the problem and two numbers unless all floats agree.

        They may differ by rounding in the coarsest dtype that went in, and by the tolerance. What
        they are made of has this size: a gradient may be the difference of two weights.
        """
        expected = flatten_floats(first)
        largest = np.max(np.abs(expected), initial=0.0, where=np.isfinite(expected))
        epsilon = float(np.finfo(expected.dtype).eps)
        if any(getattr(leaf, "dtype", None) == np.float32 for leaf in self.leaves):
            epsilon = SINGLE
        roundings = REPEATED_ROUNDINGS * largest + TERM_ROUNDINGS * size
        allowed = epsilon * roundings + self.tolerance * largest
        for subject, right, result in zip(subjects, first, second, strict=True):
            if is_float(right):
                _require_close(problem, subject, np.asarray(right), np.asarray(result), allowed)

    def _gradients_of_each(
        self, pullback: Callable, dys: Sequence, gradients: list
    ) -> list[OutputGradients]:
        """The gradients of each output, which are all gradients where there is one output."""
        of_outputs = []
        for number, dy in enumerate(dys):
            if dy is None:  # an output without floats
                continue
            alone = _multiply(np.eye(len(dys))[number], dys)
            if len(dys) > 1:
                gradients = copy_arrays(self.pull(pullback, alone))
            rounding = self.rounding(alone, gradients)
            of_outputs.append(OutputGradients(number, dy, gradients, rounding))
        return of_outputs

    def rounding(self, dys: Sequence, gradients: Sequence) -> list:
        """What rounding the arrays of float32 once more changes of each gradient, at most."""
        rng = np.random.default_rng(0)
        leaves = self.leaves
        changes = [None if gradient is None else 0 * gradient for gradient in gradients]
        in_single = [i for i, x in enumerate(leaves) if getattr(x, "dtype", None) == np.float32]
        factors = np.array([-SINGLE, SINGLE], np.float32)
        if not in_single:
            return changes
        for _ in range(ROUNDED):
            rounded = copy_arrays(leaves)
            for i in in_single:
                rounded[i] *= 1 + rng.choice(factors, leaves[i].shape)
            moved_gradients = self.pull(self.outputs(rounded)[1], dys)
            for number, moved in enumerate(moved_gradients):
                change = changes[number]
                if change is not None:
                    changes[number] = np.maximum(change, np.abs(moved - gradients[number]))
        return changes


def _upstream_of(output: object, upstream: Upstream) -> Any:
    """An upstream gradient in the dtype of the output; None for an output without floats."""
    if not is_float(output):
        return None
    return np.array(upstream(output), np.asarray(output).dtype)[()]


def _multiply(factors: Sequence[float] | np.ndarray, dys: Sequence) -> list:
    """Each upstream gradient times its factor; None stays None."""
    return [None if dy is None else a * dy for a, dy in zip(factors, dys, strict=True)]


def _require_unaltered(name: str, array: object, before: Any) -> None:
    """Raise a Mismatch if an array is not what it was."""
    if isinstance(array, np.ndarray) and not np.array_equal(array, before, equal_nan=True):
        text = f"{name} was altered: an operation never changes its arguments"
        raise Mismatch(ALTERED, name, text)


NUMBER_DIGITS = 10
"""The two numbers of a repeated result have at least this many digits."""


REPEATED_ROUNDINGS = 1000
"""Repeated results may differ by so many roundings of the largest of them."""
TERM_ROUNDINGS = 16
"""Repeated results may also differ by so many roundings of the largest number they are made of."""


def _require_close(
    problem: str, subject: str, expected: np.ndarray, result: np.ndarray, allowed: float
) -> None:
    """Raise a Mismatch with both numbers where two arrays differ most, unless they agree."""
    if expected.shape != result.shape:
        shapes = f"{subject} has shape {result.shape}, at first {expected.shape}"
        raise Mismatch(REPEATED, problem, f"{problem}\n    {shapes}")
    if np.allclose(expected, result, 0, allowed, equal_nan=True):
        return
    off = np.nan_to_num(np.abs(result - expected), nan=np.inf)
    index = tuple(map(int, np.unravel_index(np.argmax(off), off.shape)))
    place = f" at index {index}" if index else ""
    numbers = texts_that_differ(float(result[index]), float(expected[index]), NUMBER_DIGITS)
    text = f"{problem}\n    {subject} is {numbers[0]}{place}, expected {numbers[1]}"
    raise Mismatch(REPEATED, problem, text)
