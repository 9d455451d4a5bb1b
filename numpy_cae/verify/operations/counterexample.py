"""The cases in which a property does not hold, and the smallest one."""

from collections.abc import Callable, Iterator

from numpy_cae.verify.checks.mismatch import kind_and_subject
from numpy_cae.verify.operations.case import SEEDS_TRIED, Case, Sizes
from numpy_cae.verify.operations.property import Property

MAX_SHRINKS = 150
"""So many simpler cases are tried to find a smaller counterexample."""

READ_ONLY = ("read-only", "broadcast")
"""The memory layouts whose arrays cannot be written."""
NEEDS_WRITABLE = "buffer source array is read-only"
"""What compiled functions, such as those of SciPy's Rotation, say of an array that they only read.

Whether a function alters its arguments is tried with arrays that can be written.
"""


def failure(property_: Property, implementation: Callable, case: Case) -> BaseException | None:
    """The error that a check raises in a case, or None."""
    try:
        property_.check(implementation, case)
    except (Exception, SystemExit) as error:
        if NEEDS_WRITABLE in str(error) and case.get("layout") in READ_ONLY:
            return None
        return error
    return None


def first_failure(
    property_: Property, implementation: Callable, begin: Callable[[Case], None] | None = None
) -> tuple[Case, BaseException] | None:
    """The first case in which a property does not hold, with the error, or None.

    `begin` is called with each case before it is tried.
    """
    for case in property_.cases():
        if begin is not None:
            begin(case)
        error = failure(property_, implementation, case)
        if error is not None:
            return case, error
    return None


def failing_case(property_: Property, implementation: Callable) -> Case | None:
    """The first case in which a property does not hold, or None."""
    failed = first_failure(property_, implementation)
    return None if failed is None else failed[0]


def smallest_case(
    property_: Property, implementation: Callable, case: Case, expected: tuple[str, str]
) -> Case:
    """A case that fails with this kind and subject; making any one size simpler would pass."""
    count = 0
    while count < MAX_SHRINKS:
        smaller = None
        for simpler in _simplify(case, property_.sizes):
            count += 1
            error = failure(property_, implementation, simpler)
            if error is not None and kind_and_subject(error) == expected:
                smaller = simpler
                break
        if smaller is None:
            return case
        case = smaller
    return case


def _simplify(case: Case, sizes: Sizes) -> Iterator[Case]:
    """The case with one size, class or seed made simpler, largest simplifications first."""
    for number, (name, size) in enumerate(case.sizes):
        simpler_options = sizes[name][: sizes[name].index(size)]
        for option in simpler_options:
            changed = (*case.sizes[:number], (name, option), *case.sizes[number + 1 :])
            yield Case(changed, case.seed)
    for seed in range(min(case.seed, SEEDS_TRIED)):
        yield Case(case.sizes, seed)
