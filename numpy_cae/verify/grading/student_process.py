"""A confined process that runs a student's file, as the grader sees it.

It is ended in time, when its files grow too large, and at the end.
"""

import os
import shutil
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from numpy_cae.confined.channel import Channel, MessageError, Reader, write_all
from numpy_cae.confined.confinement import SECCOMP
from numpy_cae.confined.program import Program
from numpy_cae.confined.template import Template

NO_RESULT = "its process sent what is no result: the file has changed how it answers"
CRASHED = "its process ended: it crashed, or ended itself"
OUT_OF_TIME = "it used up its CPU time: an endless loop?"
KILLED = "its process was killed from outside: by another program, or by the system for its memory"
NOT_STARTED = "the process for the file could not start"
POLL_SECONDS = 0.02
"""So often it is looked whether a process has to be ended."""
LOOKS_AT_FOLDER = 5
"""The files of the process are counted in one of so many looks."""
PACKAGE = Path(__file__).parents[2]
"""The source of numpy_cae, with the solutions, which the process may not read."""


class ProcessEnded(BaseException):
    """The student's process has ended, or sent what cannot be read; the message says why.

    It is no Exception, so that no check takes it for one that the student's function raised.
    """


class Ungraded(BaseException):
    """The file could not be graded, for no fault of its own; the message says why."""


class StudentProcess:
    """A process of its own, confined, in a folder of its own.

    Parameters
    ----------
    seconds : float
        Its processor time. It may be idle as long again: time in which it waits for a processor, or
        in which the grader works, does not count.
    megabytes : int
        Its memory.
    beside : Path
        The folder of the student's file, which it may read.
    solutions : mapping of str to callable
        What `run_file` may provide or replace, by name.
    tested : sequence of callable
        The solutions of the functions that are tested, which the process does not keep.
    template : Template or None
        What starts it; without one, it is a program that begins.

    Raises
    ------
    Ungraded
        If it cannot be started.
    """

    def __init__(
        self,
        seconds: float,
        megabytes: int,
        beside: Path,
        solutions: Mapping[str, Callable],
        tested: Sequence[Callable],
        template: Template | None,
    ) -> None:
        self._seconds = seconds
        self._fault = ""
        self._folder = Path(tempfile.mkdtemp(dir=Path.cwd()))
        try:
            self._process = template.start(self._folder) if template else Program(self._folder)
        except OSError as error:
            raise Ungraded(f"{NOT_STARTED}: {error}") from None
        reader = Reader(self._process.answers, self._raise_ending)
        self._channel = Channel(reader.read, self._write, trusted=True)
        self._begun = _Clock(self._process.process)
        self._has_ended = threading.Event()
        self._watcher = threading.Thread(target=self._watch, daemon=True)
        self._watcher.start()
        self.mechanisms: list[str] = []
        try:
            confine_here, self._run_file = self._channel.call_published()
            self.mechanisms = confine_here(
                seconds,
                megabytes,
                [str(beside)],
                [str(PACKAGE)],
                {name: _place_of(function) for name, function in solutions.items()},
                [_place_of(function) for function in tested],
            )
        except (ProcessEnded, MessageError) as error:
            self.end()
            raise Ungraded(f"{NOT_STARTED}: {error}") from None
        self._begun = _Clock(self._process.process)

    def run_file(
        self,
        file: str,
        cells: Sequence[tuple[str, str | bytes]],
        is_notebook: bool,
        provided: Sequence[str],
        replaced: Sequence[str],
    ) -> tuple[dict[str, Callable], list[tuple[str, Callable]]]:
        """`numpy_cae.confined.process.run_file` in the process."""
        functions, raised = self._run_file(file, cells, is_notebook, provided, replaced)
        for name, raise_again in raised:
            if not isinstance(name, str) or not callable(raise_again):
                raise ValueError("the problems are none")
        return {name: f for name, f in functions.items() if callable(f)}, raised

    def require_alive(self) -> None:
        """Raise ProcessEnded if it was ended."""
        if self._fault:
            self._raise_ending()

    def end(self) -> None:
        """Kill it and all that it has started, and remove its folder."""
        self._has_ended.set()
        self._watcher.join()
        try:
            self._process.end()
        except OSError as error:
            raise Ungraded(f"its process could not be ended: {error}") from None
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _write(self, data: bytes | memoryview) -> None:
        try:
            write_all(self._process.calls, data)
        except BrokenPipeError:
            self._raise_ending()

    def _raise_ending(self) -> NoReturn:
        """Say why it has ended: by a ProcessEnded, or Ungraded if that is not the file's fault."""
        if self._fault:
            raise ProcessEnded(self._fault)
        try:
            code, seconds_used = self._process.wait(1.0)
        except OSError as error:
            raise Ungraded(str(error)) from None
        self._has_ended.set()
        if hasattr(signal, "SIGXCPU") and code == -signal.SIGXCPU:
            raise ProcessEnded(OUT_OF_TIME)
        if hasattr(signal, "SIGKILL") and code == -signal.SIGKILL:
            if seconds_used >= self._seconds:
                raise ProcessEnded(OUT_OF_TIME)
            if SECCOMP in self.mechanisms:  # so that it cannot kill itself
                raise Ungraded(KILLED)
        raise ProcessEnded(CRASHED)

    def _watch(self) -> None:
        """End the process once it has a fault."""
        looks = 0
        while not self._has_ended.wait(POLL_SECONDS):
            fault = ""
            if self._begun.idle_and_busy_seconds() > 2 * self._seconds:
                fault = f"it did not finish within {2 * self._seconds:.3g} s: an endless loop?"
            looks += 1
            if looks % LOOKS_AT_FOLDER == 0 and _written(self._folder) > MOST_WRITTEN:
                fault = f"it wrote more than {MOST_WRITTEN // 2**20} MB of files"
            if fault:
                self._fault = fault
                self._process.kill()
                return


def _place_of(function: Callable) -> tuple[str, str]:
    """The names of the module in which a function is defined, and of the function."""
    return function.__module__, function.__name__


class _Clock:
    """The time since now, without that in which the grader works or somebody waits for a processor.

    The grader and the process work in turns.
    """

    def __init__(self, process: int) -> None:
        self._paths = [f"/proc/self/task/{os.getpid()}/schedstat", f"/proc/{process}/schedstat"]
        self._begun = time.monotonic()
        self._not_counted = 0.0
        self._not_counted = self._seconds_not_counted()

    def idle_and_busy_seconds(self) -> float:
        elapsed = time.monotonic() - self._begun
        return elapsed - (self._seconds_not_counted() - self._not_counted)

    def _seconds_not_counted(self) -> float:
        grader_cpu, grader_waited = _schedule(self._paths[0])
        _, process_waited = _schedule(self._paths[1])
        return grader_cpu + grader_waited + process_waited


def _schedule(path: str) -> tuple[float, float]:
    """The seconds that a thread has worked and has waited for a processor (Linux), or zeros."""
    try:
        worked, waited, *_ = Path(path).read_text().split()
    except (OSError, ValueError):  # not Linux, or it has ended
        return 0.0, 0.0
    return int(worked) / 1e9, int(waited) / 1e9


MOST_WRITTEN = 2**26
"""All files of a process together may have at most so many bytes."""
LEAST_FILE = 2**12
"""A file counts as at least so many bytes, an empty one too."""


def _written(folder: Path) -> int:
    """The bytes of all files in a folder."""
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            with suppress(OSError):  # removed since
                total += max(LEAST_FILE, os.lstat(os.path.join(parent, name)).st_size)
    return total
