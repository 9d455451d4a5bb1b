"""One property tried on one implementation: hypothesis draws examples and shrinks what fails."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable

from numpy_cae.verify.case import Case, described
from numpy_cae.verify.diagnosis import Recorder, likely_mistake
from numpy_cae.verify.property import Outcome, Property

FAILURES_KEPT = 3


def try_property(
    tried: Property, implementation: Callable, examples: int | None = None, shrink: bool = True
) -> Outcome:
    """Test an implementation for a property on drawn examples, the same ones every time.

    Parameters
    ----------
    tried : Property
    implementation : callable
        In the form of the operation in `numpy_cae.ops`.
    examples : int, optional
        By default the number that the property states.
    shrink : bool
        Whether to look for the smallest counterexample rather than take the first.

    Raises
    ------
    ImportError
        If hypothesis is not installed.
    """
    try:
        from hypothesis import HealthCheck, Phase, given, settings
        from hypothesis import strategies as st
    except ImportError:
        raise ImportError(
            "trying properties needs hypothesis, which draws the examples: "
            "pip install 'numpy_cae[test]', or pip install hypothesis"
        ) from None

    sizes = {name: st.sampled_from(options) for name, options in tried.sizes.items()}
    failures: list[tuple[Case, Exception]] = []
    recorders: list[Recorder] = []

    @settings(
        max_examples=examples or tried.examples,
        derandomize=True,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.generate, Phase.shrink] if shrink else [Phase.generate],
        report_multiple_bugs=False,
    )
    @given(sizes=st.fixed_dictionaries(sizes), seed=st.integers(0, 9999))
    def attempt(sizes: dict[str, int], seed: int) -> None:
        case = Case(tuple(sizes.items()), seed)
        recorder = Recorder(implementation)
        try:
            tried.check(recorder, case)
        except Exception as error:
            failures.append((case, error))
            if len(recorders) < FAILURES_KEPT:
                recorders.append(recorder)
            raise

    try:
        attempt()
    except Exception:
        if not failures:  # the fault is ours, not the implementation's
            raise
        case, error = failures[-1]
        problem = str(error)
        if not isinstance(error, AssertionError):
            problem = f"{type(error).__name__}: {error}{_line(error, implementation)}"
        counterexample = described(tried.operation, case, tried.arguments(case))
        mistake = likely_mistake(tried, implementation, recorders)
        return Outcome(tried, False, problem, counterexample, mistake)
    return Outcome(tried, held=True)


def _line(error: Exception, implementation: Callable) -> str:
    """The last line of the implementation's own file that an exception came through."""
    code = getattr(inspect.unwrap(implementation), "__code__", None)
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if code and frame.filename == code.co_filename]
    return f" (line {lines[-1]})" if lines else ""
