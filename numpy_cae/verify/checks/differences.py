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

import numpy as np

from numpy_cae.verify.checks.mismatch import KINK, UNDECIDED

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


SMALLER = (1 / 8, 1 / 64, 1 / 512)
"""Smaller steps are so many times the first one."""
LARGER = (8, 64, 512, 2**12, 2**15, 2**18)
"""Larger steps are so many times the first one."""
LARGEST_STEP = 2
"""No step is larger than so many times the size of an entry."""
NEIGHBOURS = (0.8, 0.9, 1.1, 1.25)
"""A wrong number is confirmed at so many times the step of the most certain slope."""
VISIBLE = 1 / 8
"""Outputs that a step of so much of an entry does not move do not depend on it."""


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
        verdict = self._judge_at_precision(direction)
        if verdict.kind != AGREES and self.epsilon < SINGLE and self.is_computed_in_float32():
            tolerance = max(self.tolerance, SINGLE_TOLERANCE)
            in_single = replace(self, epsilon=SINGLE, tolerance=tolerance)
            return in_single._judge_at_precision(direction)
        return verdict

    def _judge_at_precision(self, direction: np.ndarray) -> Verdict:
        """Compare at the precision of `epsilon`."""
        analytic = float(np.sum(self.gradient * direction))
        slopes, is_confirmed = self._measure_slopes(direction, analytic)
        if not slopes:
            return Verdict(KINK, np.nan, analytic)
        if is_confirmed:
            return Verdict(AGREES, slopes[-1].central, analytic)
        verdict, best = _judge_slopes(slopes, analytic, self.tolerance)
        if verdict.kind == WRONG and not self._is_certain(direction, verdict, best):
            return replace(verdict, kind=UNDECIDED)
        return verdict

    def _measure_slopes(self, direction: np.ndarray, analytic: float) -> tuple[list[Slope], bool]:
        """Slopes at smaller and, where these do not decide, at larger steps.

        Of one entry, outputs that never change add no rounding: they do not depend on it. Also
        whether the last one confirms the pullback's number, which ends the search.
        """
        first = np.cbrt(self.epsilon)
        smaller = [*SMALLER, *self._steps_before_zero(direction)]
        depend = self._outputs_in_doubt(direction)
        slopes: list[Slope] = []
        factors = [1.0, *smaller]
        while factors:
            slope = self._slope(direction, first * factors.pop(0), analytic, depend)
            if not np.isfinite([slope.central, slope.noise]).all():  # x + h is beyond f's domain
                continue
            larger = max(abs(slope.central), abs(analytic))
            is_conclusive = slope.noise <= _noise_allowed(slope, slopes, analytic, first)
            slopes.append(slope)
            gap = abs(slope.central - analytic)
            if is_conclusive and gap <= self.tolerance * larger + slope.noise:
                return slopes, True
            if len(slopes) == 1 and not (slope.moved and is_conclusive):
                factors += [factor for factor in LARGER if first * factor <= LARGEST_STEP]
            is_last = not factors and len(slopes) == 1 + len(smaller)
            if is_last and len(_rates(slopes[::-1])) < 2:
                factors += LARGER[:2]
        # Outputs that only a larger step moves are rounded at the smaller ones, too.
        self._slope(direction, VISIBLE, analytic, depend)
        return [self._slope(direction, slope.step, analytic, depend) for slope in slopes], False

    def _steps_before_zero(self, direction: np.ndarray) -> tuple[float, ...]:
        """Steps that end at the nearest entry's 0, and well before it, in place of beyond it.

        There are none if 0 is farther than the smallest step, or too near for any step.
        """
        moved = direction != 0
        nearest = float(np.min(np.abs(self.x[moved] / direction[moved]), initial=1.0))
        if np.sqrt(self.epsilon) < nearest < SMALLER[-1]:
            return nearest, nearest / 8
        return ()

    def _outputs_in_doubt(self, direction: np.ndarray) -> np.ndarray:
        """Whether each output is taken to depend on x; of one entry, none before it has moved."""
        return np.full(self.here.shape, np.count_nonzero(direction) > 1)

    def is_computed_in_float32(self) -> bool:
        """Whether f rounds x, or its outputs, to float32, as a float32 buffer does."""
        rounded = self.x.astype(np.float32).astype(np.float64)
        near = rounded * (1 + SINGLE / 128)
        change = np.sum(np.abs(self.gradient * (near - rounded)))
        rounding = ROUNDING_MARGIN * self.epsilon * np.sum(np.abs(self.dy * self.here))
        y = self.f(near)
        is_single = is_of_float32(y) or np.array_equal(y, self.f(rounded))
        return is_single and bool(change > rounding)

    def _is_certain(self, direction: np.ndarray, verdict: Verdict, best: Slope) -> bool:
        """Whether a number is off by more than the slopes at neighbouring steps scatter.

        The scatter contains rounding within f, which no output shows where large terms cancel.
        """
        depend = self._outputs_in_doubt(direction)
        slopes = []
        for factor in NEIGHBOURS:
            slope = self._slope(direction, best.step * factor, verdict.analytic, depend)
            slopes.append(slope.central)
        scatter = np.ptp([*slopes, best.central])
        larger = max(abs(verdict.numeric), abs(verdict.analytic))
        off = min(abs(slope - verdict.analytic) for slope in (*slopes, verdict.numeric))
        rounding = self._rounding_of_gradient(direction, depend)
        return bool(off > self.tolerance * larger + SCATTER_MARGIN * scatter + rounding)

    def _rounding_of_gradient(self, direction: np.ndarray, depend: np.ndarray) -> float:
        """What rounding may have changed of the pullback's number."""
        dy = np.abs(self.dy)
        weight = np.sum(dy[depend]) or np.sum(dy)  # no output moves: each may be rounded
        terms = weight * np.max(np.abs(self.here), initial=0.0)
        terms += np.sum(np.abs(self.gradient * direction))
        of_single = np.sum(self.rounding * np.abs(direction))
        return ROUNDING_MARGIN * (self.epsilon * terms + of_single)

    def _slope(
        self, direction: np.ndarray, step: float, analytic: float, depend: np.ndarray
    ) -> Slope:
        """The slope from both sides; what does not depend on x adds no rounding."""
        ahead = self.x + step * direction
        behind = self.x - step * direction
        y_ahead = self.f(ahead)
        y_behind = self.f(behind)
        moved = direction != 0
        # x + h is rounded: the step is what was added.
        spans = (ahead - behind)[moved] / direction[moved]
        span = spans[0] if spans.size == 1 else np.median(spans)  # np.median is slow
        h = float(span) / 2
        weight = np.abs(self.dy)
        bend = np.abs(y_ahead - 2 * self.here + y_behind)
        moved_outputs = (y_ahead != self.here) | (y_behind != self.here)
        depend |= moved_outputs
        size = np.maximum(np.abs(y_ahead), np.abs(y_behind)) * depend
        rounding = ROUNDING_MARGIN * self.epsilon * np.sum(weight * (size + bend / step))
        rise_ahead = float(np.sum(self.dy * (y_ahead - self.here)))
        rise_behind = float(np.sum(self.dy * (self.here - y_behind)))
        return Slope(
            step=step,
            central=(rise_ahead + rise_behind) / (2 * h),
            jump=float(np.sum(weight * bend) / h),
            size=float(np.sum(weight * np.abs(y_ahead - y_behind)) / (2 * h)),
            remainder=(abs(rise_ahead - h * analytic) + abs(rise_behind - h * analytic)) / 2,
            noise=float(rounding / h),
            moved=bool((moved_outputs & (self.dy != 0)).any()),
        )


