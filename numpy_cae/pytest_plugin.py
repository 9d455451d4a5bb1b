"""A plugin of pytest: a function with `verify.operation_test` is a test for each of its properties.

pytest imports this module wherever numpy_cae is installed. So it imports nothing but pytest, looks
at plain functions only, and leaves alone what `operation_test` has not marked. pytest does the
rest: fixtures, `parametrize` and other marks, methods and static methods work as in any test.
"""

from __future__ import annotations

import inspect
from types import FunctionType
from typing import Any, TypeGuard

import pytest

PROPERTY = "operation_property"
"""The name of the parameter of a test that stands for its property."""


def pytest_pycollect_makeitem(collector: pytest.Module | pytest.Class, name: str, obj: Any) -> None:
    """Give a marked function the parameters that pytest fills: its fixtures, and its property."""
    # isinstance would ask a proxy, such as Flask's current_app, for what it stands for.
    kind = type(obj)
    function = obj.__func__ if kind in (staticmethod, classmethod) else obj
    if not _is_marked(function) or PROPERTY in inspect.signature(function).parameters:
        return
    if kind is classmethod or inspect.iscoroutinefunction(function):
        return  # refused when it is run, so that no other test of the file is lost
    is_method = isinstance(collector, pytest.Class) and kind is not staticmethod
    parameter = inspect.Parameter(PROPERTY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    parameters = [*_fixture_parameters(function, is_method), parameter]
    function.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]


def _fixture_parameters(function: FunctionType, is_method: bool) -> list[inspect.Parameter]:
    """The parameters of a marked function that are neither self, arrays, nor have a default."""
    parameters = list(inspect.signature(function).parameters.values())
    arrays = _array_names(function)
    if _takes_arrays_by_name(function):
        parameters = [parameter for parameter in parameters if parameter.name not in arrays]
    else:
        first = 1 if is_method else 0
        parameters = parameters[:first] + parameters[first + len(arrays) :]
    return [
        parameter
        for parameter in parameters
        if parameter.default is parameter.empty
        and parameter.kind == parameter.POSITIONAL_OR_KEYWORD
    ]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make a test of each property."""
    if _is_marked(metafunc.function) and PROPERTY in metafunc.fixturenames:
        properties = vars(metafunc.function)["operation_test"]
        cases = [
            pytest.param(property_, id=property_.name, marks=property_.marks)
            for property_ in properties
        ]
        metafunc.parametrize(PROPERTY, cases)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Fail with a sentence where a marked function cannot be a test of each property."""
    if not isinstance(item, pytest.Function) or not _is_marked(item.function):
        return
    if PROPERTY in item.fixturenames:
        return
    refused = "class method"
    if inspect.iscoroutinefunction(item.function):
        refused = "coroutine"
    elif _is_of_unittest(item.cls):
        refused = "method of unittest.TestCase"
    text = f"{item.name}: operation_test needs a function, or a method of a plain class"
    pytest.fail(f"{text}, not a {refused}", pytrace=False)


def _is_of_unittest(cls: type | None) -> bool:
    """Whether a class is a TestCase, without importing unittest."""
    return cls is not None and any(base.__module__.startswith("unittest") for base in cls.__mro__)


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Try the property on random cases, the same in every run."""
    function = pyfuncitem.function
    if not _is_marked(function):
        return None
    from numpy_cae.verify import check_property

    names = [name for name in inspect.signature(function).parameters if name != "self"]
    fixtures: dict[str, Any] = {name: pyfuncitem.funcargs[name] for name in names}
    property_ = fixtures.pop(PROPERTY)

    def operation(*arrays: Any) -> Any:
        if _takes_arrays_by_name(function):
            named = dict(zip(_array_names(function), arrays, strict=True))
            return pyfuncitem.obj(**named, **fixtures)
        return pyfuncitem.obj(*arrays, **fixtures)

    operation.__wrapped__ = function  # type: ignore[attr-defined]
    operation.__name__ = function.__name__
    try:
        check_property(property_, operation, vars(function).setdefault("operation_crashes", set()))
    except AssertionError as error:  # without a traceback: lines of numpy_cae would not help
        raise pytest.fail.Exception(str(error), pytrace=False) from None
    return True


def _is_marked(function: object) -> TypeGuard[FunctionType]:
    """Whether an object is a plain function that `operation_test` has marked."""
    return type(function) is FunctionType and "operation_test" in vars(function)


def _array_names(function: FunctionType) -> list[str]:
    """The names of the arrays that `operation_test` was given."""
    return list(vars(function)["operation_arrays"])


def _takes_arrays_by_name(function: FunctionType) -> bool:
    """Whether the function has a parameter for each array, by its name."""
    names = function.__code__.co_varnames[: function.__code__.co_argcount]
    return set(_array_names(function)) <= set(names)
