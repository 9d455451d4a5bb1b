"""The student's process: load the file, call its functions when asked, send back what comes.

Run as a script, never imported by the grader. It imports NumPy, the wire, and the operations that
an exercise is given; whatever the student's file wants to import passes by `Gatekeeper`.
"""

from __future__ import annotations

import builtins
import dis
import importlib.abc
import importlib.util
import os
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType

import numpy as np
import numpy.fft
import numpy.linalg
import numpy.random
import numpy.testing

HERE, PROJECT = str(Path(__file__).parent), str(Path(__file__).parents[3])
sys.path = [HERE, *(folder for folder in sys.path if folder != HERE)]
import refusal  # noqa: E402
import wire  # noqa: E402

# The student's file sees neither our folder nor our modules, and may have some of the same names.
sys.path.remove(HERE)
del sys.modules["refusal"], sys.modules["wire"]

LARGEST_OUTPUT = 2**24


class Gatekeeper(importlib.abc.MetaPathFinder):
    """Refuses to import what would do the exercise instead of the student."""

    def __init__(self) -> None:
        self.refused: list[str] = []

    def find_spec(self, name, path=None, target=None):
        if refusal.is_refused(name):
            self.refused.append(name)
            raise ImportError(f"{name} may not be imported here")
        return None


class Servant:
    """Does what the grader asks: load, call, pull, forget. Each returns a reply and values."""

    def __init__(self, path: Path, requests, replies) -> None:
        self.path, self.requests, self.replies = path, requests, replies
        self.module = None
        self.pullbacks: dict[int, object] = {}
        self.gatekeeper = Gatekeeper()
        self.numpy_before = _numpy_names()

    def answer(self, request: dict, arguments: list) -> tuple[dict, list]:
        """Do it, and let nothing through, neither an exception nor an exit."""
        try:
            reply, values = getattr(self, request["do"])(request, arguments)
        except SystemExit:
            reply, values = {"exit": True}, []
        except BaseException as error:
            line = _line(self.path)
            reply = {"raised": type(error).__name__, "message": str(error), "line": line}
            values = []
        if request["do"] in ("load", "forget"):
            reply["patched"] = _changed(self.numpy_before)
        return {**reply, "refused": self.gatekeeper.refused}, values

    def load(self, request: dict, arguments: list) -> tuple[dict, list]:
        given = dict(zip(request["given"], self.borrowed(arguments), strict=True))
        given |= _operations(request["operations"])
        sys.meta_path.insert(0, self.gatekeeper)
        sys.path.append(str(self.path.parent))
        spec = importlib.util.spec_from_file_location("student", self.path)
        self.module = importlib.util.module_from_spec(spec)
        sys.modules["student"] = self.module
        vars(self.module).update(given)
        spec.loader.exec_module(self.module)
        there = vars(self.module).items()
        own = (n for n, value in there if callable(value) and value is not given.get(n))
        return {"functions": sorted(own)}, []

    def call(self, request: dict, arguments: list) -> tuple[dict, list]:
        arguments = self.borrowed(arguments)
        given = _copies(arguments)
        returned, reply = getattr(self.module, request["function"])(*arguments), {}
        if isinstance(returned, tuple) and len(returned) == 2 and callable(returned[1]):
            returned, self.pullbacks[request["number"]] = returned
            reply["pullback"] = True
        return reply, [(returned,), _altered(arguments, given)]

    def borrowed(self, values):
        """The values, with a function for each that stays on the grader's side."""
        if isinstance(values, dict):
            return {key: self.borrowed(value) for key, value in values.items()}
        if isinstance(values, list | tuple):
            return type(values)(self.borrowed(value) for value in values)
        return self._function(values.number) if isinstance(values, wire.Lent) else values

    def _function(self, number: int):
        def lent(*arguments):
            wire.send(self.replies, {"lent": number}, arguments)
            reply, values = wire.receive(self.requests)
            if "raised" in reply:
                raise getattr(builtins, reply["raised"], RuntimeError)(reply["message"])
            return self.borrowed(values[0])

        return lent

    def pull(self, request: dict, arguments: list) -> tuple[dict, list]:
        given = _copies(arguments)
        returned = self.pullbacks[request["number"]](*arguments)
        return {}, [(returned,), _altered(arguments, given)]

    def forget(self, request: dict, arguments: list) -> tuple[dict, list]:
        self.pullbacks.clear()
        return {}, []


