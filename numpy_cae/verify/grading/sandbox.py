"""The grader's process: test each function of a submission in a confined process of its own.

A student's process has limits of the system, refused actions and modules of its own.
"""

import ctypes
import json
import math
import os
import secrets
import signal
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy.ma  # noqa: F401  np.median imports it: too late where a file changes modules

from numpy_cae.verify.checks.messages import error_text
from numpy_cae.verify.grading.report import reply_of, try_all
from numpy_cae.verify.grading.submission import Submission, read_submission
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation_catalogue import Exercise
from numpy_cae.verify.operations.property import Outcome

try:
    import resource
except ImportError:  # Windows, where a process has no such limits
    resource = None  # type: ignore[assignment]

MOST_WRITTEN = 2**26
"""All files of a process together may have at most this many bytes."""
LEAST_FILE = 2**12
"""A file counts as at least this many bytes, an empty one too."""
CRASHED = "its process ended: it crashed, was killed for its memory, or ended itself"
LARGEST_WRITTEN_FILE = 2**24
"""A process may write at most this many bytes to one file."""
OPEN_FILES = 64
"""A process may have so many files open: removed ones take space that is not seen."""
PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36
"""A process is the parent of its descendants whose own parent has ended."""
SHARED = ("sys", "warnings")
"""Modules that the interpreter itself looks into; a copy would change nothing."""
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
CHANGES = "remove rename rmdir mkdir link symlink truncate chmod chown utime".split()
"""Functions of `os` that change what is at the paths that they are given."""
REFUSED = (
    "os.fork",
    "os.exec",
    "os.posix_spawn",
    "os.spawn",
    "os.system",
    "os.kill",
    "socket.",
    "subprocess.Popen",
    "_winapi.CreateProcess",
)
"""Actions whose names begin so are refused."""
POLL_SECONDS = 0.005
"""So often it is asked whether a process has ended."""
DO_THE_EXERCISE = (
    "aesara autograd casadi chainer cupy dynet flax jax keras mindspore mlx mxnet numpy_cae paddle "
    "pytensor sympy tangent tensorflow theano tinygrad torch"
).split()


Send = Callable[..., None]
"""Adds its keywords to what a process has sent."""


def main() -> None:
    """Do the request on standard input; one reply goes to standard output."""
    set_process_option(PR_SET_PDEATHSIG, signal.SIGKILL)
    print(json.dumps(reply_to(json.load(sys.stdin))))


def reply_to(request: dict[str, Any]) -> dict[str, Any]:
    """What the file lacks, and for each function its outcomes or the reason why there are none."""
    set_process_option(PR_SET_CHILD_SUBREAPER, 1)
    submission = read_submission(Path(request["path"]))
    catalogue: Mapping[str, Exercise] = import_module(request["catalogue"]).CATALOGUE
    provided = {name: catalogue[name].solution for name in request["provided"]}
    reply: dict[str, Any] = {"defined": (), "problems": []}
    reply |= run_confined(partial(_send_names, submission, provided, request), request)
    results: dict[str, dict[str, Any]] = {}
    replacements: dict[str, Callable] = {}  # solutions in place of functions that do not hold
    for name in request["requested"]:
        is_right = False
        if name in reply["defined"]:
            work = partial(_send_outcomes, submission, provided, replacements, catalogue[name])
            results[name] = run_confined(work, request)
            is_right = _is_right(results[name])
        if name in request["replaced"] and not is_right:
            replacements[name] = catalogue[name].solution
    return {**reply, "results": results}


def _send_names(
    submission: Submission, provided: Mapping[str, Callable], request: dict[str, Any], send: Send
) -> None:
    """Run the file, and send which of the requested functions it defines, and its problems."""
    functions, problems = submission.run(provided, {})
    defined = [name for name in request["requested"] if name in functions]
    send(defined=defined, problems=problems)


