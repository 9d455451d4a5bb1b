"""A plugin of pytest: a function with `verify.operation_test` is a test for each of its properties.

pytest imports this module wherever numpy_cae is installed, so it imports nothing but pytest.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest


class OperationTests(pytest.Collector):
    """An operation of a test file."""

    def __init__(self, function, **options) -> None:
        super().__init__(**options)
        self.function = function
        self.own_markers.extend(getattr(function, "pytestmark", []))

    def collect(self) -> Iterator[pytest.Item]:
        """One test for each property."""
        for stated in self.function.operation_test:
            yield PropertyTest.from_parent(self, name=stated.name, stated=stated)


class PropertyTest(pytest.Item):
    """The test of one property."""

    def __init__(self, stated, **options) -> None:
        super().__init__(**options)
        self.stated = stated

    def runtest(self) -> None:
        """Try the property on random cases, the same in every run."""
        from numpy_cae.verify import check_property

        check_property(self.stated, self.parent.function)

    def repr_failure(self, excinfo, style=None):
        """What is wrong, and the counterexample; the lines of numpy_cae would not help."""
        if excinfo.errisinstance(AssertionError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self):
        """The file and the line of the operation, and the name of the test."""
        function = self.parent.function
        line = getattr(function, "__code__", None) and function.__code__.co_firstlineno - 1
        return self.path, line, f"{self.parent.name}: {self.name}"


def pytest_pycollect_makeitem(collector, name: str, obj: object) -> OperationTests | None:
    """Collect the functions that `verify.operation_test` has marked."""
    if "operation_test" not in getattr(obj, "__dict__", {}) or not callable(obj):
        return None
    return OperationTests.from_parent(collector, name=name, function=obj)
