"""Every public name of ring 1 and of verify has its sections, and the examples run."""

import doctest
import importlib
import inspect
import pkgutil
import re

import pytest

PACKAGES = ("ops", "models", "training", "motion", "manifold", "verify")


def public_names():
    for package in PACKAGES:
        module = importlib.import_module(f"numpy_cae.{package}")
        for name in module.__all__:
            value = getattr(module, name)
            documented = inspect.isclass(value) and not issubclass(value, Exception)
            if documented or inspect.isroutine(value):
                yield pytest.param(value, id=f"{package}.{name}")


def modules():
    yield "numpy_cae"
    for package in PACKAGES:
        top = importlib.import_module(f"numpy_cae.{package}")
        yield top.__name__
        for module in pkgutil.walk_packages(top.__path__, f"{top.__name__}."):
            yield module.name


@pytest.mark.parametrize("value", list(public_names()))
def test_a_public_name_has_its_sections(value):
    text = inspect.getdoc(value) or ""
    assert re.search(r"^Examples\n-{8}\n", text, re.MULTILINE) and ">>>" in text
    if inspect.isroutine(value):
        signature = inspect.signature(value)
        if signature.parameters:
            assert re.search(r"^Parameters\n-{10}\n", text, re.MULTILINE)
        if signature.return_annotation not in (None, "None", inspect.Signature.empty):
            assert re.search(r"^(Returns\n-{7}|Yields\n-{6})\n", text, re.MULTILINE)


@pytest.mark.parametrize("name", list(modules()))
def test_the_examples_of_a_module_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    assert doctest.testmod(importlib.import_module(name), optionflags=options).failed == 0
