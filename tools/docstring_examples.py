"""The examples of docstrings that the reference shows, run where the site is built and in tests."""

import doctest
import pkgutil
from collections.abc import Iterator
from contextlib import chdir
from importlib import import_module
from tempfile import TemporaryDirectory

PACKAGES = ("ops", "models", "training", "motion", "manifold", "verify")
"""The reference shows each public name of these."""
OTHERS = ("mocap", "cleanup", "evaluation", "viz", "public", "visible")
"""Further packages and modules whose examples are run."""


def example_modules() -> Iterator[str]:
    """The names of the modules whose examples are run."""
    yield "numpy_cae"
    for name in (*PACKAGES, *OTHERS):
        top = import_module(f"numpy_cae.{name}")
        yield top.__name__
        if hasattr(top, "__path__"):
            for module in pkgutil.walk_packages(top.__path__, f"{top.__name__}."):
                yield module.name


def failures(name: str) -> int:
    """How many examples of a module print something else than they say; they run, and write their
    files, in a temporary folder."""
    module = import_module(name)
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    with TemporaryDirectory() as folder, chdir(folder):
        return doctest.testmod(module, optionflags=options).failed
