"""The examples of docstrings that the reference shows, run where the site is built and in tests."""

import doctest
import pkgutil
from collections.abc import Iterator
from importlib import import_module

PACKAGES = ("ops", "models", "training", "motion", "manifold", "verify")


def example_modules() -> Iterator[str]:
    """The names of the modules whose examples are run."""
    yield "numpy_cae"
    for package in PACKAGES:
        top = import_module(f"numpy_cae.{package}")
        yield top.__name__
        for module in pkgutil.walk_packages(top.__path__, f"{top.__name__}."):
            yield module.name


def failures(name: str) -> int:
    """How many examples of a module print something else than they say. Examples write files, so
    the working folder has to be an empty one."""
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    return doctest.testmod(import_module(name), optionflags=options).failed
