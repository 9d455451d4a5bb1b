"""The exercises of lesson 13, fast: a convolution rewritten until little of it is left to do."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.exercise import (
    Claim,
    Exercise,
    exercise,
    operation_exercise,
    same_as,
    unaltered,
)
from numpy_cae.course.exercises.lesson_03 import unfold
from numpy_cae.fast.blocks import blocks
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.operation import OPERATIONS, Operation
from numpy_cae.verify.property import require_equal

CONV1D = OPERATIONS["conv1d"]
BLOCK = {"taps": (1, 3, 5, 7), "frames": (1, 2, 3, 4, 5, 6)}


@dataclass
class Counted:
    """A product that knows how often it was asked for."""

    calls: int = field(default=0, repr=False)

    def __call__(self, a, b):
        self.calls += 1
        return a * b

    def __repr__(self) -> str:
        return "lambda a, b: a * b"


def conv1d_unfolded(x, w, b):
    """The rows of lesson 03 times the filters as one matrix."""
    taps, channels, filters = w.shape
    return unfold(x, taps) @ w.reshape(taps * channels, filters) + b


def conv1d_shifted(x, w, b):
    """A product for every tap, as `ops.conv1d` has it."""
    return ops.conv1d(x, w, b)[0]


def three_products(a, b, p, q, multiply):
    """(a + i b)(p + i q), after Gauss."""
    k1, k2, k3 = multiply(a + b, p), multiply(a, q - p), multiply(b, p + q)
    return k1 - k3, k1 + k2


def block_matrices(taps, frames):
    """A, G and C, from the package."""
    made = blocks(taps, frames)
    return made.a, made.g, made.c


def conv1d_by_blocks(x, w, b, a, g, c):
    """The package's fast convolution, whose matrices are its own."""
    return ops.fast.conv1d(x, w, b)


def _products(case: Case) -> dict[str, object]:
    rng = case.rng()
    numbers = spread(rng, (4, case["numbers"]))
    return {**dict(zip("abpq", numbers, strict=True)), "multiply": Counted()}


def _complex_product(three_products, case: Case) -> None:
    a, b, p, q, multiply = _products(case).values()
    real, imaginary = _parts(three_products(a, b, p, q, multiply), 2, "real, imaginary")
    expected = (a + 1j * b) * (p + 1j * q)
    require_equal("the real part", real, expected.real)
    require_equal("the imaginary part", imaginary, expected.imag)
    if multiply.calls == 0:
        raise AssertionError("multiply is never called: every product has to go through it")


def _three(three_products, case: Case) -> None:
    a, b, p, q, multiply = _products(case).values()
    three_products(a, b, p, q, multiply)
    if multiply.calls != 3:
        raise AssertionError(f"multiply is called {multiply.calls} times, expected 3")


def _block(case: Case) -> dict[str, object]:
    return {"taps": case["taps"], "frames": case["frames"]}


def _matrices(block_matrices, case: Case) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    taps, frames = _block(case).values()
    a, g, c = map(np.asarray, _parts(block_matrices(taps, frames), 3, "A, G, C"))
    products = len(a) if a.ndim else 0
    for name, found, expected in (
        ("A", a, (products, frames + taps - 1)),
        ("G", g, (products, taps)),
        ("C", c, (frames, products)),
    ):
        if found.shape != expected:
            raise AssertionError(f"{name} has shape {found.shape}, expected {expected}")
    return a, g, c


def _convolves(block_matrices, case: Case) -> None:
    taps, frames = _block(case).values()
    a, g, c = _matrices(block_matrices, case)
    rng = case.rng()
    x, w = spread(rng, (frames + taps - 1,)), spread(rng, (taps,))
    sums = [sum(x[t + k] * w[k] for k in range(taps)) for t in range(frames)]
    require_equal("C @ ((A @ x) * (G @ w))", c @ ((a @ x) * (g @ w)), np.array(sums))


