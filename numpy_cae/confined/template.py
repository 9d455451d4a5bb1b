"""A process that has imported what a confined process needs, and of which confined ones are forks.

A fork takes some milliseconds; to start Python and to import NumPy takes a tenth of a second. The
template itself runs no file of a student. It is a fork as well, of a process that has imported this
package only: what the grader imports afterwards, such as solutions, is not in its memory.
"""

import gc
import json
import os
import signal
import socket
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from numpy_cae.confined.confinement import PR_SET_PDEATHSIG, set_process_option
from numpy_cae.confined.process import MOST_DESCRIPTORS, serve, silence

PR_SET_CHILD_SUBREAPER = 36
"""A process is the parent of its descendants whose own parent has ended."""
LARGEST_REQUEST = 2**16
LOOK_SECONDS = 0.005
"""So often it is looked whether a process has ended."""
ANSWER_SECONDS = 60.0
"""A template that does not answer for so long (s) was stopped."""


Ending = tuple[int | None, float]
"""The exit code of a process, negative for a signal and None before its end, and its processor time
in seconds."""


def can_fork() -> bool:
    """Whether a template can be used: on Linux, where libraries allow forks after their import."""
    return sys.platform == "linux" and _list_of_children().exists()


def _list_of_children() -> Path:
    """The file that lists the processes whose parent this one is."""
    return Path(f"/proc/self/task/{os.getpid()}/children")


class Template:
    """The template as the grader sees it; it ends with the grader.

    It is to be made before the grader imports anything else, and before it has threads.
    """

    def __init__(self) -> None:
        self._connection, end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._process = os.fork()
        if self._process == 0:
            self._connection.close()
            try:
                _serve_requests(end)
            finally:
                os._exit(1)
        end.close()
        self._connection.settimeout(ANSWER_SECONDS)

    def start(self, folder: Path) -> "Fork":
        """Start a confined process in a folder; what an earlier one has left is ended."""
        read_end, answers = os.pipe()
        calls, write_end = os.pipe()
        try:
            reply = self._ask({"start": str(folder)}, (calls, answers))
        finally:
            os.close(calls)
            os.close(answers)
        return Fork(reply["process"], write_end, read_end, self)

    def close(self) -> None:
        """End the template and wait for its end; the confined process ends with it."""
        self._connection.close()
        os.kill(self._process, signal.SIGKILL)
        os.waitpid(self._process, 0)

    def _ask(self, request: dict[str, Any], descriptors: tuple[int, ...] = ()) -> dict[str, Any]:
        """The reply to a request."""
        socket.send_fds(self._connection, [json.dumps(request).encode()], descriptors)
        reply = self._connection.recv(LARGEST_REQUEST)
        if not reply:
            raise OSError("the process that starts others has ended")
        return json.loads(reply)


class Fork:
    """A confined process that a template has started.

    `calls` and `answers` are the descriptors by which it is called and answers.
    """

    def __init__(self, process: int, calls: int, answers: int, template: Template) -> None:
        self.process = process
        self.calls = calls
        self.answers = answers
        self._template = template
        self._ending: Ending = (None, 0.0)

    def wait(self, seconds: float) -> Ending:
        """How it ended, if it has ended or does so within so many seconds."""
        if self._ending[0] is None:
            reply = self._template._ask({"wait": seconds})
            self._ending = (reply["code"], reply["seconds"])
        return self._ending

    def kill(self) -> None:
        """Kill it and its group, unless its end is known."""
        if self._ending[0] is None:
            with suppress(OSError):  # it has just begun, and has no group
                os.killpg(self.process, signal.SIGKILL)

    def end(self) -> None:
        """Kill it and all that it has started."""
        os.close(self.calls)
        os.close(self.answers)
        self._template._ask({"end": True})


def _serve_requests(connection: socket.socket) -> None:
    """Do what the grader asks for, until it closes the connection."""
    set_process_option(PR_SET_PDEATHSIG, signal.SIGKILL)
    set_process_option(PR_SET_CHILD_SUBREAPER, 1)
    silence()
    gc.freeze()  # so that no collection copies memory that forks share
    process = 0
    while True:
        message, descriptors, _, _ = socket.recv_fds(connection, LARGEST_REQUEST, 2)
        if not message:
            os._exit(0)
        request = json.loads(message)
        reply: dict[str, Any] = {}
        if "start" in request:
            _end_children()
            process = os.fork()
            if process == 0:
                connection.close()
                _become_confined_program(request["start"], *descriptors)
            for descriptor in descriptors:
                os.close(descriptor)
            reply = {"process": process}
        elif "wait" in request:
            code, used = _wait(process, request["wait"])
            reply = {"code": code, "seconds": used}
        else:
            _end_children()
        connection.send(json.dumps(reply).encode())


def _become_confined_program(folder: str, calls: int, answers: int) -> None:
    """Serve calls in a folder, with no other open file than the connection."""
    try:
        first, last = sorted((calls, answers))
        os.closerange(3, first)
        os.closerange(first + 1, last)
        os.closerange(last + 1, MOST_DESCRIPTORS)
        os.setsid()
        os.chdir(folder)
        os.environ["TMPDIR"] = folder
        serve(calls, answers)
    finally:
        os._exit(1)


def _wait(process: int, seconds: float) -> Ending:
    """`Fork.wait` in the template; the process can be waited for once."""
    begun = time.monotonic()
    while True:
        ended, status, used = os.wait4(process, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime
        if time.monotonic() - begun > seconds:
            return None, 0.0
        time.sleep(LOOK_SECONDS)


def _end_children() -> None:
    """Kill the processes whose parent this one is.

    A child's own children become this process's when the child ends, and are killed next.
    """
    while processes := _list_of_children().read_text().split():
        for process in map(int, processes):
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
