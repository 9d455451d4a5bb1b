"""What a student's process may do: limits of the system, refused actions, modules of its own."""

import ctypes
import math
import os
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path
from types import ModuleType

try:
    import resource
except ImportError:  # Windows, where a process has no such limits
    resource = None

LARGEST_WRITTEN_FILE = 2**24
"""LARGEST_WRITTEN_FILE: a process may write at most so many bytes to one file."""
OPEN_FILES = 64
"""OPEN_FILES: a process may have so many files open: removed ones take space that is not seen."""
PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36
"""PR_SET_CHILD_SUBREAPER: a process is the parent of its descendants whose own parent has ended."""
SHARED = ("sys", "warnings")
"""Modules that the interpreter itself looks into; a copy would change nothing."""
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
CHANGES = "remove rename rmdir mkdir link symlink truncate chmod chown utime".split()
REFUSED = ("os.fork", "os.exec", "os.posix_spawn", "os.spawn", "os.system", "os.kill", "socket.")
REFUSED += ("subprocess.Popen", "_winapi.CreateProcess")
DO_THE_EXERCISE = (
    "aesara autograd casadi chainer cupy dynet flax jax keras mindspore mlx mxnet numpy_cae paddle "
    "pytensor sympy tangent tensorflow theano tinygrad torch"
).split()


def end_with_parent() -> None:
    """Make this process end when its parent ends (Linux)."""
    set_process_option(PR_SET_PDEATHSIG, signal.SIGKILL)


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
    end_with_parent()
    cpu = math.ceil(time.process_time() + seconds)
    limits = {"CPU": cpu, "AS": _mapped() + megabytes * 2**20, "NPROC": 0, "CORE": 0}
    limits["NOFILE"] = OPEN_FILES
    for name, limit in (limits | {"FSIZE": LARGEST_WRITTEN_FILE}).items():
        with suppress(ValueError, OSError, AttributeError):  # as far as the system has it
            hard = limit + (name == "CPU")  # the soft limit ends it with a signal of its own
            resource.setrlimit(getattr(resource, f"RLIMIT_{name}"), (limit, hard))
    _refuse_actions(os.path.realpath(folder))
    return _isolate_modules()


def _mapped() -> int:
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

    def hook(event: str, arguments: tuple) -> None:
        changed = arguments if event.removeprefix("os.") in CHANGES else ()
        if event == "open" and isinstance(arguments[2], int) and arguments[2] & WRITING:
            changed = arguments[:1]
        if event == "import" and _does_the_exercise(arguments[0]):
            package = arguments[0].partition(".")[0]
            raise ImportError(f"{package} may not be imported: write the operation by hand")
        if event.startswith(REFUSED) or any(map(is_elsewhere, changed)):
            raise PermissionError(f"{event} is not allowed while a file is graded")

    sys.addaudithook(hook)


def _isolate_modules() -> list[ModuleType]:
    """Replace every module by a copy, so that what a file changes there does not reach the tests.

    The tests keep the modules that they have, which are returned, to be kept while in use.
    """
    loaded = [(name, module) for name, module in sys.modules.items() if name not in SHARED]
    ours = {name: module for name, module in loaded if type(module) is ModuleType}
    copies = {name: ModuleType(name) for name in ours if not _does_the_exercise(name)}
    for name, copy in copies.items():
        vars(copy).update(vars(ours[name]))
    for name, copy in copies.items():
        package, _, last = name.rpartition(".")
        if package in copies and vars(copies[package]).get(last) is ours[name]:
            setattr(copies[package], last, copy)
    for name in ours.keys() - copies.keys():
        del sys.modules[name]
    sys.modules.update(copies)
    sys.meta_path[:] = [f for f in sys.meta_path if not _does_the_exercise(type(f).__module__)]
    return list(ours.values())


def _does_the_exercise(module: str) -> bool:
    return module.partition(".")[0] in DO_THE_EXERCISE
