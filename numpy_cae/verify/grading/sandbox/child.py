"""The grader's process: test each function of a submission in a forked process of its own."""

import json
import os
import secrets
import signal
import sys
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy.ma  # noqa: F401  np.median imports it: too late where a file changes modules

from numpy_cae.verify.grading.report import report
from numpy_cae.verify.grading.sandbox import confinement
from numpy_cae.verify.grading.submission import read_submission
from numpy_cae.verify.operations.trial import described

MAX_NOTES = 5
CRASHED = "its process ended: it crashed, was killed for its memory, or ended itself"


def main() -> None:
    """Do the request on standard input; one reply goes to standard output."""
    confinement.end_with_parent()
    print(json.dumps(reply_to(json.load(sys.stdin))))


def reply_to(request: dict) -> dict:
    """What the file lacks, and for each function a report or the reason why there is none."""
    confinement.adopt_orphans()
    submission = read_submission(Path(request["path"]))
    catalogue = import_module(request["catalogue"]).CATALOGUE
    given = {name: catalogue[name].solution for name in request["given"]}
    wanted, deadline = request["wanted"], time.monotonic() + request["seconds"]

    def apart(work: Callable[[], dict], left: int) -> dict:
        """The result of work in a confined process; the time that is left is for so many."""
        seconds = min(2 * request["cpu_seconds"], (deadline - time.monotonic()) / left)
        if seconds <= 0:
            return {"failed": "the time limit for the whole file is used up"}
        result = do_apart(partial(_confined, work, request), seconds)
        confinement.end_children()  # such as a process that left the group which do_apart kills
        return result

    def names() -> dict:
        functions, problems = submission.run(given, {})
        return {"defined": [n for n in wanted.values() if n in functions], "problems": problems}

    def tested(name: str, function: str) -> dict:
        functions, _ = submission.run(given, instead)
        any_convention = request["any_convention"]
        return report(catalogue[name], functions[function], any_convention, function).as_json()

    loaded = apart(names, 1)
    present = [name for name, function in wanted.items() if function in loaded.get("defined", ())]
    results, instead = {}, {}
    for name, function in wanted.items():
        if name in present:
            results[name] = apart(partial(tested, name, function), len(present) - len(results))
        if name in request["replaced"] and not results.get(name, {}).get("held"):
            instead[function] = catalogue[name].solution
    return {"failed": "", "problems": [], **loaded, "results": results}


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
    if not ended:
        os.waitpid(process, 0)
        return {"failed": f"it did not finish within {seconds:.3g} s: an endless loop?"}
    try:
        return json.loads(reply.read_text())
    except (OSError, ValueError):
        out_of_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
        return {"failed": "it used up its CPU time: an endless loop?" if out_of_time else CRASHED}


def _confined(work: Callable[[], dict], request: dict) -> dict:
    """Do work with limits; a warning becomes a note, an exception the reason of a failure."""
    kept = confinement.confine(request["cpu_seconds"], request["megabytes"], Path.cwd())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        try:
            result = work()
        except BaseException as error:  # such as KeyboardInterrupt
            result = {"failed": described(error)}
    del kept
    notes = (f"{described(one.message)} (line {one.lineno})" for one in caught[:MAX_NOTES])
    return {**result, "notes": list(dict.fromkeys(notes))}


if __name__ == "__main__":
    main()
