"""The grader's end: a student's process, watched, and its functions as if they were ours."""

from __future__ import annotations

import builtins
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from numpy_cae import ops
from numpy_cae.verify.sandbox import wire

WORKER = Path(__file__).with_name("worker.py")
CALL_SECONDS = 10.0
LOOK_EVERY = 0.02
KEPT_FROM_ENVIRONMENT = ("PATH", "HOME", "PYTHONPATH", "SYSTEMROOT", "LD_LIBRARY_PATH", "LANG")
ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "OMP", "MKL")}


class Abandoned(Exception):
    """A process that has ended."""


class Fault(Exception):
    """What is wrong with a file as a whole."""


class Student:
    """A process that has loaded a student's file. Use as a context.

    Parameters
    ----------
    path : Path
    deadline : float
        On the clock of `time.monotonic`, for everything the process does.
    megabytes : int
        Of address space.
    """

    def __init__(self, path: Path, deadline: float, megabytes: int) -> None:
        self.path = path.resolve()
        self.deadline = deadline
        self.functions: list[str] = []
        self.patched: list[str] = []
        self.refused: list[str] = []
        self.ended: str | None = None
        self._call_deadline: float | None = None
        self._calls = 0
        self._lent: list[Callable] = []
        self._given = 0
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self._printed = Path(self._folder.name, "printed").open("w+b")
        self._process = subprocess.Popen(
            [sys.executable, "-u", "-B", str(WORKER), str(self.path), str(megabytes)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._printed,
            cwd=self._folder.name,
            env={k: os.environ[k] for k in KEPT_FROM_ENVIRONMENT if k in os.environ} | ONE_THREAD,
            start_new_session=True,
        )
        threading.Thread(target=self._watch, daemon=True).start()

    def __enter__(self) -> Student:
        return self

    def __exit__(self, *exception) -> None:
        self._kill("it was no longer needed")
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout, self._printed):
            try:
                pipe.close()
            except OSError:
                pass
        self._folder.cleanup()

    def load(self, given: Mapping[str, Callable] | None = None) -> None:
        """Import the file.

        Parameters
        ----------
        given : mapping of name to callable, optional
            Functions of ours that it may call, by these names, where it has none of its own.

        Raises
        ------
        Fault
            If that fails, whatever the way.
        """
        try:
            given = given or {}
            known = [name for name in sorted(given) if given[name] is getattr(ops, name, None)]
            lent = [name for name in sorted(given) if name not in known]
            message = {"do": "load", "given": lent, "operations": known}
            reply, _ = self._ask(message, [given[name] for name in lent])
            self._given = len(lent)
        except Abandoned as end:
            raise Fault(f"at import: {end}") from None
        if self.refused:
            raise Fault(f"refused: it imports {', '.join(sorted(set(self.refused)))}")
        if reply.get("exit"):
            raise Fault("at import it calls sys.exit")
        if "raised" in reply:
            place = f" (line {reply['line']})" if reply.get("line") else ""
            raise Fault(f"at import: {reply['raised']}: {reply['message']}{place}")
        if self.printed():
            raise Fault(
                f"at import it prints {self.printed()!r}; what prints belongs under "
                'if __name__ == "__main__":'
            )
        if self.patched:
            raise Fault(f"it alters NumPy itself: {', '.join(self.patched[:5])}")
        self.functions = reply["functions"]

    def printed(self) -> str:
        """The beginning of what was printed so far."""
        self._printed.seek(0)
        return self._printed.read(80).decode(errors="replace").strip()

    def function(self, name: str, numbers_only: bool = True) -> Callable:
        """A function of the file, in the form of an operation.

        It may be given functions, which are called on our side. What it and its pullback return
        has to be numbers, unless `numbers_only` is False: a lesson's own may have dicts of them.
        """

        def operation(*arguments):
            self._calls += 1
            number = self._calls
            message = {"do": "call", "function": name, "number": number}
            reply, returned = self._answer(message, arguments)
            _require_values(returned)
            if numbers_only:
                _require_numbers(returned)
            if "pullback" not in reply:
                return returned

            def pullback(*upstream):
                _, gradients = self._answer({"do": "pull", "number": number}, upstream)
                _require_values(gradients)
                if numbers_only:
                    _require_numbers(gradients)
                return gradients

            return returned, pullback

        return operation

    def forget(self) -> None:
        """Let go of the pullbacks, which hold on to their arrays."""
        if self.ended is None:
            self._ask({"do": "forget"})
            del self._lent[self._given :]

    def _answer(self, message: dict, arguments: tuple) -> tuple[dict, object]:
        """What a function returned; its alterations of the arguments are made here as well."""
        reply, values = self._ask(message, arguments)
        if reply.get("exit"):
            raise RuntimeError("it calls sys.exit")
        if "raised" in reply:
            kind = getattr(builtins, str(reply["raised"]), RuntimeError)
            place = f" (line {reply['line']})" if reply.get("line") else ""
            if not (isinstance(kind, type) and issubclass(kind, Exception)):
                kind = RuntimeError
            raise _error(kind, f"{reply['message']}{place}")
        try:
            (returned,), altered = values
            _alter(arguments, altered)
        except (ValueError, TypeError, KeyError):
            raise Abandoned("its process answers nonsense") from None
        return reply, returned

    def _lend(self, value):
        """The value as it can be sent: functions stay here and go by a number."""
        if isinstance(value, tuple | list):
            return tuple(self._lend(part) for part in value)
        if isinstance(value, dict):
            return {key: self._lend(part) for key, part in value.items()}
        if not callable(value):
            return value
        self._lent.append(value)
        return wire.Lent(len(self._lent) - 1)

    def _called_back(self, number: int, arguments: list) -> tuple[dict, list]:
        """What a lent function returns to the student's process, or how it fails there."""
        try:
            return {}, [self._lend(self._lent[number](*arguments))]
        except Exception as error:
            return {"raised": type(error).__name__, "message": str(error)}, []

    def _ask(self, message: dict, arguments: tuple = ()) -> tuple[dict, list]:
        if self.ended is not None:
            raise Abandoned(f"not tried, because {self.ended}")
        self._call_deadline = time.monotonic() + CALL_SECONDS
        try:
            wire.send(self._process.stdin, message, self._lend(arguments))
            reply, values = wire.receive(self._process.stdout)
            while "lent" in reply:
                answer = self._called_back(reply["lent"], values)
                wire.send(self._process.stdin, *answer)
                reply, values = wire.receive(self._process.stdout)
        except (OSError, ValueError, wire.BrokenWire):
            self._kill("its process ended: it crashed, was killed for its memory, or ended itself")
            raise Abandoned(str(self.ended)) from None
        finally:
            self._call_deadline = None
        self.patched = [str(name) for name in reply.get("patched", self.patched)]
        self.refused = [str(name) for name in reply.get("refused", [])]
        return reply, values

    def _watch(self) -> None:
        """End the process when a call or the whole takes too long."""
        while self._process.poll() is None:
            now, limit = time.monotonic(), self._call_deadline
            if limit is not None and now > limit:
                self._kill(f"it did not return within {CALL_SECONDS:g} s: an endless loop?")
            elif limit is not None and now > self.deadline:
                self._kill("the time limit for the whole file is used up")
            time.sleep(LOOK_EVERY)

    def _kill(self, reason: str) -> None:
        self.ended = self.ended or reason
        if self._process.poll() is None:
            try:
                if hasattr(os, "killpg"):
                    os.killpg(self._process.pid, signal.SIGKILL)
                else:
                    self._process.kill()
            except OSError:
                pass


