"""The program of the confined process: run a student's file, and call its functions when asked.

The process that started it sends calls through standard input and gets answers through standard
output (`channel`). What the file itself reads and prints goes nowhere.
"""

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType
from typing import Any
from warnings import catch_warnings

import numpy as np
import numpy.ma

from numpy_cae.confined.channel import Channel, Reader, write_all
from numpy_cae.confined.confinement import confine

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

DO_THE_EXERCISE = (
    "aesara autograd casadi chainer cupy dynet flax jax keras mindspore mlx mxnet numpy_cae paddle "
    "pytensor sympy tangent tensorflow theano tinygrad torch"
).split()
"""Packages that may not be imported. This is a message, not a guard."""
SOLUTIONS: dict[str, Callable] = {}
"""The solutions of other exercises that this file may use, by name."""
KEPT: list[ModuleType] = []
"""The modules that this program uses; a student's file gets copies."""
SHARED = ("sys", "warnings")
"""Modules that the interpreter itself looks into; a copy would change nothing."""
Place = Sequence[str]
"""The names of a module and of a function in it."""
FOLDERS_OF_PACKAGES = ("site-packages", "dist-packages")
MOST_DESCRIPTORS = 4096
"""The connection has a number below this that no file of the student gets by chance."""


class _Refusal(MetaPathFinder):
    """Says of some packages that they may not be imported."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        package = name.partition(".")[0]
        if _does_the_exercise(package):
            raise ImportError(f"{package} may not be imported: write the operation by hand")
        return None


def serve(calls: int, answers: int) -> None:
    """Serve calls of `confine_here` and `run_file` until the connection ends.

    Calls come by the first of the two descriptors, and answers go to the second.
    """
    reader = Reader(_out_of_the_way(calls, 1), at_end=lambda: os._exit(0))
    write = partial(write_all, _out_of_the_way(answers, 2))
    silence()
    channel = Channel(reader.read, write, trusted=False)
    channel.publish(lambda: (confine_here, run_file))
    try:
        channel.serve()
    finally:
        os._exit(1)


def _out_of_the_way(stream: int, place: int) -> int:
    """Another number for a stream, among the highest that a process may have."""
    number = os.dup(stream)
    if stream > 2:  # the standard streams are silenced
        os.close(stream)
    if resource is None:
        return number
    hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    most = MOST_DESCRIPTORS if hard == resource.RLIM_INFINITY else min(hard, MOST_DESCRIPTORS)
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
        os.dup2(number, most - place, inheritable=False)
        os.close(number)
        return most - place
    return number


def silence() -> None:
    """Read nothing and print nothing from now on."""
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    os.close(nothing)
    sys.stdin = open(0, closefd=False)
    sys.stdout = sys.stderr = open(1, "w", errors="replace", closefd=False)


def confine_here(
    seconds: float,
    megabytes: int,
    readable: Sequence[str],
    hidden: Sequence[str],
    solutions: Mapping[str, Place],
    tested: Sequence[Place],
) -> list[str]:
    """Confine this process to the current folder; returns the mechanisms in effect.

    The solutions are imported before, for `run_file`; those of the tested functions are removed.
    """
    for name, place in solutions.items():
        SOLUTIONS[name] = _function_at(place)
    if solutions:
        _remove(list(map(_function_at, tested)))
    for package in map(Path, hidden):
        if package.parent.name not in FOLDERS_OF_PACKAGES:  # a clone, which has tests and lessons
            sys.path[:] = [place for place in sys.path if Path(place) != package.parent]
    KEPT.extend(_copy_modules())
    sys.meta_path.insert(0, _Refusal())
    paths = list(map(Path, readable)), list(map(Path, hidden))
    return confine(seconds, megabytes, Path.cwd(), *paths)


def _copy_modules() -> list[ModuleType]:
    """Replace every module by a copy, so that what a file changes there does not reach the channel.

    Those of numpy_cae are removed. Returns the modules, which are to be kept while in use.
    """
    originals = {}
    for name, module in list(sys.modules.items()):
        if name not in SHARED and type(module) is ModuleType:
            originals[name] = module
    copies = {name: ModuleType(name) for name in originals if not _does_the_exercise(name)}
    for name, copy in copies.items():
        vars(copy).update(vars(originals[name]))
    for name, copy in copies.items():
        package, _, last = name.rpartition(".")
        if package in copies and vars(copies[package]).get(last) is originals[name]:
            setattr(copies[package], last, copy)
    for name in originals.keys() - copies.keys():
        del sys.modules[name]
    sys.modules.update(copies)
    return list(originals.values())


def _does_the_exercise(module: str) -> bool:
    return module.partition(".")[0] in DO_THE_EXERCISE


def _function_at(place: Place) -> Callable:
    """The function of a module."""
    module, name = place
    return getattr(import_module(module), name)


def _remove(functions: Sequence[Callable]) -> None:
    """Remove functions from every module of numpy_cae."""
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] == "numpy_cae":
            for attribute, thing in list(vars(module).items()):
                if any(thing is function for function in functions):
                    delattr(module, attribute)


def run_file(
    file: str,
    cells: Sequence[tuple[str, str | bytes]],
    is_notebook: bool,
    provided_names: Sequence[str],
    replaced_names: Sequence[str],
) -> tuple[dict[str, Callable], list[tuple[str, Any]]]:
    """Run a student's file as a module.

    The cells may use the solutions of the provided names and, in a notebook, `np`. After the cells
    have run, the solutions of the replaced names take the place of the functions of these names.

    Returns
    -------
    functions : dict
        Those that the file defines, by name.
    problems : list of (name of the cell, function that raises what the cell raised)
    """
    provided = {name: SOLUTIONS[name] for name in provided_names}
    module = ModuleType("student")
    earlier_lessons = ModuleType("mine")
    vars(earlier_lessons).update(provided)
    sys.modules.update(student=module, mine=earlier_lessons)
    sys.path.append(str(Path(file).parent))
    names = vars(module)
    names["__file__"] = file
    names["__builtins__"] = vars(sys.modules["builtins"])
    names.update(provided)
    if is_notebook:
        names["np"] = sys.modules["numpy"]
    problems = []
    for name, source in cells:
        try:
            with np.errstate(), catch_warnings():
                exec(compile(source, name, "exec"), names)
        except BaseException as error:  # such as SystemExit
            problems.append((name, _raiser_of(error)))
    functions = {}
    for name, defined in list(names.items()):
        is_name = isinstance(name, str)
        if is_name and callable(defined) and defined is not provided.get(name):
            functions[name] = defined
    names.update({name: SOLUTIONS[name] for name in replaced_names})
    return functions, problems


def _raiser_of(error: BaseException) -> Callable[[], None]:
    """A function that raises an error again, with its traceback."""

    def raise_again() -> None:
        raise error

    return raise_again


if __name__ == "__main__":
    serve(0, 1)
