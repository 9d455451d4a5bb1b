"""One directional derivative by differences, and its comparison with a pullback's number.

Along a direction v the scalar L = Σ dy ∘ f(x) has the slope

    (L(x + h v) - L(x - h v)) / 2h      off by h² L'''/6 and by rounding, about ε|L|/h

so the best step is about the cube root of ε, times the scale of x. Where it does not confirm the
pullback, smaller or larger ones follow. If the slopes to the left and to the right stay apart
however small the step, as those of |x| at 0, any number between them is right. Otherwise the
remainder of Taylor's expansion decides without any tolerance: with the number g of the pullback

    |L(x + h v) - L(x) - h g|  falls as h² if g is the slope, and as h if it is not,

as long as rounding does not hide the remainder. Where it does, the most certain slope counts.
Before a number is called wrong, slopes at neighbouring steps are measured, too: if these scatter as
much as the number is off, it is undecided.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from numpy_cae.verify.checks.call import KINK

SMALLER = (1 / 8, 1 / 64, 1 / 512)
LARGER = (8, 64, 512, 2**12, 2**15, 2**18)
"""SMALLER, LARGER: further steps are so many times the first one."""
LARGEST_STEP = 2
"""LARGEST_STEP: no step is larger than so many times the size of an entry."""
NEIGHBOURS = (0.8, 0.9, 1.1, 1.25)
"""NEIGHBOURS: a wrong number is confirmed at so many times the step of the most certain slope."""
VISIBLE = 1 / 8
"""VISIBLE: outputs that a step of so much of an entry does not move do not depend on it."""
LEVEL = 0.1
"""LEVEL: slopes at large steps count if they differ from the next by at most this part."""
SCATTER_MARGIN = 4
"""SCATTER_MARGIN: a number is wrong only if it is off by so many times their scatter."""
ROUNDING_MARGIN = 32
"""ROUNDING_MARGIN: rounding is taken to be at most so many times that of the outputs."""
CURVED = 4
"""CURVED: at so many times the step, a corner's jump has not doubled, but that of a curve has."""
RATE_MARGIN = 0.1
"""RATE_MARGIN: a remainder decides if the power with which it falls is so near to 1 or to 2."""
ABOVE_NOISE = 4
"""ABOVE_NOISE: the remainder counts where it is at least so many times as large as rounding."""
SINGLE = float(np.finfo(np.float32).eps)
SINGLE_TOLERANCE = 1e-4
"""SINGLE_TOLERANCE: the relative tolerance is at least this where f computes in float32."""

AGREES = "agrees"
WRONG = "wrong"
UNDECIDED = "undecided"


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


@dataclass(frozen=True, eq=False)
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
    rounding: np.ndarray | float = 0.0  # what rounding the arguments to float32 may change of it

    def judge(self, direction: np.ndarray) -> Verdict:
        """Compare the pullback's number for a direction with slopes at several steps.

        The tolerance is relative to the larger of both numbers; where rounding hides the remainder,
        also to what all entries contribute to the slope.
        """
        verdict = self._judged(direction)
        if verdict.kind != AGREES and self.epsilon < SINGLE and self.is_computed_in_float32():
            tolerance = max(self.tolerance, SINGLE_TOLERANCE)
            return replace(self, epsilon=SINGLE, tolerance=tolerance)._judged(direction)
        return verdict

    def _judged(self, direction: np.ndarray) -> Verdict:
        analytic = float(np.sum(self.gradient * direction))
        slopes, confirmed = self._measured(direction, analytic)
        if not slopes:
            return Verdict(KINK, np.nan, analytic)
        if confirmed:
            return Verdict(AGREES, slopes[-1].central, analytic)
        verdict, best = _verdict(slopes, analytic, self.tolerance)
        if verdict.kind == WRONG:
            return replace(verdict, kind=self._confirmed(direction, verdict, best))
        return verdict

    def _measured(self, direction: np.ndarray, analytic: float) -> tuple[list[Slope], bool]:
        """Slopes at smaller and, where these do not decide, at larger steps.

        Of one entry, outputs that never change add no rounding: they do not depend on it. Also
        whether the last one confirms the pullback's number, which ends the search.
        """
        first = np.cbrt(self.epsilon)
        along = self.x[direction != 0]
        nearest = np.min(np.abs(along / direction[direction != 0]), initial=1.0)  # entry to zero
        is_near = np.sqrt(self.epsilon) < nearest < SMALLER[-1]  # and not too near for any step
        smaller = [*SMALLER, *((nearest, nearest / 8) if is_near else ())]
        depend = np.full(self.here.shape, np.count_nonzero(direction) > 1)
        slopes: list[Slope] = []
        todo = [1.0, *smaller]
        while todo:
            slope = self._slope(direction, first * todo.pop(0), analytic, depend)
            if not np.isfinite([slope.central, slope.noise]).all():  # x + h is beyond f's domain
                continue
            larger = max(abs(slope.central), abs(analytic))
            gap = abs(slope.central - analytic)
            eighths = [abs(before.central - analytic) / 8 for before in slopes]
            small = min(16 * first * max(larger, slope.size), *eighths, np.inf)
            is_conclusive = slope.noise <= small
            slopes.append(slope)
            if is_conclusive and gap <= self.tolerance * larger + slope.noise:
                return slopes, True
            if len(slopes) == 1 and not (slope.moved and is_conclusive):
                todo += [factor for factor in LARGER if first * factor <= LARGEST_STEP]
            if not todo and len(slopes) == 1 + len(smaller) and len(_rates(slopes[::-1])) < 2:
                todo += LARGER[:2]
        # Outputs that only a larger step moves are rounded at the smaller ones, too.
        self._slope(direction, VISIBLE, analytic, depend)
        return [self._slope(direction, one.step, analytic, depend) for one in slopes], False

    def is_computed_in_float32(self) -> bool:
        """Whether f rounds x, or its outputs, to float32, as a float32 buffer does."""
        rounded = self.x.astype(np.float32).astype(np.float64)
        near = rounded * (1 + SINGLE / 128)
        change = np.sum(np.abs(self.gradient * (near - rounded)))
        rounding = ROUNDING_MARGIN * self.epsilon * np.sum(np.abs(self.dy * self.here))
        y = self.f(near)
        is_single = is_of_float32(y) or np.array_equal(y, self.f(rounded))
        return is_single and bool(change > rounding)

    def _confirmed(self, direction: np.ndarray, verdict: Verdict, best: Slope) -> str:
        """WRONG, or UNDECIDED where slopes at neighbouring steps scatter as much as they are off.

        The scatter contains rounding within f, which no output shows where large terms cancel.
        """
        depend = np.full(self.here.shape, np.count_nonzero(direction) > 1)
        steps = [best.step * factor for factor in NEIGHBOURS]
        found = [self._slope(direction, step, verdict.analytic, depend).central for step in steps]
        scatter = np.ptp([*found, best.central])
        larger = max(abs(verdict.numeric), abs(verdict.analytic))
        off = min(abs(slope - verdict.analytic) for slope in (*found, verdict.numeric))
        dy = np.abs(self.dy)
        weight = np.sum(dy[depend]) or np.sum(dy)  # no output moves: each may be rounded
        terms = weight * np.max(np.abs(self.here), initial=0.0)
        terms += np.sum(np.abs(self.gradient * direction))
        of_single = np.sum(self.rounding * np.abs(direction))
        rounding = ROUNDING_MARGIN * (self.epsilon * terms + of_single)  # of the gradient
        is_wrong = off > self.tolerance * larger + SCATTER_MARGIN * scatter + rounding
        return WRONG if is_wrong else UNDECIDED

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


