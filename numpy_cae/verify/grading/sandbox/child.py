"""The grader's process: test each function of a submission in a forked process of its own."""

import json
import os
import secrets
import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy.ma  # noqa: F401  np.median imports it: too late where a file changes modules

from numpy_cae.verify.checks.notes import noted
from numpy_cae.verify.checks.written import error_text
from numpy_cae.verify.grading.report import report
from numpy_cae.verify.grading.sandbox import confinement
from numpy_cae.verify.grading.submission import read_submission
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.trial import failure

MOST_WRITTEN = 2**26
"""MOST_WRITTEN: the bytes that all files of a process may have together; an empty file counts as
`LEAST_FILE` bytes."""
LEAST_FILE = 2**12
SEVERAL_THREADS = "the grader's process has several threads, so that it cannot be forked safely"
RIGHT_ALONE = "\nalone in a fresh process this example is right: something is kept between calls"
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
    wanted, used = request["wanted"], 0.0

    def apart(work: Callable[[], dict], left: int) -> dict:
        """The result of work in a confined process; the time that is left is for so many."""
        nonlocal used
        seconds = min(2 * request["cpu_seconds"], (request["seconds"] - used) / left)
        if seconds <= 0:
            return {"failed": "the time limit for the whole file is used up"}
        result = do_apart(partial(_confined, work, request), seconds)
        used += result.pop("seconds", 0.0)
        confinement.end_children()  # such as a process that left the group which do_apart kills
        return result

    def names() -> dict:
        functions, problems = submission.run(given, {})
        return {"defined": [n for n in wanted.values() if n in functions], "problems": problems}

    def tested(name: str, function: str) -> dict:
        functions, _ = submission.run(given, instead)
        any_convention = request["any_convention"]
        return report(catalogue[name], functions[function], any_convention, function).as_json()

    def alone(name: str, function: str, number: int, sizes: list, seed: int) -> dict:
        functions, _ = submission.run(given, instead)
        stated, case = catalogue[name].properties[number], Case(tuple(map(tuple, sizes)), seed)
        return {"right": failure(stated, functions[function], case) is None}

    loaded = apart(names, 1)
    present = [name for name, function in wanted.items() if function in loaded.get("defined", ())]
    results, instead = {}, {}
    for name, function in wanted.items():
        if name in present:
            left = len(present) - len(results)
            results[name] = apart(partial(tested, name, function), left)
            with suppress(LookupError, TypeError, AttributeError):  # a file may write its own reply
                for number, one in enumerate(results[name].get("properties", ())):
                    again = one["case"] and partial(alone, name, function, number, *one["case"])
                    if again and apart(again, left).get("right"):
                        one["problem"] += RIGHT_ALONE
        if name in request["replaced"] and not results.get(name, {}).get("held"):
            instead[function] = catalogue[name].solution
    return {"failed": "", "problems": [], **loaded, "results": results}


def do_apart(work: Callable[[], dict], seconds: float) -> dict:
    """The result of `work`, done by a forked process; without fork (Windows), by this one.

    The result goes through a file in the current folder, so it must be what JSON can hold. It gets
    `seconds`, the time that the process took. If the process ends without a result, does not end
    within so many seconds or fills the folder, this is {"failed": why}.

    Time in which the process waits for a processor does not count, so that the result does not
    depend on what else the machine does.
    """
    if not hasattr(os, "fork"):
        return work()
    threads = Path("/proc/self/task")
    if threads.is_dir() and len(list(threads.iterdir())) > 1:
        return {"failed": SEVERAL_THREADS}  # a lock of another thread would stay closed for ever
    reply, process = Path(secrets.token_hex(16)).absolute(), os.fork()
    if process == 0:
        try:
            os.setsid()
            os.closerange(3, 4096)
            reply.write_text(json.dumps(work()))
        finally:
            os._exit(0)
    begun, taken, ended, status, fault = time.monotonic(), 0.0, 0, 0, ""
    while not ended and not fault:
        time.sleep(0.005)
        taken = time.monotonic() - begun - _waited(process)
        ended, status = os.waitpid(process, os.WNOHANG)
        if taken > seconds:
            fault = f"it did not finish within {seconds:.3g} s: an endless loop?"
        elif _written(reply.parent) > MOST_WRITTEN:
            fault = f"it wrote more than {MOST_WRITTEN // 2**20} MB of files"
    with suppress(OSError):
        os.killpg(process, signal.SIGKILL)
    if not ended:
        os.waitpid(process, 0)
        return {"failed": fault, "seconds": taken}
    try:
        return {**json.loads(reply.read_text()), "seconds": taken}
    except (OSError, ValueError):
        out_of_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
        reason = "it used up its CPU time: an endless loop?" if out_of_time else CRASHED
        return {"failed": reason, "seconds": taken}


def _waited(process: int) -> float:
    """The seconds that a process has waited for a processor; 0 where the system does not say."""
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) / 1e9
    except (OSError, ValueError, IndexError):  # not Linux, or the process has ended
        return 0.0


def _written(folder: Path) -> int:
    """The bytes of all files in a folder."""
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            with suppress(OSError):  # removed since
                total += max(LEAST_FILE, os.lstat(os.path.join(parent, name)).st_size)
    return total


def _confined(work: Callable[[], dict], request: dict) -> dict:
    """Do work with limits; a warning becomes a note, an exception the reason of a failure."""
    kept = confinement.confine(request["cpu_seconds"], request["megabytes"], Path.cwd())
    notes: list[str] = []
    with noted(notes):
        try:
            result = work()
        except BaseException as error:  # such as KeyboardInterrupt
            result = {"failed": error_text(error)}
    del kept
    return {**result, "notes": [*notes, *result.get("notes", ())]}


if __name__ == "__main__":
    main()
