"""The exercises of lesson 13, fast: a convolution rewritten with less and less work."""

import numpy as np

from numpy_cae.course.exercises.checks import Recorded, drawn, require_parts, size, states
from numpy_cae.course.exercises.exercise import composed_exercise, exercise
from numpy_cae.course.exercises.lesson_03 import CONV1D, convolution_exercise
from numpy_cae.course.solutions.lesson_13 import (
    block_matrices,
    conv1d_by_blocks,
    conv1d_shifted,
    conv1d_unfolded,
    one_frequency,
    three_products,
)
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal


def _product_arguments(case: Case) -> dict[str, object]:
    numbers = dict(zip("abpq", spread(case.rng(), (4, case["numbers"])), strict=True))
    return {**numbers, "multiply": Recorded("lambda a, b: a * b", lambda a, b: a * b)}


def _convolution_arguments(case: Case) -> dict[str, object]:
    matrices = zip("agc", block_matrices(case["taps"], case["block"]), strict=True)
    return {**CONV1D.arguments(case), **dict(matrices)}


@states("value", "real and imaginary part of (a + i b)(p + i q)", 2)
def _complex_product(function, case, a, b, p, q, multiply):
    returned = function(a, b, p, q, multiply)
    real, imaginary = require_parts(returned, ("real", "imaginary"))
    expected = (a + 1j * b) * (p + 1j * q)
    require_equal("the real part", real, expected.real)
    require_equal("the imaginary part", imaginary, expected.imag)
    if not multiply.calls:
        raise AssertionError("multiply is never called: use it for every product")


@states("three", "multiply is called three times")
def _three_calls(function, case, a, b, p, q, multiply):
    function(a, b, p, q, multiply)
    if len(multiply.calls) != 3:
        raise AssertionError(f"multiply is called {len(multiply.calls)} times, expected 3")


def _checked_matrices(returned: object, taps: int, frames: int) -> list[np.ndarray]:
    """A, G and C, with the shapes that they should have."""
    returned = require_parts(returned, ("A", "G", "C"))
    matrices = [np.asarray(matrix) for matrix in returned]
    products = len(matrices[0]) if matrices[0].ndim else 0
    shapes = ((products, frames + taps - 1), (products, taps), (frames, products))
    for name, matrix, shape in zip("AGC", matrices, shapes, strict=True):
        if matrix.shape != shape:
            raise AssertionError(f"{name} has shape {matrix.shape}, expected {shape}")
    return matrices


@states("value", "C ((A x) ∘ (G w)) is the sum over taps, for every frame of the block", 4)
def _convolves(function, case, taps, frames):
    a, g, c = _checked_matrices(function(taps, frames), taps, frames)
    rng = case.rng()
    x, w = spread(rng, (frames + taps - 1,)), spread(rng, (taps,))
    sums = [sum(x[t + k] * w[k] for k in range(taps)) for t in range(frames)]
    require_equal("C @ ((A @ x) * (G @ w))", c @ ((a @ x) * (g @ w)), np.array(sums))


@states("few products", "three products for a complex frequency, one for a real one", is_form=True)
def _few_products(function, case, taps, frames):
    products = len(_checked_matrices(function(taps, frames), taps, frames)[0])
    points = frames + taps - 1
    real = 1 if points % 2 else 2
    allowed = min(points, real) + 3 * ((points - real) // 2 if points > 1 else 0)
    if products > allowed:
        raise AssertionError(
            f"{products} products for N = {points} points; three for a complex frequency and one "
            f"for a real one are {allowed}"
        )


@states("value", "C ((A x) ∘ (G w)) is what this frequency and its conjugate add to the sum", 4)
def _part_of_the_sum(function, case, frequency, taps, frames):
    points = frames + taps - 1
    a, g, c = _checked_matrices(function(frequency, taps, frames), taps, frames)
    rng = case.rng()
    x, w = spread(rng, (points,)), spread(rng, (taps,))
    spectrum = np.fft.fft(x) * np.conj(np.fft.fft(w, points))
    spectrum[[f for f in range(points) if f not in (frequency, points - frequency)]] = 0
    expected = np.fft.ifft(spectrum).real[:frames]
    require_equal("C @ ((A @ x) * (G @ w))", c @ ((a @ x) * (g @ w)), expected)


@states("few products", "one product where the frequency is 0 or N/2, else three", is_form=True)
def _one_or_three(function, case, frequency, taps, frames):
    expected = 1 if 2 * frequency in (0, frames + taps - 1) else 3
    products = len(_checked_matrices(function(frequency, taps, frames), taps, frames)[0])
    if products != expected:
        raise AssertionError(f"A has {products} rows, expected {expected}")


def _some_frequency(case: Case, rng: np.random.Generator) -> int:
    return case.seed % ((case["frames"] + case["taps"] - 1) // 2 + 1)


SIZES = {"taps": (1, 3, 5, 7), "frames": (1, 2, 3, 4, 5, 6)}

EXERCISES = (
    convolution_exercise(conv1d_unfolded, given="unfold"),
    convolution_exercise(conv1d_shifted),
    exercise(
        three_products, _product_arguments, {"numbers": (1, 2, 3)}, _complex_product, _three_calls
    ),
    exercise(
        one_frequency,
        drawn(frequency=_some_frequency, taps=size("taps"), frames=size("frames")),
        SIZES,
        _part_of_the_sum,
        _one_or_three,
        pure=False,
    ),
    exercise(
        block_matrices,
        drawn(taps=size("taps"), frames=size("frames")),
        SIZES,
        _convolves,
        _few_products,
        pure=False,
    ),
    composed_exercise(
        conv1d_by_blocks,
        _convolution_arguments,
        "x w b",
        {**CONV1D.sizes, "taps": (1, 3, 5), "block": (1, 2, 3, 4)},
        linear_in=("x", "w"),
        given=(
            "arctanh max_pool tanh transpose_filters unpool_even decode_layer encode_layer "
            "mean_squared_error zero_values"
        ),
    ),
)
