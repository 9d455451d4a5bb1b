"""Every public name of ring 1 and of verify has its sections, and the examples run."""

import importlib
import inspect
import re

import pytest

from tools.docstring_examples import PACKAGES, example_modules, failures


def public_names():
    for package in PACKAGES:
        module = importlib.import_module(f"numpy_cae.{package}")
        for name in module.__all__:
            value = getattr(module, name)
            documented = inspect.isclass(value) and not issubclass(value, Exception)
            if documented or inspect.isroutine(value):
                yield pytest.param(value, id=f"{package}.{name}")


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


@pytest.mark.parametrize("name", list(example_modules()))
def test_the_examples_of_a_module_run(name):
    assert failures(name) == 0