def _few_products(block_matrices, case: Case) -> None:
    a, _, _ = _matrices(block_matrices, case)
    points = case["frames"] + case["taps"] - 1
    real = 1 if points % 2 else 2
    allowed = min(points, real) + 3 * ((points - real) // 2 if points > 1 else 0)
    if len(a) > allowed:
        raise AssertionError(
            f"{len(a)} products for N = {points} points; three for a complex frequency and one "
            f"for a real one are {allowed}"
        )


def _parts(returned, count: int, names: str):
    if not (isinstance(returned, tuple | list) and len(returned) == count):
        raise AssertionError(f"it does not return {count} things: {names}")
    return returned


def _with_matrices(case: Case) -> dict[str, object]:
    a, g, c = block_matrices(case["taps"], case["block"])
    matrices = {"a": a.copy(), "g": g.copy(), "c": c.copy()}  # the package's are read-only
    return {**CONV1D.arguments(case), **matrices}


def _value_exercise(name: str, hint: str, solution, given: tuple[str, ...] = ()) -> Exercise:
    claims = (
        Claim(
            "value",
            "y[t] = Σ_k x[t + k - K//2] w[k] + b, zeros beyond both ends",
            same_as(definitions.conv1d, CONV1D.arguments),
            3,
        ),
        unaltered(CONV1D.arguments),
    )
    return exercise(name, hint, solution, CONV1D.arguments, CONV1D.sizes, claims, given)


EXERCISES: tuple[Exercise, ...] = (
    _value_exercise(
        "conv1d_unfolded",
        "unfold(x, taps) has rows of K · C numbers, tap after tap; reshape w so that its rows "
        "come in the same order",
        conv1d_unfolded,
        given=("unfold",),
    ),
    _value_exercise(
        "conv1d_shifted",
        "pad once; for tap k, the slice of T frames that begins at frame k, times w[k]",
        conv1d_shifted,
    ),
    exercise(
        "three_products",
        "a p + b p is one product, (a + b) p. It is too much by b p for the real part and by b p "
        "for the imaginary one: which product mends both parts of each?",
        three_products,
        _products,
        {"numbers": (1, 2, 3)},
        (
            Claim(
                "value",
                "real and imaginary part of (a + i b)(p + i q)",
                _complex_product,
                2,
                "real is a p - b q, imaginary is a q + b p",
            ),
            Claim(
                "three",
                "multiply is called three times",
                _three,
                2,
                "k1 = (a + b) p stands in both parts; k1 minus what is the real part?",
            ),
            unaltered(_products),
        ),
    ),
    exercise(
        "block_matrices",
        "one frequency after the other, f = 0, ..., N // 2, three rows for each (one where f is 0 "
        "or N / 2); np.array(list of rows) at the end, and C is made as rows and transposed",
        block_matrices,
        _block,
        BLOCK,
        (
            Claim(
                "value",
                "C ((A x) ∘ (G w)) is the sum over taps, for every frame of the block",
                _convolves,
                4,
                "try it with one tap and one frame, where N is 1 and every matrix is 1 by 1; then "
                "with two frames. A frequency that is not real stands for its mirror image too",
            ),
            Claim(
                "few products",
                "three products for a frequency, one for a real one",
                _few_products,
                2,
                "frequencies above N / 2 are the mirror images of those below: leave them out",
            ),
        ),
    ),
    operation_exercise(
        Operation(
            "conv1d_by_blocks",
            {**CONV1D.sizes, "taps": (1, 3, 5), "block": (1, 2, 3, 4)},
            _with_matrices,
            ("x", "w", "b"),
            lambda x, w, b, a, g, c: definitions.conv1d(x, w, b),
            linear_in=("x", "w"),
        ),
        "cut the padded x into blocks of N frames that begin every L frames; then three products "
        "with matrices, as in the equations. Backward: the same lines transposed, last line first",
        conv1d_by_blocks,
        hints={
            "value": "the last block may hang over the end of the window: pad with zeros, and cut "
            "the result to T frames",
            "gradient for x": "neighbouring blocks read K - 1 frames in common: what both say "
            "about such a frame is added",
            "gradient for w": "all blocks of all windows used the same ŵ: sum over both, then Gᵀ",
            "gradient for b": "b was added to every frame of every window, not to the products",
            "dtype": "np.zeros makes float64 unless it is told otherwise",
        },
    ),
)
