"""The grader's side: start a student's process, receive its replies, end it in time."""

from __future__ import annotations

import json
import os
import queue
import secrets
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from numpy_cae.errors import NumpyCaeError

EXERCISE_SECONDS = 30.0
"""CPU time of one exercise; on the clock twice as much may pass, and the start-up besides."""
STARTUP_SECONDS = 20.0
MAX_REPLY = 2**20
PROJECT = str(Path(__file__).parents[3])
ENVIRONMENT = ("PATH", "HOME", "SYSTEMROOT", "LD_LIBRARY_PATH", "LANG")
ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "OMP", "MKL")}
TIME_IS_UP = "the time limit for the whole file is used up"
CRASHED = "its process ended: it crashed, was killed for its memory, or ended itself"


class ProcessEnded(NumpyCaeError):
    """The student's process ended or had to be ended; the message says why."""


class StudentProcess:
    """A process that does a request of `child.main`, to be used as a context.

    The deadline is on the clock of `time.monotonic`.
    """

    def __init__(self, request: dict, deadline: float) -> None:
        self._deadline = deadline
        self._token = secrets.token_hex(16)
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        path = os.pathsep.join(filter(None, [PROJECT, os.environ.get("PYTHONPATH")]))
        kept = {name: os.environ[name] for name in ENVIRONMENT if name in os.environ}
        self._process = subprocess.Popen(
            [sys.executable, "-B", "-c", "from numpy_cae.verify.sandbox.child import main; main()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=self._folder.name,
            env={**kept, **ONE_THREAD, "PYTHONPATH": path},
            start_new_session=True,
        )
        request = {**request, "token": self._token, "exercise_seconds": EXERCISE_SECONDS}
        try:
            with self._process.stdin as pipe:
                pipe.write(json.dumps(request).encode())
        except OSError:  # it has ended already, which the first reply will tell
            pass
        self._lines: queue.Queue[bytes] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def __enter__(self) -> StudentProcess:
        return self

    def __exit__(self, *exception) -> None:
        self._kill()
        self._process.wait()
        self._folder.cleanup()

    def reply(self) -> dict:
        """The next reply; ProcessEnded if none comes in time, or one that is not ours."""
        wait = min(self._deadline - time.monotonic(), STARTUP_SECONDS + 2 * EXERCISE_SECONDS)
        try:
            line = self._lines.get(timeout=max(wait, 0.001))
        except queue.Empty:
            raise ProcessEnded(self._out_of_time()) from None
        if not line:
            raise ProcessEnded(self._reason())
        try:
            reply = json.loads(line)
            if reply["token"] != self._token:
                raise ValueError("a reply of the student's own")
        except (ValueError, KeyError, TypeError, RecursionError):
            raise ProcessEnded("its process sent something that is no reply") from None
        return reply

    def _read(self) -> None:
        with self._process.stdout as pipe:
            while line := pipe.readline(MAX_REPLY):
                self._lines.put(line)
        self._lines.put(b"")

    def _out_of_time(self) -> str:
        if time.monotonic() >= self._deadline:
            return TIME_IS_UP
        return f"it did not finish within {EXERCISE_SECONDS:g} s: an endless loop?"

    def _reason(self) -> str:
        """Why the replies ended."""
        try:
            status = self._process.wait(timeout=2)
        except subprocess.TimeoutExpired:
            return "its process closed the channel of the replies"
        out_of_cpu_time = hasattr(signal, "SIGXCPU") and status == -signal.SIGXCPU
        return self._out_of_time() if out_of_cpu_time else CRASHED

    def _kill(self) -> None:
        """End the process and those that it started, apart from any that left its session."""
        try:
            if hasattr(os, "killpg"):
                os.killpg(self._process.pid, signal.SIGKILL)
            else:
                self._process.kill()
        except OSError:
            pass