SINGLE = float(np.finfo(np.float32).eps)
SINGLE_TOLERANCE = 1e-4
"""The relative tolerance is at least this where f computes in float32."""


def is_of_float32(array: np.ndarray | float) -> bool:
    """Whether numbers have no more digits than float32, whatever their dtype."""
    return np.array_equal(array, np.asarray(array, np.float32))


def step_scale(x: np.ndarray) -> np.ndarray:
    """What the step of each entry of x is relative to: the larger of it and the median entry."""
    magnitude = np.abs(x)
    present = magnitude[magnitude > 0]
    typical = np.median(present) if present.size else 1.0
    return np.maximum(magnitude, typical)


CONCLUSIVE = 16
"""A slope is conclusive if its rounding is at most this many times the first step, relatively."""


ROUNDING_MARGIN = 32
"""Rounding is taken to be at most this many times that of the outputs."""


def _noise_allowed(slope: Slope, before: list[Slope], analytic: float, first: float) -> float:
    """The rounding with which a slope is still conclusive.

    It is relative to the slope, and at most an eighth of what earlier slopes were off by.
    """
    larger = max(abs(slope.central), abs(analytic))
    allowed = CONCLUSIVE * first * max(larger, slope.size)
    eighths = [abs(earlier.central - analytic) / 8 for earlier in before]
    return min(allowed, *eighths, np.inf)


