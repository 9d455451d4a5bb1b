"""The student's process: load a file, test its functions, reply with one line of JSON for each."""

from __future__ import annotations

import ctypes
import importlib.abc
import json
import math
import os
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType

import numpy as np
import numpy.fft
import numpy.ma
import numpy.polynomial
import numpy.random
import numpy.testing

try:
    import resource
except ImportError:  # Windows, where a process has no such limits
    resource = None

from numpy_cae.errors import NumpyCaeError
from numpy_cae.verify.catalogue import load_catalogue
from numpy_cae.verify.reporting import report_on
from numpy_cae.verify.sandbox.refusal import is_refused

MAX_FILE_SIZE = 2**24
PR_SET_PDEATHSIG = 1


class LoadError(NumpyCaeError):
    """The student's file cannot be loaded."""


class ImportBlocker(importlib.abc.MetaPathFinder):
    """Refuses to import what would do the exercise instead of the student."""

    def find_spec(self, name, path=None, target=None):
        if is_refused(name):
            raise ImportError(f"{name} may not be imported here")
        return None


def main() -> None:
    """Do the request that standard input holds, and reply on standard output.

    It names the file, the catalogue, the tasks with the functions to be tested, the functions
    that the file is given, the limits, and the token that marks a reply as ours.
    """
    _end_with_parent()
    request = json.load(sys.stdin)
    replies = _private_output()
    catalogue = load_catalogue(request["catalogue"])
    import hypothesis  # noqa: F401 (before the student's file, as NumPy)

    def send(reply: dict) -> None:
        replies.write(json.dumps({**reply, "token": request["token"]}) + "\n")
        replies.flush()

    warnings.simplefilter("ignore")
    _limit(request["megabytes"])
    _limit_cpu_time(request["exercise_seconds"])
    given = {name: catalogue[name].solution for name in request["given"]}
    kept = _isolate()
    try:
        functions = _load(Path(request["path"]), given)
    except LoadError as error:
        send({"fault": str(error)[:1000]})
        return
    todo = [(task, name) for task, name in request["tasks"] if name in functions]
    send({"found": todo})
    for task, name in todo:
        _limit_cpu_time(request["exercise_seconds"])
        try:
            report = report_on(catalogue[task], functions[name], name).as_reply()
        except BaseException as error:  # such as KeyboardInterrupt
            report = {"ended": f"{type(error).__name__}: {error}"[:1000]}
        send({"task": task, "report": report})
    del kept


def _private_output():
    """Standard output, out of reach of what prints; the standard streams become empty."""
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    return replies


def _end_with_parent() -> None:
    """Where Linux is, have this process killed when the grader ends."""
    try:
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    except (OSError, AttributeError, TypeError):
        pass


def _limit(megabytes: int) -> None:
    """Limit memory, processes and the size of files."""
    if resource is None:
        return
    for kind, limit in (
        (resource.RLIMIT_AS, megabytes * 2**20),
        (resource.RLIMIT_NPROC, 0),
        (resource.RLIMIT_FSIZE, MAX_FILE_SIZE),
    ):
        try:
            resource.setrlimit(kind, (limit, limit))
        except (ValueError, OSError):
            pass


def _limit_cpu_time(seconds: float) -> None:
    """Let this process be ended after so much CPU time from now."""
    if resource is not None:
        _, hard = resource.getrlimit(resource.RLIMIT_CPU)
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + seconds), hard))


def _isolate() -> list[ModuleType]:
    """Give what is imported from now on a NumPy of its own, and nothing of this project.

    The tests keep the NumPy that they have, whatever the student's file changes in the other.
    Returns the modules that were taken away, to be kept as long as they run.
    """
    ours = {name: m for name, m in list(sys.modules.items()) if isinstance(m, ModuleType)}
    copies = {}
    for name, module in ours.items():
        if name.partition(".")[0] == "numpy":
            copies[name] = ModuleType(name)
            vars(copies[name]).update(vars(module))
        elif name.partition(".")[0] == "numpy_cae":
            del sys.modules[name]
    for name, copy in copies.items():
        package, _, last = name.rpartition(".")
        if package and vars(copies[package]).get(last) is ours[name]:
            setattr(copies[package], last, copy)
    sys.modules.update(copies)
    sys.meta_path.insert(0, ImportBlocker())
    return list(ours.values())


def _load(path: Path, given: Mapping[str, Callable]) -> dict[str, Callable]:
    """Run the student's file as a module; return its own functions by name.

    Raises
    ------
    LoadError
        If it raises anything.
    """
    module = ModuleType("student")
    sys.modules["student"] = module
    sys.path.append(str(path.parent))
    vars(module).update(given)
    try:
        with np.errstate():
            exec(compile(path.read_bytes(), str(path), "exec"), vars(module))
    except SystemExit:
        raise LoadError("at import it calls sys.exit") from None
    except BaseException as error:
        frames = traceback.extract_tb(error.__traceback__)
        lines = [frame.lineno for frame in frames if frame.filename == str(path)]
        place = f" (line {lines[-1]})" if lines else ""
        raise LoadError(f"at import: {type(error).__name__}: {error}{place}") from None
    there = list(vars(module).items())
    return {name: f for name, f in there if callable(f) and f is not given.get(name)}
