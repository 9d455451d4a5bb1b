"""One property tried on one implementation: hypothesis draws examples and shrinks what fails.

An outcome keeps the smallest counterexample. The calls of the first failing examples are kept as
well and played to the bugs of the zoo: one that behaves exactly alike says what the mistake is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

try:
    from hypothesis import HealthCheck, Phase, given, settings
    from hypothesis import strategies as st
except ImportError as missing:  # pragma: no cover (hypothesis is there wherever tests run)
    raise ImportError(
        "trying properties needs hypothesis, which draws the examples: "
        "pip install 'numpy_cae[test]', or pip install hypothesis"
    ) from missing

from numpy_cae.verify.case import Case, described
from numpy_cae.verify.diagnosis import mistake_in_error
from numpy_cae.verify.operation import OPERATIONS, Sizes
from numpy_cae.verify.property import Property, drawn_upstream
from numpy_cae.verify.witness import Witness
from numpy_cae.verify.zoo import bugs_of

FAILURES_KEPT = 3
GENERAL_CASES = 8


class Abandoned(BaseException):
    """An implementation that cannot be tried any further: it hangs, or its process is gone.

    Not an Exception, lest hypothesis try to find a smaller example of it.
    """


@dataclass(frozen=True)
class Outcome:
    """How a property fared. Where it did not hold: why, at what, and the likely mistake."""

    property: Property
    held: bool
    problem: str = ""
    counterexample: str = ""
    mistake: str = ""

    @property
    def points(self) -> int:
        return self.property.points if self.held else 0


def cases(sizes: Sizes) -> st.SearchStrategy[Case]:
    """Every case of these sizes, the simplest first."""
    drawn = st.fixed_dictionaries(
        {name: st.sampled_from(options) for name, options in sizes.items()}
    )
    seeds = st.integers(0, 9999)
    return st.builds(lambda sizes, seed: Case(tuple(sizes.items()), seed), drawn, seeds)


def try_property(
    tried: Property, implementation: Callable, examples: int | None = None, shrink: bool = True
) -> Outcome:
    """Hold an implementation to a property on drawn examples, the same ones every time.

    Parameters
    ----------
    tried : Property
    implementation : callable
        In the form of the operation in `numpy_cae.ops`.
    examples : int, optional
        By default as many as the property says.
    shrink : bool
        Whether to look for the smallest counterexample rather than take the first.
    """
    failures: list[tuple[Case, Exception]] = []
    witnesses: list[Witness] = []

    @settings(
        max_examples=examples or tried.examples,
        derandomize=True,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.generate, Phase.shrink] if shrink else [Phase.generate],
        report_multiple_bugs=False,
    )
    @given(case=cases(tried.sizes))
    def attempt(case: Case) -> None:
        witness = Witness(implementation)
        try:
            tried.check(witness, case)
        except Exception as error:
            failures.append((case, error))
            if len(witnesses) < FAILURES_KEPT:
                witnesses.append(witness)
            raise

    try:
        attempt()
    except Abandoned as end:
        return Outcome(tried, held=False, problem=str(end))
    except Exception:
        if not failures:  # then it is ours and not the implementation's
            raise
        case, error = failures[-1]
        try:
            mistake = _known_bug(tried, implementation, witnesses) or _mistake_in(error)
        except Abandoned:
            mistake = ""
        return _failed(tried, case, error, mistake)
    return Outcome(tried, held=True)


def _failed(tried: Property, case: Case, error: Exception, mistake: str) -> Outcome:
    problem = getattr(error, "report", None) or str(error)
    if not isinstance(error, AssertionError):
        problem = f"{type(error).__name__}: {problem}"
    counterexample = described(tried.operation, case, tried.arguments(case))
    return Outcome(tried, False, problem, counterexample, mistake)


def _mistake_in(error: Exception) -> str:
    """What the numbers of a failed gradient check show, or the words of another exception."""
    return getattr(error, "mistake", None) or mistake_in_error(error) or ""


def _known_bug(tried: Property, implementation: Callable, witnesses: list[Witness]) -> str | None:
    """The sentence of the bug in the zoo that behaves as was witnessed, if there is one.

    Where several do, the one that is likest in all its gradients at cases of any kind.
    """
    if tried.operation not in OPERATIONS:  # an exercise, of which the zoo keeps no bugs
        return None
    names = OPERATIONS[tried.operation].differentiated
    argument = tried.name.rpartition(" ")[2]
    one_argument = tried.name.startswith(("gradient for", "adjoint in"))
    only = names.index(argument) if one_argument else None
    suspects = [
        bug
        for bug in bugs_of(tried.operation)
        if all(witness.would_see_the_same(bug.implementation, only) for witness in witnesses)
    ]
    if len(suspects) > 1:
        general = [_general_witness(tried, implementation, seed) for seed in range(GENERAL_CASES)]
        suspects.sort(
            key=lambda bug: -sum(w.would_see_the_same(bug.implementation) for w in general)
        )
    return suspects[0].sentence if suspects else None


def _general_witness(tried: Property, implementation: Callable, seed: int) -> Witness:
    """A witness of one plain call and its pullback at a case drawn at random."""
    rng = np.random.default_rng(seed)
    sizes = tuple((name, int(rng.choice(options))) for name, options in tried.sizes.items())
    witness, case = Witness(implementation), Case(sizes, seed)
    try:
        value, pullback = witness(*tried.arguments(case).values())
        pullback(drawn_upstream(case, value))
    except Exception:  # then that is what was witnessed
        pass
    return witness
