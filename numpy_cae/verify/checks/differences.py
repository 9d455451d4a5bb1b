"""One directional derivative by differences, and its comparison with a pullback's number.

Along a direction v the scalar L = Σ dy ∘ f(x) has the slope

    (L(x + h v) - L(x - h v)) / 2h      off by h² L'''/6 and by rounding, about ε|L|/h

so the best step is about the cube root of ε, times the scale of x. Where it does not confirm the
pullback, smaller or larger ones follow. If the slopes to the left and to the right stay apart
however small the step, as those of |x| at 0, any number between them is right. Otherwise the
remainder of Taylor's expansion decides without any tolerance: with the number g of the pullback

    |L(x + h v) - L(x) - h g|  falls as h² if g is the slope, and as h if it is not,

as long as rounding does not hide the remainder. Where it does, the most certain slope counts.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.verify.checks.mismatch import KINK

SMALLER = (1 / 8, 1 / 64, 1 / 512)
LARGER = (8, 64, 512, 2**12, 2**15, 2**18)
ROUNDING_MARGIN = 32
RATE_MARGIN = 0.1
"""A remainder that falls with a power of the step in this distance of 1 or of 2 decides."""
ABOVE_NOISE = 4
"""The remainder has to be so many times as large as rounding."""

NEGLIGIBLE = 1e-10
"""NEGLIGIBLE: beside a gradient of 0, to rounding, a slope of so small a part of the largest may be
the rounding of terms that cancel, as in a convolution by Fourier matrices."""

AGREES = "agrees"
WRONG = "wrong"


@dataclass(frozen=True)
class Slope:
    """A slope measured at one step size."""

    step: float
    central: float
    jump: float  # Σ |dy| · |slope to the right - slope to the left|, 0 for a straight line
    size: float  # Σ |dy| · |slope|, which the tolerance is relative to
    remainder: float  # |L(x + h v) - L(x) - h g|, the mean of both sides
    noise: float  # what rounding may have done
    moved: bool  # whether the step is large enough to change any output


@dataclass(frozen=True)
class Verdict:
    """What the slopes say about the pullback's number for one direction."""

    kind: str
    numeric: float
    analytic: float
    jump: float = np.nan  # from the slope on one side to that on the other
    rates: tuple[float, ...] = ()  # the powers of the step with which the remainder falls


@dataclass(frozen=True)
class Argument:
    """One argument x of a function, and the gradient that the pullback returned for it."""

    name: str
    f: Callable[[np.ndarray], np.ndarray]  # x -> one output, flat
    x: np.ndarray
    dy: np.ndarray
    here: np.ndarray  # f(x)
    gradient: np.ndarray
    epsilon: float
    tolerance: float

    def judge(self, direction: np.ndarray) -> Verdict:
        """Compare the pullback's number for a direction with slopes at several steps.

        The tolerance is relative to the larger of both numbers; where rounding hides the remainder,
        also to what all entries contribute to the slope.
        """
        analytic = float(np.sum(self.gradient * direction))
        first, along = np.cbrt(self.epsilon), self.x[direction != 0]
        nearest = np.min(np.abs(along / direction[direction != 0]), initial=1.0)  # entry to zero
        smaller = [*SMALLER, *((nearest, nearest / 8) if 0 < nearest < SMALLER[-1] else ())]
        depend = np.zeros(self.here.shape, dtype=bool)  # the outputs that have changed so far
        slopes: list[Slope] = []
        todo = [1.0, *smaller]
        while todo:
            slope = self._slope(direction, first * todo.pop(0), analytic, depend)
            if not np.isfinite([slope.central, slope.noise]).all():  # x + h is beyond f's domain
                continue
            larger = max(abs(slope.central), abs(analytic))
            gap, before = abs(slope.central - analytic), [abs(s.central - analytic) for s in slopes]
            small = min(16 * first * max(larger, slope.size), *[g / 8 for g in before], np.inf)
            conclusive = slope.noise <= small
            if conclusive and gap <= self.tolerance * larger + slope.noise:
                return Verdict(AGREES, slope.central, analytic)
            if not slopes and not (slope.moved and conclusive):
                todo += LARGER
            slopes.append(slope)
            if not todo and len(slopes) == 1 + len(smaller) and len(_rates(slopes[::-1])) < 2:
                todo += LARGER[:2]
        if not slopes:
            return Verdict(KINK, np.nan, analytic)
        change = abs(analytic) * max(slope.step for slope in slopes)
        rounded_away = ROUNDING_MARGIN * self.epsilon * np.sum(np.abs(self.dy * self.here))
        if not any(slope.moved for slope in slopes) and change <= rounded_away:
            return Verdict(AGREES, 0.0, analytic)
        verdict = _verdict(slopes, analytic, self.tolerance)
        largest = np.max(np.abs(self.gradient) * step_scale(self.x), initial=0.0)
        is_zero = abs(analytic) <= 64 * self.epsilon * largest
        is_rounding = is_zero and abs(verdict.numeric - analytic) <= NEGLIGIBLE * largest
        return replace(verdict, kind=AGREES) if is_rounding else verdict

    def _slope(
        self, direction: np.ndarray, step: float, analytic: float, depend: np.ndarray
    ) -> Slope:
        """The slope from both sides; what does not depend on x adds no rounding."""
        ahead = self.x + step * direction
        behind = self.x - step * direction
        plus = self.f(ahead)
        minus = self.f(behind)
        moved = direction != 0
        taken = float(np.median((ahead - behind)[moved] / direction[moved])) / 2  # x + h is rounded
        weight = np.abs(self.dy)
        bend = np.abs(plus - 2 * self.here + minus)
        moved_outputs = (plus != self.here) | (minus != self.here)
        depend |= moved_outputs
        size = np.maximum(np.abs(plus), np.abs(minus)) * depend
        rounding = ROUNDING_MARGIN * self.epsilon * np.sum(weight * (size + bend / step))
        right = float(np.sum(self.dy * (plus - self.here)))
        left = float(np.sum(self.dy * (self.here - minus)))
        return Slope(
            step=step,
            central=(right + left) / (2 * taken),
            jump=float(np.sum(weight * bend) / taken),
            size=float(np.sum(weight * np.abs(plus - minus)) / (2 * taken)),
            remainder=(abs(right - taken * analytic) + abs(left - taken * analytic)) / 2,
            noise=float(rounding / taken),
            moved=bool((moved_outputs & (self.dy != 0)).any()),
        )


