"""The grader's process: test each function of a submission in a forked process of its own."""

import json
import os
import secrets
import signal
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy.ma  # noqa: F401  np.median imports it: too late where a file changes modules

from numpy_cae.verify.checks.mismatch import error_text
from numpy_cae.verify.grading.report import reply_of, tested
from numpy_cae.verify.grading.sandbox import confinement
from numpy_cae.verify.grading.submission import read_submission
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.property import Outcome

MOST_WRITTEN = 2**26
"""MOST_WRITTEN: all files of a process together may have at most so many bytes."""
LEAST_FILE = 2**12
"""LEAST_FILE: a file counts as at least so many bytes, an empty one too."""
CRASHED = "its process ended: it crashed, was killed for its memory, or ended itself"


def main() -> None:
    """Do the request on standard input; one reply goes to standard output."""
    confinement.end_with_parent()
    print(json.dumps(reply_to(json.load(sys.stdin))))


def reply_to(request: dict) -> dict:
    """What the file lacks, and for each function its outcomes or the reason why there are none."""
    confinement.set_process_option(confinement.PR_SET_CHILD_SUBREAPER, 1)
    return Grading(request).reply()


class Grading:
    """The grading of one file."""

    def __init__(self, request: dict) -> None:
        self.request = request
        self.submission = read_submission(Path(request["path"]))
        self.catalogue = import_module(request["catalogue"]).CATALOGUE
        self.given = {name: self.catalogue[name].solution for name in request["given"]}
        self.instead: dict[str, Callable] = {}  # solutions in place of functions that do not hold

    def reply(self) -> dict:
        """Test each function that the file defines, one after the other."""
        loaded = self.apart(self._names)
        defined = loaded.get("defined", ())
        results: dict[str, dict] = {}
        for name in self.request["wanted"]:
            is_right = False
            if name in defined:
                results[name] = self._outcomes(name)
                failed = "failed" in results[name]
                is_right = not failed and all(o["held"] for o in results[name]["outcomes"])
            if name in self.request["replaced"] and not is_right:
                self.instead[name] = self.catalogue[name].solution
        return {"failed": "", "problems": [], **loaded, "results": results}

    def apart(self, work: Callable[[], dict]) -> dict:
        """The result of work in a confined process, which may be idle as long as it may work."""
        result = do_apart(partial(_confined, work, self.request), 2 * self.request["seconds"])
        confinement.end_children()  # such as a process that left the group which do_apart kills
        return result

    def _names(self) -> dict:
        functions, problems = self.submission.run(self.given, {})
        defined = [name for name in self.request["wanted"] if name in functions]
        return {"defined": defined, "problems": problems}

    def _outcomes(self, name: str) -> dict:
        """The outcomes of one function; if its process is ended, those until then."""
        until_then = Path(secrets.token_hex(16)).absolute()
        result = self.apart(partial(self._tested, name, until_then))
        with suppress(OSError, ValueError):
            if result.get("failed"):
                result = {**json.loads(until_then.read_text()), **result}
        until_then.unlink(missing_ok=True)
        return result

    def _tested(self, name: str, until_then: Path) -> dict:
        begun = until_then.with_suffix(".new")

        def begin(outcomes: Sequence[Outcome], case: Case) -> None:
            begun.write_text(json.dumps({**reply_of(outcomes), "trying": str(case)}))
            begun.replace(until_then)

        functions, _ = self.submission.run(self.given, self.instead)
        return reply_of(tested(self.catalogue[name], functions[name], begin))


def do_apart(work: Callable[[], dict], seconds: float) -> dict:
    """The result of `work`, done by a forked process; without fork (Windows), by this one.

    The result goes through a file in the current folder, so it must be what JSON can hold. If the
    process ends without a result, does not end within so many seconds or fills the folder, this is
    {"failed": why}.

    Time in which the process waits for a processor does not count, so that the result does not
    depend on what else the machine does.
    """
    if not hasattr(os, "fork"):
        return work()
    reply = Path(secrets.token_hex(16)).absolute()
    process = os.fork()
    if process == 0:
        try:
            os.setsid()
            os.closerange(3, 4096)
            reply.write_text(json.dumps(work()))
        finally:
            os._exit(0)
    fault = _wait(process, seconds, reply.parent)
    with suppress(OSError):
        os.killpg(process, signal.SIGKILL)
    try:
        return {"failed": fault} if fault else json.loads(reply.read_text())
    except (OSError, ValueError):
        return {"failed": CRASHED}


def _wait(process: int, seconds: float, folder: Path) -> str:
    """Wait for a process, or end it; what is wrong, or ""."""
    begun = time.monotonic()
    while True:
        time.sleep(0.005)
        taken = time.monotonic() - begun - _waited(process)
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            out_of_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
            return "it used up its CPU time: an endless loop?" * out_of_time
        fault = f"it did not finish within {seconds:.3g} s: an endless loop?" * (taken > seconds)
        if _written(folder) > MOST_WRITTEN:
            fault = f"it wrote more than {MOST_WRITTEN // 2**20} MB of files"
        if fault:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
            return fault


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
    """Do work with limits; an exception becomes the reason of a failure."""
    kept = confinement.confine(request["seconds"], request["megabytes"], Path.cwd())
    try:
        result = work()
    except BaseException as error:  # such as KeyboardInterrupt
        result = {"failed": error_text(error)}
    del kept
    return result


if __name__ == "__main__":
    main()