def is_of_float32(array: np.ndarray | float) -> bool:
    """Whether numbers have no more digits than float32, whatever their dtype."""
    return np.array_equal(array, np.asarray(array, np.float32))


def step_scale(x: np.ndarray) -> np.ndarray:
    """What the step of each entry of x is relative to: the larger of it and the median entry."""
    magnitude = np.abs(x)
    present = magnitude[magnitude > 0]
    typical = np.median(present) if present.size else 1.0
    return np.maximum(magnitude, typical)


def _verdict(slopes: list[Slope], analytic: float, tolerance: float) -> tuple[Verdict, Slope]:
    """The verdict on a number that no slope confirmed at once, and the most certain slope."""
    first = slopes[0].step
    informative = [slope for slope in slopes if slope.moved or slope.noise > 0]
    slopes = sorted(informative or slopes, key=lambda slope: slope.step)
    errors = [_error(one, other, first) for one, other in pairwise([*slopes, *slopes[-2:][:1]])]
    best = slopes[int(np.argmin(errors))]
    gap = abs(best.central - analytic)
    tolerated = tolerance * max(abs(best.central), abs(analytic))
    allowed = max(tolerated, tolerance * best.size) + min(errors)
    clear = next((slope for slope in slopes if slope.noise <= slope.jump / 4), slopes[0])
    beyond = next((slope for slope in slopes if slope.step > CURVED * clear.step), clear)
    is_corner = clear.jump > max(beyond.jump / 2, clear.noise, allowed)
    rates = _rates(slopes)
    power = _power(rates)
    hidden = slopes[-1 - len(rates)]  # the largest step whose remainder is rounding
    kind = AGREES if gap <= allowed else WRONG
    if is_corner and abs(best.central - analytic) <= best.jump / 2 + allowed:
        kind = AGREES if gap <= allowed else KINK
    elif power == 1 and gap > tolerated + min(errors):
        kind = WRONG
    elif power == 2 and RATE_MARGIN * hidden.remainder <= tolerated * hidden.step:
        kind = AGREES
    return Verdict(kind, best.central, analytic, clear.jump, rates if power == 1 else ()), best


def _power(rates: tuple[float, ...]) -> int:
    """The power of the step that the remainder falls with: 1 or 2, or 0 where it is neither."""
    last = rates[-2:]
    if len(last) == 2 and max(abs(rate - 1) for rate in last) < RATE_MARGIN:
        return 1
    return 2 if len(last) == 2 and min(last) > 2 - RATE_MARGIN else 0


def _error(one: Slope, other: Slope, first: float) -> float:
    """What a slope may be off by, beside that at the next step; infinite if it says nothing.

    At steps larger than the first one only slopes count that hardly change from step to step.
    """
    change = abs(one.central - other.central)
    is_level = change < LEVEL * abs(one.central)
    return one.noise + change if one.step <= first or is_level else np.inf


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
