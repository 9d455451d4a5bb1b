"""Do one piece of work in a forked process, which ends in time whatever it starts."""

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
    deadline, ended, status = time.monotonic() + seconds, 0, 0
    while not ended and time.monotonic() < deadline:
        time.sleep(0.005)
        ended, status = os.waitpid(process, os.WNOHANG)
    with suppress(OSError):
        os.killpg(process, signal.SIGKILL)
    _kill([] if ended else [process])
    while orphans := _children():
        _kill(orphans)
    if not ended:
        return {"failed": f"it did not finish within {seconds:.3g} s: an endless loop?"}
    try:
        return json.loads(reply.read_text())
    except (OSError, ValueError):
        out_of_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
        return {"failed": "it used up its CPU time: an endless loop?" if out_of_time else CRASHED}


def _kill(processes: list[int]) -> None:
    for process in processes:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)


def _children() -> list[int]:
    """The processes whose parent this one is, as far as /proc tells.

    On Linux those that left their session are among them when their parent has ended.
    """
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            number, _, rest = path.read_text(errors="replace").rpartition(")")
            if rest.split()[1:2] == [str(os.getpid())]:
                found.append(int(number.split()[0]))
    return found