def _send_outcomes(
    submission: Submission,
    provided: Mapping[str, Callable],
    replacements: Mapping[str, Callable],
    exercise: Exercise,
    send: Send,
) -> None:
    """Run the file, and send the outcomes of the properties of one of its functions."""

    def send_case(outcomes: Sequence[Outcome], case: Case) -> None:
        send(**reply_of(outcomes), trying=str(case))

    functions, _ = submission.run(provided, replacements)
    send(**reply_of(try_all(exercise, functions[exercise.name], send_case)))


def _is_right(result: Mapping[str, Any]) -> bool:
    """Whether a function's process has ended well and every property holds."""
    return not result["failed"] and all(outcome["held"] for outcome in result["outcomes"])


def run_confined(work: Callable[[Send], None], request: dict[str, Any]) -> dict[str, Any]:
    """What work sends in a confined process, which may be idle as long as it may work."""

    def work_confined(send: Send) -> None:
        modules = confine(request["seconds"], request["megabytes"], Path.cwd())
        try:
            work(send)
            send(failed="")
        except BaseException as error:  # such as KeyboardInterrupt
            send(failed=error_text(error))
        del modules

    sent = run_in_fork(work_confined, 2 * request["seconds"])
    end_children()  # such as a process that left the group which run_in_fork kills
    return sent


def run_in_fork(work: Callable[[Send], None], seconds: float) -> dict[str, Any]:
    """What `work` sends in a forked process; without fork (Windows), in this one.

    It gets a function `send` whose keywords are added to what it sent before. They go through a
    file in the current folder, so they must be what JSON can hold. If the process ends before it
    says what `failed`, does not end within so many seconds or fills the folder, `failed` says so.

    Time in which the process waits for a processor does not count, so that the result does not
    depend on what else the machine does.
    """
    sent: dict[str, Any] = {"failed": CRASHED}
    if not hasattr(os, "fork"):
        work(sent.update)
        return sent
    reply = Path(secrets.token_hex(16)).absolute()

    def send(**more: object) -> None:
        sent.update(more)
        unfinished = reply.with_suffix(".new")
        unfinished.write_text(json.dumps(sent))
        unfinished.replace(reply)

    process = os.fork()
    if process == 0:
        try:
            os.setsid()
            os.closerange(3, 4096)
            work(send)
        finally:
            os._exit(0)
    fault = _wait(process, seconds, reply.parent)
    with suppress(OSError):
        os.killpg(process, signal.SIGKILL)
    with suppress(OSError, ValueError):
        sent = json.loads(reply.read_text())
    reply.unlink(missing_ok=True)
    if fault:
        sent["failed"] = fault
    return sent


def _wait(process: int, seconds: float, folder: Path) -> str:
    """Wait for a process, or end it; what is wrong, or ""."""
    begun = time.monotonic()
    while True:
        time.sleep(POLL_SECONDS)
        elapsed = time.monotonic() - begun - _seconds_waited(process)
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            is_out_of_time = os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU
            return "it used up its CPU time: an endless loop?" if is_out_of_time else ""
        fault = ""
        if elapsed > seconds:
            fault = f"it did not finish within {seconds:.3g} s: an endless loop?"
        if _bytes_written(folder) > MOST_WRITTEN:
            fault = f"it wrote more than {MOST_WRITTEN // 2**20} MB of files"
        if fault:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
            return fault


def _seconds_waited(process: int) -> float:
    """The seconds that a process has waited for a processor; 0 where the system does not say."""
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) / 1e9
    except (OSError, ValueError, IndexError):  # not Linux, or the process has ended
        return 0.0


def _bytes_written(folder: Path) -> int:
    """The bytes of all files in a folder."""
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            with suppress(OSError):  # removed since
                total += max(LEAST_FILE, os.lstat(os.path.join(parent, name)).st_size)
    return total


