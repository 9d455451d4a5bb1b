"""A confined process that is started as a program, where there is no template."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from numpy_cae.confined.template import Ending

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

COMMAND = [sys.executable, "-B", "-P", "-m", "numpy_cae.confined.process"]


class Program:
    """A confined process, with what `numpy_cae.confined.template.Fork` has."""

    def __init__(self, folder: Path) -> None:
        self._seconds_before = _seconds_of_children()
        self._popen = subprocess.Popen(
            COMMAND,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,
            cwd=folder,
            env=os.environ | {"TMPDIR": str(folder)},
            start_new_session=True,
        )
        assert self._popen.stdin is not None and self._popen.stdout is not None
        self.process = self._popen.pid
        self.calls = self._popen.stdin.fileno()
        self.answers = self._popen.stdout.fileno()

    def wait(self, seconds: float) -> Ending:
        """How it ended, if it has ended or does so within so many seconds."""
        with suppress(subprocess.TimeoutExpired):
            self._popen.wait(seconds)
        return self._popen.returncode, _seconds_of_children() - self._seconds_before

    def kill(self) -> None:
        """Kill it and its group, unless its end is known."""
        if self._popen.returncode is None:
            with suppress(OSError, AttributeError):  # it has just begun; Windows
                os.killpg(self.process, signal.SIGKILL)
            self._popen.kill()

    def end(self) -> None:
        """Kill it and its group."""
        self.kill()
        self._popen.wait()
        for stream in (self._popen.stdin, self._popen.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()


def _seconds_of_children() -> float:
    """The processor time of the processes that this one has started and that have ended."""
    if resource is None:
        return 0.0
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
