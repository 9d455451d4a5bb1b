"""A plugin of pytest that prints where the processor time of the tests goes.

    python -m pytest -p tools.test_times            a table for each folder, and the slowest files

Processor time is that of the test's process and of the processes that it waited for, with all of
their threads. Other programs of the machine add little to it, where they double the durations that
`pytest --durations` prints.
"""

import os
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

PROPERTY = "processor_seconds"
"""Under this name a test's report has its processor time."""
FILES = 25
"""So many of the slowest files are printed."""
TESTS = 25
"""So many of the slowest tests are printed."""
SESSION = "fixtures of the session, at its end"
"""The row of what the last test ends, such as processes that served many tests."""

seconds_of_test: dict[str, float] = {}


def processor_seconds() -> float:
    """The processor time of this process and of its children that have ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Iterator[None]:
    """Note where a test, with the fixtures that it is the first to need, begins."""
    item.stash[BEGAN] = processor_seconds()
    return (yield)


BEGAN = pytest.StashKey[float]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> Iterator[None]:
    """Add the processor time to the report of the end of the test."""
    before = processor_seconds()
    result = yield
    end = processor_seconds() if nextitem else before
    item.user_properties.append((PROPERTY, end - item.stash[BEGAN]))
    if nextitem is None:
        item.user_properties.append((SESSION, processor_seconds() - before))
    return result


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Collect the times, which come from other processes where pytest-xdist runs the tests."""
    if report.when != "teardown":
        return
    for name, seconds in report.user_properties:
        if name == PROPERTY:
            seconds_of_test[report.nodeid] = float(str(seconds))
        elif name == SESSION:
            seconds_of_test[SESSION] = seconds_of_test.get(SESSION, 0) + float(str(seconds))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the sums of folders, then the slowest files and tests."""
    of_folder: dict[str, float] = defaultdict(float)
    of_file: dict[str, float] = defaultdict(float)
    for test, seconds in seconds_of_test.items():
        file = test.split("::")[0]
        of_file[file] += seconds
        of_folder[str(Path(file).parent) if "/" in file else file] += seconds
    total = sum(seconds_of_test.values())
    print_rows = terminalreporter.write_line
    terminalreporter.section("processor time, s")
    print_rows(f"{total:8.1f}  {len(seconds_of_test)} tests")
    for name, rows, most in (
        ("folders", of_folder, len(of_folder)),
        ("slowest files", of_file, FILES),
        ("slowest tests", seconds_of_test, TESTS),
    ):
        print_rows(f"{name}:")
        for row in sorted(rows, key=lambda row: -rows[row])[:most]:
            print_rows(f"{rows[row]:8.1f}  {100 * rows[row] / total:4.1f}%  {row}")
