"""The checks and arguments of lesson 13, fast: a convolution with less and less work."""

import numpy as np

from numpy_cae.course.exercises.checks import checks, require_parts
from numpy_cae.course.solutions.lesson_13 import block_matrices
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.property import require_equal

MULTIPLY = "lambda a, b: a * b"


def block_arguments(case: Case) -> dict[str, object]:
    """The arguments of a convolution, and the matrices of its blocks."""
    matrices = zip("agc", block_matrices(case["taps"], case["block"]), strict=True)
    return {**OPERATIONS["conv1d"].arguments(case), **dict(matrices)}


@checks("three_products", "three")
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


def _require_part(matrices: list[np.ndarray], case: Case, frequencies: range) -> None:
    """Raise unless C ((A x) ∘ (G w)) is what these frequencies add to the sum over taps."""
    a, g, c = matrices
    points = a.shape[1]
    rng = case.rng()
    x = spread(rng, (points,))
    w = spread(rng, (case["taps"],))
    spectrum = np.fft.rfft(x) * np.conj(np.fft.rfft(w, points))
    spectrum[[f for f in range(len(spectrum)) if f not in frequencies]] = 0
    expected = np.fft.irfft(spectrum, points)[: case["frames"]]
    require_equal("C @ ((A @ x) * (G @ w))", c @ ((a @ x) * (g @ w)), expected)


def _products(points: int, frequencies: range) -> int:
    """Three products for a complex frequency and one for a real one."""
    return sum(1 if 2 * f in (0, points) else 3 for f in frequencies)


@checks("block_matrices", "value")
def _convolves(function, case, taps, frames):
    matrices = _checked_matrices(function(taps, frames), taps, frames)
    _require_part(matrices, case, range(taps + frames))


@checks("block_matrices", "few products")
def _few_products(function, case, taps, frames):
    products = len(_checked_matrices(function(taps, frames), taps, frames)[0])
    points = frames + taps - 1
    allowed = _products(points, range(points // 2 + 1))
    if products > allowed:
        raise AssertionError(
            f"{products} products for N = {points} points; three for a complex frequency and one "
            f"for a real one are {allowed}"
        )


@checks("one_frequency", "value")
def _part_of_the_sum(function, case, frequency, taps, frames):
    matrices = _checked_matrices(function(frequency, taps, frames), taps, frames)
    _require_part(matrices, case, range(frequency, frequency + 1))


@checks("one_frequency", "few products")
def _one_or_three(function, case, frequency, taps, frames):
    expected = _products(frames + taps - 1, range(frequency, frequency + 1))
    products = len(_checked_matrices(function(frequency, taps, frames), taps, frames)[0])
    if products != expected:
        raise AssertionError(f"A has {products} rows, expected {expected}")


def some_frequency(case: Case, rng: np.random.Generator, made: dict) -> int:
    """A frequency from 0 to half of the points."""
    return case.seed % ((case["frames"] + case["taps"] - 1) // 2 + 1)