def _alter(arguments, altered) -> None:
    """Make the alterations of the student's process in the grader's arrays."""
    if isinstance(arguments, tuple | list):
        for argument, now in zip(arguments, altered, strict=True):
            _alter_one(argument, now)
    elif isinstance(arguments, dict):
        for name, now in altered.items():
            _alter_one(arguments[name], now)


def _alter_one(argument, now) -> None:
    if isinstance(argument, np.ndarray) and now is not None:
        argument[...] = now
    elif isinstance(argument, dict):
        _alter(argument, now)


def _error(kind: type[Exception], message: str) -> Exception:
    """An exception of a builtin kind, some of which want more than a message."""
    try:
        return kind(message)
    except TypeError:
        return RuntimeError(message)


def _require_values(returned) -> None:
    for part in returned if isinstance(returned, tuple) else (returned,):
        if isinstance(part, wire.Unsendable):
            raise TypeError(f"it returns {part.kind}, expected an array of floats")


def _require_numbers(returned) -> None:
    for part in returned if isinstance(returned, tuple) else (returned,):
        if isinstance(part, str | dict):
            raise TypeError(f"it returns {type(part).__name__}, expected an array of floats")
        if isinstance(part, tuple):
            raise TypeError("it returns a list of lists, expected an array of floats")
        if isinstance(part, np.ndarray) and part.dtype.kind != "f":
            raise TypeError(f"it returns an array of {part.dtype}, expected floats")