def set_process_option(option: int, value: int) -> None:
    with suppress(OSError, AttributeError, TypeError):  # not Linux
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def end_children() -> None:
    """Kill the processes whose parent this one is, where /proc lists them (Linux).

    A child's own children become this process's when the child ends, and are killed next.
    """
    children = Path(f"/proc/self/task/{os.getpid()}/children")
    while children.exists() and (processes := children.read_text().split()):
        for process in map(int, processes):
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)


def confine(seconds: float, megabytes: int, folder: Path) -> list[ModuleType]:
    """Limit this process for the rest of its life; it reads and prints nothing.

    It may use so many seconds of CPU time from now and so much more memory than it has, and change
    files in this folder only. Returns the modules that the tests use, to be kept: what is imported
    from now on gets copies.
    """
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nothing, stream)
    sys.stdin = open(0, closefd=False)
    sys.stdout = sys.stderr = open(1, "w", errors="replace", closefd=False)
    set_process_option(PR_SET_PDEATHSIG, signal.SIGKILL)
    cpu = math.ceil(time.process_time() + seconds)
    limits = {
        "CPU": cpu,
        "AS": _bytes_mapped() + megabytes * 2**20,
        "NPROC": 0,
        "CORE": 0,
        "NOFILE": OPEN_FILES,
        "FSIZE": LARGEST_WRITTEN_FILE,
    }
    for name, limit in limits.items():
        # At its soft limit of CPU time a process ends by a signal of its own.
        hard = limit + 1 if name == "CPU" else limit
        with suppress(ValueError, OSError, AttributeError):  # as far as the system has it
            resource.setrlimit(getattr(resource, f"RLIMIT_{name}"), (limit, hard))
    _refuse_actions(os.path.realpath(folder))
    return _isolate_modules()


def _bytes_mapped() -> int:
    """The bytes of memory that this process has mapped; 0 where the system does not say."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        return 0


def _refuse_actions(folder: str) -> None:
    """Refuse new processes, connections, some imports, changes of files outside a folder."""

    def is_elsewhere(path: object) -> bool:
        if not isinstance(path, str | bytes | os.PathLike):
            return False
        real = os.path.realpath(os.fsdecode(path))
        return real != os.devnull and os.path.commonpath([real, folder]) != folder

    def refuse(event: str, arguments: tuple) -> None:
        if event == "import" and _does_the_exercise(arguments[0]):
            package = arguments[0].partition(".")[0]
            raise ImportError(f"{package} may not be imported: write the operation by hand")
        changed: tuple = ()
        if event.removeprefix("os.") in CHANGES:
            changed = arguments
        if event == "open" and isinstance(arguments[2], int) and arguments[2] & WRITING:
            changed = arguments[:1]
        if event.startswith(REFUSED) or any(map(is_elsewhere, changed)):
            raise PermissionError(f"{event} is not allowed while a file is graded")

    sys.addaudithook(refuse)


def _isolate_modules() -> list[ModuleType]:
    """Replace every module by a copy, so that what a file changes there does not reach the tests.

    The tests keep the modules that they have, which are returned, to be kept while in use.
    """
    originals = {}
    for name, module in list(sys.modules.items()):
        if name not in SHARED and type(module) is ModuleType:
            originals[name] = module
    copies = {name: ModuleType(name) for name in originals if not _does_the_exercise(name)}
    for name, copy in copies.items():
        vars(copy).update(vars(originals[name]))
    for name, copy in copies.items():
        package, _, last = name.rpartition(".")
        if package in copies and vars(copies[package]).get(last) is originals[name]:
            setattr(copies[package], last, copy)
    for name in originals.keys() - copies.keys():
        del sys.modules[name]
    sys.modules.update(copies)
    sys.meta_path[:] = [f for f in sys.meta_path if not _does_the_exercise(type(f).__module__)]
    return list(originals.values())


def _does_the_exercise(module: str) -> bool:
    return module.partition(".")[0] in DO_THE_EXERCISE


if __name__ == "__main__":
    main()
