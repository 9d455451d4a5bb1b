"""Do one piece of work in a forked process, which ends in time whatever it starts."""

from __future__ import annotations

import json
import os
import secrets
import select
import signal
import time
from collections.abc import Callable
from pathlib import Path

from numpy_cae.errors import NumpyCaeError

MAX_REPLY = 2**20
CRASHED = "its process ended: it crashed, was killed for its memory, or ended itself"
NO_REPLY = "its process sent something that is no reply"


class Ended(NumpyCaeError):
    """A process came to no result; the message says why."""


def do_apart(work: Callable[[], dict], seconds: float) -> dict:
    """The result of `work`, done by a forked process; without fork (Windows), by this one.

    Parameters
    ----------
    work : callable
        Returns what JSON can hold.
    seconds : float
        On the clock, until the process and all those that it has started are killed.

    Raises
    ------
    Ended
        If the process ends without a reply, sends another one, or does not end in time.
    """
    if not hasattr(os, "fork"):
        return work()
    token = secrets.token_hex(16)
    reader, writer = os.pipe()
    process = os.fork()
    if process == 0:
        _reply(work, token, writer)
    os.close(writer)
    try:
        received = _receive(reader, process, time.monotonic() + seconds)
    except TimeoutError:
        raise Ended(f"it did not finish within {seconds:.3g} s: an endless loop?") from None
    finally:
        os.close(reader)
        status = _end(process)
    if not received:
        out_of_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
        raise Ended("it used up its CPU time: an endless loop?" if out_of_time else CRASHED)
    try:
        reply = json.loads(received)
        if reply.pop("token") != token:
            raise ValueError("a reply of the student's own")
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise Ended(NO_REPLY) from None
    return reply


def _reply(work: Callable[[], dict], token: str, writer: int) -> None:
    """Work, reply and end, whatever `work` does."""
    try:
        os.setsid()
        os.closerange(3, writer)
        os.closerange(writer + 1, 4096)
        reply = (json.dumps(work() | {"token": token}) + "\n").encode()
        while reply:
            reply = reply[os.write(writer, reply) :]
    finally:
        os._exit(0)


def _receive(reader: int, process: int, deadline: float) -> bytes:
    """What a process sends until a line, or itself, ends; a TimeoutError if neither does."""
    received = b""
    while not received.endswith(b"\n") and len(received) <= MAX_REPLY:
        over = os.waitid(os.P_PID, process, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        if select.select([reader], [], [], 0 if over else 0.05)[0]:
            chunk = os.read(reader, 2**16)
            if not chunk:
                break
            received += chunk
        elif over:
            break
        if time.monotonic() > deadline:
            raise TimeoutError
    return received


def _end(process: int) -> int:
    """Kill a process and all that it has started; return its status.

    On Linux those that left its session are children of this process when their parent ends.
    """
    try:
        os.killpg(process, signal.SIGKILL)
    except OSError:  # it has not made its session yet
        os.kill(process, signal.SIGKILL)
    _, status = os.waitpid(process, 0)
    while orphans := _children():
        for orphan in orphans:
            os.kill(orphan, signal.SIGKILL)
            os.waitpid(orphan, 0)
    return status


def _children() -> list[int]:
    """The processes whose parent this one is, as far as /proc tells."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = path.read_text(errors="replace").rpartition(")")[2].split()[1]
        except (OSError, IndexError):
            continue
        if parent == str(os.getpid()):
            found.append(int(path.parent.name))
    return found