def step_scale(x: np.ndarray) -> np.ndarray:
    """What the step of each entry of x is relative to: the larger of it and the median entry."""
    magnitude = np.abs(x)
    present = magnitude[magnitude > 0]
    typical = np.median(present) if present.size else 1.0
    return np.maximum(magnitude, typical)


def _verdict(slopes: list[Slope], analytic: float, tolerance: float) -> Verdict:
    """The verdict on a number that no slope confirmed at once."""
    moved = [slope for slope in slopes if slope.moved]
    slopes = sorted(moved or slopes, key=lambda slope: slope.step)
    neighbours = zip(slopes, [*slopes[1:], slopes[-2:][0]], strict=True)
    errors = [one.noise + abs(one.central - other.central) for one, other in neighbours]
    best = slopes[int(np.argmin(errors))]
    error = min(errors)
    numeric = best.central
    rates = _rates(slopes)
    gap = abs(numeric - analytic)
    larger = max(abs(numeric), abs(analytic))
    allowed = tolerance * max(larger, best.size) + error
    smallest = slopes[0]
    corner = smallest.jump > max(slopes[-1].jump / 2, smallest.noise, allowed)
    is_first_order = len(rates) > 1 and max(abs(rate - 1) for rate in rates[-2:]) < RATE_MARGIN
    is_second_order = len(rates) > 1 and min(rates[-2:]) > 2 - RATE_MARGIN
    hidden = RATE_MARGIN * slopes[-1 - len(rates)].remainder / slopes[-1 - len(rates)].step
    if corner and abs(smallest.central - analytic) <= smallest.jump / 2 + allowed:
        kind = AGREES if gap <= allowed else KINK
    elif is_first_order and gap > tolerance * larger + error:
        kind = WRONG
    else:
        is_right = is_second_order and hidden <= tolerance * larger
        kind = AGREES if is_right or gap <= allowed else WRONG
    return Verdict(kind, numeric, analytic, smallest.jump, rates)


def _rates(slopes: list[Slope]) -> tuple[float, ...]:
    """The powers of the step with which the remainder falls, from the largest step down.

    They end where rounding hides the remainder.
    """
    rates = []
    for smaller, larger in zip(slopes[-2::-1], slopes[:0:-1], strict=True):
        if smaller.remainder <= ABOVE_NOISE * smaller.noise * smaller.step:
            break
        fall = np.log(larger.remainder / smaller.remainder)
        rates.append(float(fall / np.log(larger.step / smaller.step)))
    return tuple(rates)