SCATTER_MARGIN = 4
"""A number is wrong only if it is off by so many times the scatter of the slopes."""


def _judge_slopes(slopes: list[Slope], analytic: float, tolerance: float) -> tuple[Verdict, Slope]:
    """The verdict on a number that no slope confirmed at once, and the most certain slope."""
    first = slopes[0].step
    informative = [slope for slope in slopes if slope.moved or slope.noise > 0]
    slopes = sorted(informative or slopes, key=lambda slope: slope.step)
    best, error = _most_certain(slopes, first)
    gap = abs(best.central - analytic)
    tolerated = tolerance * max(abs(best.central), abs(analytic))
    allowed = max(tolerated, tolerance * best.size) + error
    corner = _clearest_corner(slopes)
    rates = _rates(slopes)
    power = _power(rates)
    kind = AGREES if gap <= allowed else WRONG
    if _is_corner(corner, slopes, allowed) and gap <= best.jump / 2 + allowed:
        kind = AGREES if gap <= allowed else KINK
    elif power == 1 and gap > tolerated + error:
        kind = WRONG
    elif power == 2:
        hidden = slopes[-1 - len(rates)]  # the largest step whose remainder is rounding
        if RATE_MARGIN * hidden.remainder <= tolerated * hidden.step:
            kind = AGREES
    if power != 1:
        rates = ()
    return Verdict(kind, best.central, analytic, corner.jump, rates), best


def _most_certain(slopes: list[Slope], first: float) -> tuple[Slope, float]:
    """The slope that is off by least, and by how much it may be off; smallest step first."""
    errors = []
    for number, slope in enumerate(slopes):
        is_last = number == len(slopes) - 1
        neighbour = slopes[max(0, number - 1)] if is_last else slopes[number + 1]
        errors.append(_error(slope, neighbour, first))
    return slopes[int(np.argmin(errors))], min(errors)


def _clearest_corner(slopes: list[Slope]) -> Slope:
    """The slope at the smallest step whose jump is clear of rounding, else at the smallest step."""
    for slope in slopes:
        if slope.noise <= slope.jump / 4:
            return slope
    return slopes[0]


CURVED = 4
"""At so many times the step, a corner's jump has not doubled, but that of a curve has."""


def _is_corner(clear: Slope, slopes: list[Slope], allowed: float) -> bool:
    """Whether the jump is that of a corner, not of a curve, whose jump grows with the step."""
    beyond = clear
    for slope in slopes:
        if slope.step > CURVED * clear.step:
            beyond = slope
            break
    return clear.jump > max(beyond.jump / 2, clear.noise, allowed)


RATE_MARGIN = 0.1
"""A remainder decides if the power with which it falls is so near to 1 or to 2."""


def _power(rates: tuple[float, ...]) -> int:
    """The power of the step that the remainder falls with: 1 or 2, or 0 where it is neither."""
    last = rates[-2:]
    if len(last) < 2:
        return 0
    if max(abs(rate - 1) for rate in last) < RATE_MARGIN:
        return 1
    return 2 if min(last) > 2 - RATE_MARGIN else 0


LEVEL = 0.1
"""Slopes at large steps count if they differ from the next by at most this part."""


def _error(slope: Slope, neighbour: Slope, first: float) -> float:
    """What a slope may be off by: its rounding, and its difference from that at the next step.

    It is infinite if the slope says nothing: at steps larger than the first one only slopes count
    that hardly change from step to step.
    """
    change = abs(slope.central - neighbour.central)
    is_level = change < LEVEL * abs(slope.central)
    return slope.noise + change if slope.step <= first or is_level else np.inf


ABOVE_NOISE = 4
"""The remainder counts where it is at least this many times as large as rounding."""


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
