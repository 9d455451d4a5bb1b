"""Do one piece of work in a forked process, which ends in time whatever it starts."""

from __future__ import annotations

import json
import os
import secrets
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

CRASHED = "its process ended: it crashed, was killed for its memory, or ended itself"


def do_apart(work: Callable[[], dict], seconds: float) -> dict:
    """The result of `work`, done by a forked process; without fork (Windows), by this one.

    The result goes through a file in the current folder, so it must be what JSON can hold. If the
    process ends without one, or does not end within so many seconds, this is {"failed": why}.
    """
    if not hasattr(os, "fork"):
        return work()
    reply, process = Path(secrets.token_hex(16)).absolute(), os.fork()
    if process == 0:
        try:
            os.setsid()
            os.closerange(3, 4096)
            reply.write_text(json.dumps(work()))
        finally:
            os._exit(0)
    ended, status = _wait(process, seconds)
    _kill_what_is_left(process, ended)
    if not ended:
        return {"failed": f"it did not finish within {seconds:.3g} s: an endless loop?"}
    try:
        return json.loads(reply.read_text())
    except (OSError, ValueError):
        out_of_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
        return {"failed": "it used up its CPU time: an endless loop?" if out_of_time else CRASHED}


def _wait(process: int, seconds: float) -> tuple[bool, int]:
    """Whether a process ends in time, and its status."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            return True, status
        time.sleep(0.005)
    return False, 0


def _kill_what_is_left(process: int, ended: bool) -> None:
    """Kill a process and all that it has started.

    On Linux those that left its session are children of this process when their parent ends.
    """
    with suppress(OSError):
        os.killpg(process, signal.SIGKILL)
    if not ended:
        _kill(process)
    while orphans := _children():
        for orphan in orphans:
            _kill(orphan)


def _kill(process: int) -> None:
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)


def _children() -> list[int]:
    """The processes whose parent this one is, as far as /proc tells."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            number, _, rest = path.read_text(errors="replace").rpartition(")")
            if rest.split()[1:2] == [str(os.getpid())]:
                found.append(int(number.split()[0]))
    return found