def main() -> None:
    """Serve until the grader hangs up."""
    path, megabytes = Path(sys.argv[1]), int(sys.argv[2])
    requests, replies = _private_pipes()
    _limit(megabytes)
    servant = Servant(path, requests, replies)
    while True:
        try:
            request, arguments = wire.receive(requests)
        except wire.BrokenWire:
            return
        reply, values = servant.answer(request, arguments)
        _flush()
        wire.send(replies, reply, values)


def _private_pipes():
    """The pipes of the grader, out of the way of whoever reads stdin or prints to stdout.

    What is printed goes to the file that the grader gave as stderr.
    """
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    return requests, replies


def _limit(megabytes: int) -> None:
    """Limit memory and the size of files; where the platform knows no such limits, do without."""
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_OUTPUT, LARGEST_OUTPUT))
        resource.setrlimit(resource.RLIMIT_AS, (megabytes * 2**20, megabytes * 2**20))
    except (ImportError, ValueError, OSError):
        pass


def _operations(names: list[str]) -> dict[str, FunctionType]:
    """Operations of the project, and afterwards nothing else of it in this process.

    They could stay with the grader, as other functions do. But a recurrence calls them at every
    frame of every finite difference, and each call would go there and back.
    """
    if not names:
        return {}
    sys.path.insert(0, PROJECT)
    from numpy_cae import ops

    sys.path.remove(PROJECT)
    found = {name: _by_itself(getattr(ops, name)) for name in names}
    for module in [name for name in sys.modules if name.partition(".")[0] == "numpy_cae"]:
        del sys.modules[module]
    return found


def _by_itself(function: FunctionType) -> FunctionType:
    """The function without its module: of the globals, those that it uses."""
    names = set(_names(function.__code__))
    used = {name: value for name, value in function.__globals__.items() if name in names}
    for name, value in used.items():
        if isinstance(value, FunctionType):
            used[name] = _by_itself(value)
    used["__builtins__"] = builtins
    return FunctionType(function.__code__, used, function.__name__, function.__defaults__)


def _names(code: CodeType) -> Iterator[str]:
    yield from (step.argval for step in dis.get_instructions(code) if "GLOBAL" in step.opname)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _line(path: Path) -> int | None:
    """The last line of the student's file that an exception came through."""
    frames = traceback.extract_tb(sys.exc_info()[2])
    lines = [frame.lineno for frame in frames if frame.filename == str(path)]
    return lines[-1] if lines else None


def _copies(value):
    if isinstance(value, list | tuple):
        return [_copies(part) for part in value]
    if isinstance(value, dict):
        return {key: _copies(part) for key, part in value.items()}
    return value.copy() if isinstance(value, np.ndarray) else value


def _altered(value, given):
    """The arrays that the call has altered, None in the place of everything else."""
    if isinstance(value, list):
        return tuple(_altered(v, g) for v, g in zip(value, given, strict=True))
    if isinstance(value, dict):
        return {key: _altered(value.get(key), given[key]) for key in given}
    is_array = isinstance(value, np.ndarray) and isinstance(given, np.ndarray)
    return value if is_array and value.tobytes() != given.tobytes() else None


def _numpy_names() -> dict[str, dict[str, object]]:
    modules = {n: m for n, m in list(sys.modules.items()) if n.partition(".")[0] == "numpy"}
    return {name: dict(vars(module)) for name, module in modules.items() if module is not None}


def _changed(before: dict[str, dict[str, object]]) -> list[str]:
    """The names in NumPy that no longer mean what they meant."""
    changed = []
    for module, names in before.items():
        now = vars(sys.modules[module]) if module in sys.modules else {}
        changed += [
            f"{module}.{name}"
            for name, value in names.items()
            if not name.startswith("__") and now.get(name, None) is not value
        ]
    return sorted(changed)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except Exception:  # the student may have put anything in its place
            pass


if __name__ == "__main__":
    main()
