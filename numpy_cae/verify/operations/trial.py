"""One property tried on one implementation, the smallest case that fails, and the likely mistake.

That is a wrong operation that does the same. The implementation, the right operation, each planted
bug and each other convention are tried with the cases of the property. A mistake is named only if
the wrong operation does in every case what the implementation does, and the right operation in
several cases does not. Otherwise the sentence says what was seen: a factor, lost digits, or what
the cases that fail have in common.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from dataclasses import replace
from functools import partial
from itertools import permutations, zip_longest
from operator import itemgetter

import numpy as np

from numpy_cae.verify.checks import call as calling
from numpy_cae.verify.checks.call import ALTERED, DTYPE, OVERWRITTEN, is_pair, what_failed, written
from numpy_cae.verify.operations import property as comparing
from numpy_cae.verify.operations.case import SEEDS_TRIED, Case, Sizes
from numpy_cae.verify.operations.catalogue import example_call
from numpy_cae.verify.operations.operation import Operation
from numpy_cae.verify.operations.patch import bugs_of, conventions_of
from numpy_cae.verify.operations.property import Outcome, Property, failing_case, failure

C_ORDER = "Memory in another order is read as if it were in C order, as strides and reshape may do."
OF_KIND = {ALTERED: "That array is written to, as by -= or out=: a new one is needed."}
OF_KIND[DTYPE] = "An array in it has a dtype of its own, such as np.zeros(n), which is float64."
OF_KIND[OVERWRITTEN] = "The next call changes what one returned: it is kept in one array or list."
"""OF_KIND: the likely mistake where the kind of a mismatch tells it."""
UNSTEADY = "called again with the same arguments, it returns something else"
MAX_SHRINKS = 150
"""MAX_SHRINKS: so many simpler cases are tried to find a smaller counterexample."""
SEVERAL = 2
"""SEVERAL: a mistake is named only if the right operation differs in at least so many cases."""
GENERAL_CASES = 8
"""GENERAL_CASES: two mistakes that explain the same are compared in so many further cases."""
DIGITS = 1e-5
"""DIGITS: results lose digits only if they are off by less than this part of the largest entry."""
MOST = 0.6
"""MOST: a circumstance is named if at least so large a part of its cases fail, and no others."""


def recorded(implementation: Callable, last: list) -> Callable:
    """The implementation; `last` holds the arguments of its last call or of the last pullback that
    was called, and what the pullbacks were given since that call.
    """

    def called(*arguments):
        given = deepcopy(arguments)
        last[:] = [given]
        returned = implementation(*arguments)
        if not is_pair(returned):
            return returned

        def pullback(*upstream):
            last[:] = [given, *last[1:], *deepcopy(upstream)]
            return returned[1](*upstream)

        return returned[0], pullback

    return called


def try_property(
    tried: Property,
    implementation: Callable,
    shrink: bool = True,
    begin: Callable[[Case], None] = lambda case: None,
) -> Outcome:
    """Test an implementation for a property on random cases, the same in every run.

    The counterexample is the smallest case that fails, or without `shrink` the first one. `begin`
    is called with each case before it is tried.
    """
    case = failing_case(tried, implementation, begin)
    if case is None:
        return Outcome(tried, held=True)
    last: list = []
    error = failure(tried, recorded(implementation, last), case)
    if error is not None and shrink and not isinstance(error, NotImplementedError):
        case = _smallest(tried, implementation, case, what_failed(error))
        error = failure(tried, recorded(implementation, last), case)
    if error is None:
        return Outcome(tried, False, UNSTEADY, str(case))
    kind, _ = what_failed(error)
    crashed = not isinstance(error, AssertionError)
    of_crash = calling.error_text(error, calling.file_of(implementation))
    problem = of_crash if crashed else str(error)[: calling.LONGEST_TEXT]
    if isinstance(error, RecursionError | MemoryError):
        problem += f"\nit runs out of depth or memory with {case}; smaller cases were right"
    is_like_bugs = isinstance(error, AssertionError | ValueError | IndexError)
    of_kind = OF_KIND.get(kind, "")
    mistake = likely_mistake(tried, implementation, of_kind) if is_like_bugs else of_kind
    mistake = mistake or of_kind or C_ORDER * (tried.name == "strides" and not crashed)
    example = "\n".join(_described(tried, case, last, error))
    return Outcome(tried, False, problem, example, mistake, kind, crashed)


def _smallest(tried: Property, implementation: Callable, case: Case, failed: tuple) -> Case:
    """A case that fails in the same way; making any one size or class simpler would pass."""
    count = 0
    while count < MAX_SHRINKS:
        for simpler in _simpler(case, tried.sizes):
            count += 1
            error = failure(tried, implementation, simpler)
            if error is not None and what_failed(error) == failed:
                case = simpler
                break
        else:
            break
    return case


def _simpler(case: Case, sizes: Sizes) -> Iterator[Case]:
    """The case with one size, class or seed made simpler, largest simplifications first."""
    for number, (name, size) in enumerate(case.sizes):
        for option in sizes[name][: sizes[name].index(size)]:
            changed = (*case.sizes[:number], (name, option), *case.sizes[number + 1 :])
            yield Case(changed, case.seed)
    for seed in range(min(case.seed, SEEDS_TRIED)):
        yield Case(case.sizes, seed)


def check_property(stated: Property, function: Callable, crashes: set[str] | None = None) -> None:
    """Raise unless an implementation has a property.

    Parameters
    ----------
    stated : Property
        One of `properties`; in a test file, `pytest.mark.parametrize` makes a test of each.
    function : callable
        The implementation.
    crashes : set of str, optional
        The errors that were already shown for other properties: they are not shown in full again.

    Raises
    ------
    AssertionError
        With the statement, what is wrong, the smallest counterexample and the likely mistake.

    Examples
    --------
    >>> import numpy as np
    >>> from numpy_cae import verify
    >>> value, gradient, *others = verify.properties("tanh")
    >>> wrong = lambda x: (np.tanh(x), lambda dy: dy * (1 - x * x))
    >>> verify.check_property(value, wrong)
    >>> verify.check_property(gradient, wrong)
    Traceback (most recent call last):
    AssertionError: the pullback's gradient for x is that of the definition
        ...
    """
    outcome = try_property(stated, function)
    message = [stated.statement, outcome.problem, outcome.counterexample, outcome.mistake]
    if outcome.crashed and crashes is not None:
        if outcome.problem in crashes:
            message = [f"as in an earlier test, {outcome.problem}"]
        crashes.add(outcome.problem)
    if not outcome.held:
        raise AssertionError("\n".join(filter(None, message)))


def _described(tried: Property, case: Case, last: list, error: BaseException) -> Iterator[str]:
    """The arguments of the last call, and what it should return; or the call of `example`."""
    shown = tried.arguments(case)
    arguments, *upstreams = last or [()]
    if set(shown) == {"seed"}:  # what the function is tried with is not drawn
        return
    names = ("dy", "dy'", "2 dy - 3 dy'")
    if len(arguments) == len(shown):
        shown = dict(zip(shown, arguments, strict=True))
        if tried.name == "linearity" and len(upstreams) == len(names):
            shown |= dict(zip(names, upstreams, strict=True))
        elif upstreams:
            shown["upstream gradient"] = upstreams[-1]
    yield str(case)
    lines = [f"{name} = {written(argument)}" for name, argument in shown.items()]
    is_short = sum(map(len, lines)) <= calling.LONGEST_ARGUMENTS
    yield from lines if is_short else [example_call(tried, case)]
    result = getattr(error, "result", None)
    if result is not None and result.size <= calling.WORTH_PRINTING:
        result, right = calling.written_apart(result, error.expected)
        yield f"{error.subject.removeprefix('the ')}: {result}"
        yield f"  expected: {right}"


def likely_mistake(stated: Property, implementation: Callable, of_kind: str = "") -> str:
    """The sentence on the mistake because of which a property does not hold, or "".

    `of_kind` is what the kind of a failure tells: it is said where no known mistake does the same.
    """
    if stated.diagnose is not None:
        return stated.diagnose(stated, implementation)
    operation = stated.definition
    if operation is None:
        return ""
    cases = stated.cases()
    results = [stated.check.results(implementation, case) for case in cases]
    right = [stated.check.results(operation.reference, case) for case in cases]
    fails = [not same(one, other) for one, other in zip(results, right, strict=True)]
    if sum(fails) < SEVERAL:
        return ""
    return (
        _known_mistake(stated, implementation, cases, results)
        or misplaced_gradient(stated, operation, implementation)
        or of_kind
        or _by_how_much(cases, results, right)
        or _where(stated, cases, fails, right)
    )


def misplaced_gradient(stated: Property, operation: Operation, implementation: Callable) -> str:
    """Where the right gradient stands among those that the pullback returns, or ""."""
    names = operation.differentiated
    name = stated.name.removeprefix("gradient for ")

    def exchanged(other: str, *arguments):
        """The implementation, whose gradient for `name` is exchanged with another one."""
        value, pullback = implementation(*arguments)
        order = [names.index({name: other, other: name}.get(each, each)) for each in names]
        return value, lambda *upstream: itemgetter(*order)(pullback(*upstream))

    for other in names if name in names else ():
        if other != name and failing_case(stated, partial(exchanged, other)) is None:
            order = ", ".join(names)
            return f"The gradient for {name} is returned as that for {other}: the order is {order}."
    return ""


def _known_mistake(stated: Property, implementation: Callable, cases: list, results: list) -> str:
    """The sentence on the planted bug that does the same, or ""."""
    operation = stated.check.operation
    explained = {"": -1}
    for patch in (*bugs_of(operation.name), *conventions_of(operation.name)):
        wrong = patch.function()
        pairs = zip(results, cases, strict=True)
        if all(same(one, stated.check.results(wrong, case)) for one, case in pairs):
            kind = "" if patch.caught_by else "another convention, which may be allowed: "
            explained[kind + patch.sentence] = _shared_effects(operation, implementation, wrong)
    return max(explained, key=explained.__getitem__)


def _by_how_much(cases: Sequence[Case], results: list, right: list) -> str:
    """The factor by which all results are off, made of sizes, or the digits that are lost."""
    if any(part.dtype.kind != "f" for parts in results for part in parts):  # it raises
        return ""
    pairs = [(_row(one), _row(other)) for one, other in zip(results, right, strict=True)]
    if any(one.shape != other.shape for one, other in pairs):
        return ""
    sizes = [{"1": 1, "-1": -1, "2": 2} | _numbers(case) for case in cases]
    for above, below in permutations(sizes[0], 2):
        scaled = [b * each[above] / each[below] for each, (_, b) in zip(sizes, pairs, strict=True)]
        if all(np.allclose(a, b, 1e-9, 1e-12) for (a, _), b in zip(pairs, scaled, strict=True)):
            return f"It is the right result times {f'{above} / {below}'.removesuffix(' / 1')}."
    off = np.max([np.max(abs(a - b), initial=0) / np.max(abs(b), initial=1) for a, b in pairs])
    return f"Digits are lost: it is off by at most {off:.0e}, relatively." * bool(off < DIGITS)


def _where(stated: Property, cases: Sequence[Case], fails: list[bool], right: list) -> str:
    """What all cases that fail have in common, and most that hold have not, or ""."""
    tried = [i for i, result in enumerate(right) if np.any(_row(result)) or fails[i]]
    conditions = [_conditions(stated, cases[i]) for i in tried]
    failed = [each for each, i in zip(conditions, tried, strict=True) if fails[i]]
    counts = Counter(name for each in conditions for name in each)
    shared = sorted(set.intersection(*failed))
    apart = [name for name in shared if len(tried) - counts[name] >= SEVERAL]
    best = min(apart, key=counts.__getitem__, default="")
    most = 1 if best.endswith(("odd", "even")) else MOST
    is_clear = best and len(failed) >= most * counts[best]
    return f"It fails only where {best}: in {len(failed)} of {counts[best]} cases." * bool(is_clear)


def _conditions(stated: Property, case: Case) -> set[str]:
    """What is true of the sizes, the classes and the arguments of a case."""
    numbers = _numbers(case)
    true = {f"{name} is {o}" for name, o in case.sizes if o == 1 or isinstance(o, str)}
    for name, size in numbers.items():
        true |= {f"{name} is {'odd' if size % 2 else 'even'}"}
        true |= {f"{name} is above {option}" for option in stated.sizes[name] if size > option}
        true |= {f"{name} is below {other}" for other in numbers if size < numbers[other]}
        true |= {f"{name} is as large as {o}" for o in numbers if o > name and size == numbers[o]}
    arguments = stated.arguments(case)
    for name, array in arguments.items():  # of one array alone, it says nothing about the mistake
        true |= {f"{name} is not 0"} if np.any(array) and len(arguments) > 1 else set()
        true |= {f"{name} has a 0"} if not np.all(array) else set()
    return true


def _row(parts: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.zeros(0), *map(np.ravel, parts)])


def _numbers(case: Case) -> dict[str, int]:
    return {name: size for name, size in case.sizes if isinstance(size, int)}


def _shared_effects(operation: Operation, implementation: Callable, wrong: Callable) -> int:
    """The number of results that a wrong operation changes; -1 if the implementation's differ."""
    general = comparing.property_of(operation, "diagnosis", "", comparing.compared)
    touched: set[int] = set()
    differing: set[int] = set()
    for case in replace(general, examples=GENERAL_CASES).cases():
        functions = (implementation, wrong, operation.reference)
        one, other, right = (general.check.results(f, case) for f in functions)
        touched |= _differing(other, right)
        differing |= _differing(other, one)
    return -1 if touched & differing else len(touched)


def same(one: list, other: list) -> bool:
    """Whether two lists of results are equal, to rounding of the largest of them."""
    return len(one) == len(other) and not _differing(one, other)


def _differing(one: list, other: list) -> set[int]:
    """The numbers of the results that differ, beyond rounding of the largest of them."""
    floats = [a for a in other if a.dtype.kind == "f"]
    sizes = (float(np.max(np.abs(a[np.isfinite(a)]), initial=0.0)) for a in floats)
    largest = max(sizes, default=0.0)
    pairs = enumerate(zip_longest(one, other))
    return {number for number, (a, b) in pairs if not _equal(a, b, 1e-11 * largest)}


def _equal(one: np.ndarray | None, other: np.ndarray | None, rounding: float) -> bool:
    if one is None or other is None or one.shape != other.shape or one.dtype != other.dtype:
        return False
    if one.dtype.kind != "f":
        return np.array_equal(one, other)
    close = 1e-4 if one.dtype == np.float32 else 1e-9
    return np.allclose(one, other, rtol=close, atol=close * 1e9 * rounding, equal_nan=True)
