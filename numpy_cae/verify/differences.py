"""One directional derivative by central differences, and its comparison with a pullback's.

Along a direction v the scalar L = Σ dy ∘ f(x) has the slope

    (L(x + h v) - L(x - h v)) / 2h      off by h² L'''/6 and by rounding, about ε|L|/h

so the best step is about the cube root of ε, times the scale of x. If the slope disagrees with the
pullback there are three possible reasons, distinguished by shrinking the step: large higher
derivatives (the slopes converge to the pullback's number), a wrong derivative (they converge to
another number), and a kink such as that of max or |x| (they do not converge, or the slopes to the
left and to the right stay apart however small the step).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

EPSILON = np.finfo(np.float64).eps
FIRST_STEP = np.cbrt(EPSILON)
SHRINK = (1, 8, 64, 512)
ROUNDING_MARGIN = 32

AGREES, WRONG, KINK = "agrees", "wrong", "kink"


@dataclass(frozen=True)
class Slope:
    """A slope measured at one step size."""

    central: float
    jump: float  # Σ |dy| · |slope to the right - slope to the left|, 0 for a straight line
    noise: float  # what rounding may have done: of f, and of x where the slope bends with x


@dataclass(frozen=True)
class Verdict:
    """What the slopes say about the pullback's number for one direction."""

    kind: str
    numeric: float
    analytic: float


def step_scale(x: np.ndarray) -> np.ndarray:
    """The scale of each entry of x, which its step is relative to.

    The larger of the entry itself and the median entry, so that neither a zero nor a single huge
    entry makes the others' steps useless.
    """
    magnitude = np.abs(x)
    present = magnitude[magnitude > 0]
    typical = np.median(present) if present.size else 1.0
    return np.maximum(magnitude, typical)


def measure(
    f: Callable[[np.ndarray], np.ndarray],
    x: np.ndarray,
    direction: np.ndarray,
    dy: np.ndarray,
    here: np.ndarray,
    step: float,
) -> Slope:
    """The slope of Σ dy ∘ f along `direction` at x, where f is `here`, from both sides."""
    plus, minus = f(x + step * direction), f(x - step * direction)
    weight = np.abs(dy)
    moved = plus != minus
    bend = np.abs(plus - 2 * here + minus)
    size = np.maximum(np.abs(plus), np.abs(minus))
    return Slope(
        central=float(np.sum(dy * (plus - minus)) / (2 * step)),
        jump=float(np.sum(weight * bend) / step),
        noise=float(
            ROUNDING_MARGIN * EPSILON * np.sum(weight * (size * moved + bend / step)) / step
        ),
    )


def judge(
    slope_at: Callable[[float], Slope], analytic: float, tolerance: float, floor: float
) -> Verdict:
    """Compare the pullback's number for a direction, `analytic`, with slopes at shrinking steps.

    The tolerance is relative to the larger of both numbers and `floor`, the size of a typical
    gradient.
    """
    slopes: list[Slope] = []
    settled = False
    for shrink in SHRINK:
        slope = slope_at(FIRST_STEP / shrink)
        allowed = tolerance * max(abs(slope.central), abs(analytic), floor) + slope.noise
        if abs(slope.central - analytic) <= allowed:
            return Verdict(AGREES, slope.central, analytic)
        settled = bool(slopes) and abs(slope.central - slopes[-1].central) <= allowed
        slopes.append(slope)
        if settled:
            break
    first, last = slopes[0], slopes[-1]
    corner = last.jump > max(first.jump / 2, allowed)
    within = abs(last.central - analytic) <= last.jump / 2 + allowed
    kind = KINK if (corner or not settled) and within else WRONG
    return Verdict(kind, last.central, analytic)
