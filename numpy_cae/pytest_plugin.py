"""A plugin of pytest: a function with `verify.operation_test` is a test for each of its properties.

pytest imports this module wherever numpy_cae is installed. So it imports nothing but pytest, looks
at plain functions only, and leaves alone what `operation_test` has not marked. pytest does the
rest: fixtures, `parametrize` and other marks, methods and static methods work as in any test.
"""

from __future__ import annotations

import inspect
from types import FunctionType

import pytest

PROPERTY = "operation_property"
"""PROPERTY: the name of the parameter of a test that stands for its property."""


def pytest_pycollect_makeitem(collector, name: str, obj: object) -> None:
    """Give a marked function the parameters that pytest fills: its fixtures, and its property."""
    function = obj.__func__ if type(obj) in (staticmethod, classmethod) else obj
    if not _is_marked(function) or PROPERTY in inspect.signature(function).parameters:
        return
    if type(obj) is classmethod or inspect.iscoroutinefunction(function):
        kind = "class method" if type(obj) is classmethod else "coroutine"
        raise collector.CollectError(f"{name}: operation_test needs a function, not a {kind}")
    parameters = list(inspect.signature(function).parameters.values())
    is_method = isinstance(collector, pytest.Class) and type(obj) is not staticmethod
    after = is_method + len(function.operation_arrays)  # self and the arrays
    if _takes_arrays_by_name(function):
        kept = [each for each in parameters if each.name not in function.operation_arrays]
    else:
        kept = parameters[:is_method] + parameters[after:]
    fixtures = [p for p in kept if p.default is p.empty and p.kind == p.POSITIONAL_OR_KEYWORD]
    stated = inspect.Parameter(PROPERTY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    function.__signature__ = inspect.Signature([*fixtures, stated])


def pytest_generate_tests(metafunc) -> None:
    """Make a test of each property."""
    if _is_marked(metafunc.function):
        every = metafunc.function.operation_test
        cases = [pytest.param(each, id=each.name, marks=each.marks) for each in every]
        metafunc.parametrize(PROPERTY, cases)


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem) -> bool | None:
    """Try the property on random cases, the same in every run."""
    function = pyfuncitem.function
    if not _is_marked(function):
        return None
    from numpy_cae.verify import check_property

    names = [name for name in inspect.signature(function).parameters if name != "self"]
    fixtures = {name: pyfuncitem.funcargs[name] for name in names}
    stated = fixtures.pop(PROPERTY)

    def operation(*arrays):
        if _takes_arrays_by_name(function):
            named = dict(zip(function.operation_arrays, arrays, strict=True))
            return pyfuncitem.obj(**named, **fixtures)
        return pyfuncitem.obj(*arrays, **fixtures)

    operation.__wrapped__ = function
    operation.__name__ = function.__name__
    try:
        check_property(stated, operation, vars(function).setdefault("operation_crashes", set()))
    except AssertionError as error:  # without a traceback: lines of numpy_cae would not help
        raise pytest.fail.Exception(str(error), pytrace=False) from None
    return True


def _is_marked(function: object) -> bool:
    return type(function) is FunctionType and "operation_test" in vars(function)


def _takes_arrays_by_name(function: FunctionType) -> bool:
    names = function.__code__.co_varnames[: function.__code__.co_argcount]
    return set(function.operation_arrays) <= set(names)
