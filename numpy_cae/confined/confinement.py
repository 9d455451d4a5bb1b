"""Limits of the system on this process, for the rest of its life.

On Linux four mechanisms work together; none needs a package or rights.

- Landlock (kernel 5.13 and later): files are changed below one folder only, and read only where
  Python, NumPy and the folder of the student's file are. Later versions refuse to connect and to
  send signals.
- A seccomp filter: the kernel refuses every call that is not in the list `system_calls`. Landlock
  has no rule for changes of modes, owners and times, for sockets that are not TCP, for new
  processes and for the limits of other processes.
- Another user, where this process is root's and that user can read what it needs; else root
  without its capabilities.
- Limits (`setrlimit`) on processor time, memory, processes, open files and the size of files. These
  are there on macOS, too.

`confine` returns the names of those that were in effect.
"""

import ctypes
import errno
import math
import os
import platform
import signal
import struct
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from numpy_cae.confined.system_calls import (
    AARCH64,
    ALLOWED,
    ARCHITECTURES,
    CLONE_THREAD,
    CONDITIONAL,
    OWNERSHIP,
    QUESTIONS,
)

try:
    import resource
except ImportError:  # Windows, where a process has no such limits
    resource = None  # type: ignore[assignment]

LANDLOCK = "landlock"
SECCOMP = "seccomp"
OTHER_USER = "another user"
LIMITS = "limits"
"""The names of the mechanisms."""

OPEN_FILES = 64
"""A process may have so many files open: removed ones take space that is not seen."""
LARGEST_WRITTEN_FILE = 2**24
"""A process may write at most so many bytes to one file."""
NOBODY = 65534
"""The user and the group that own nothing."""

CREATE_RULESET = 444
ADD_RULE = 445
RESTRICT_SELF = 446
"""The numbers of Landlock's system calls, the same on every architecture."""
EXECUTE = 1 << 0
WRITE_FILE = 1 << 1
READ_FILE = 1 << 2
READ_FOLDER = 1 << 3
TRUNCATE = 1 << 14
USE_DEVICE = 1 << 15
OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE | USE_DEVICE
"""Landlock's rights that a rule about a file, not a folder, may have."""
RIGHTS_BY_VERSION = {1: 13, 2: 14, 3: 15, 4: 15, 5: 16}
"""So many rights about files has each version of Landlock; later ones have as many as the last."""
SPECIAL_FILES = (6, 9, 10, 11)
"""The rights, by their bits, to make devices, sockets and named pipes, which nobody gets."""
BOTH_TCP = 0b11
"""To bind and to connect a TCP socket, from version 4 on."""
BOTH_SCOPES = 0b11
"""Abstract sockets and signals stay within the process, from version 6 on."""

PR_SET_PDEATHSIG = 1
PR_SET_SECCOMP = 22
PR_SET_NO_NEW_PRIVS = 38
SECCOMP_MODE_FILTER = 2
CAPABILITY_VERSION = 0x20080522

LOAD = 0x20
JUMP_IF_EQUAL = 0x15
JUMP_IF_AT_LEAST = 0x35
JUMP_IF_BITS = 0x45
RETURN = 0x06
"""Instructions of a filter (BPF): load a word, jump, return."""
ALLOW = 0x7FFF0000
REFUSE = 0x00050000 | errno.EPERM
ABSENT = 0x00050000 | errno.ENOSYS
"""What a filter returns: the call is made, is refused, or is said not to exist."""
NUMBER_AT = 0
ARCHITECTURE_AT = 4
ARGUMENTS_AT = 16
"""Where a filter finds these in its data."""
OF_X32 = 0x40000000
"""Numbers of calls from this one on are those of x32, which has a list of its own."""

Instruction = tuple[int, int, int, int]
"""(code, jump if true, jump if false, number)."""


def confine(
    seconds: float, megabytes: int, folder: Path, readable: Sequence[Path], hidden: Sequence[Path]
) -> list[str]:
    """Confine this process, which has one thread.

    Parameters
    ----------
    seconds : float
        Processor time from now on.
    megabytes : int
        Memory in addition to what the process has.
    folder : Path
        Where it may change files; it is given to the other user.
    readable : sequence of Path
        What it may read besides Python and its packages.
    hidden : sequence of Path
        What it may not read, even if that is part of Python's packages.

    Returns
    -------
    list of str
        The names of the mechanisms in effect.
    """
    mechanisms = []
    trees = [*_trees_of_python(hidden), *readable]
    if _set_limits(seconds, megabytes):
        mechanisms.append(LIMITS)
    if _become_other_user(folder):
        mechanisms.append(OTHER_USER)
    set_process_option(PR_SET_PDEATHSIG, signal.SIGKILL)
    if set_process_option(PR_SET_NO_NEW_PRIVS, 1):
        if restrict_files(folder, trees):
            mechanisms.append(LANDLOCK)
        if filter_system_calls():
            mechanisms.append(SECCOMP)
    return mechanisms


def set_process_option(option: int, value: int) -> bool:
    """`prctl`; whether the system has it and agreed."""
    try:
        return ctypes.CDLL(None).prctl(option, value, 0, 0, 0) == 0
    except (OSError, AttributeError, TypeError):  # not Linux
        return False


def _set_limits(seconds: float, megabytes: int) -> bool:
    """Set the limits as far as the system has them."""
    if resource is None:
        return False
    cpu = math.ceil(time.process_time() + seconds)
    limits = {
        "CPU": cpu,
        "AS": _mapped_bytes() + megabytes * 2**20,
        "NPROC": 0,
        "CORE": 0,
        "NOFILE": OPEN_FILES,
        "FSIZE": LARGEST_WRITTEN_FILE,
    }
    for name, limit in limits.items():
        # At its soft limit of processor time a process ends by a signal of its own.
        hard = limit + 1 if name == "CPU" else limit
        with suppress(ValueError, OSError, AttributeError):
            resource.setrlimit(getattr(resource, f"RLIMIT_{name}"), (limit, hard))
    return True


def _mapped_bytes() -> int:
    """The bytes of memory that this process has mapped; 0 where the system does not say."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        return 0


def _become_other_user(folder: Path) -> bool:
    """Give up root: become another user, or else keep the user without its capabilities."""
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        return False
    needed = [Path(os.__file__), Path(sys.modules["numpy"].__file__ or ""), folder.parent]
    if all(map(_is_open_to_all, needed)):
        with suppress(OSError):  # a namespace that has no such user
            os.chown(folder, NOBODY, NOBODY)
            os.setgroups([])
            os.setresgid(NOBODY, NOBODY, NOBODY)
            os.setresuid(NOBODY, NOBODY, NOBODY)
            return True
    header = struct.pack("Ii", CAPABILITY_VERSION, 0)
    with suppress(AttributeError):
        ctypes.CDLL(None).capset(header, bytes(24))
    return False


def _is_open_to_all(path: Path) -> bool:
    """Whether any user can reach a path and read there, by the modes of the folders above."""
    try:
        real = path.resolve()
        reachable = all(parent.stat().st_mode & 0o001 for parent in real.parents)
        return reachable and bool(real.stat().st_mode & (0o001 if real.is_dir() else 0o004))
    except OSError:
        return False


def landlock_version() -> int:
    """The version of Landlock of this kernel; 0 if there is none."""
    if sys.platform != "linux":
        return 0
    return max(0, ctypes.CDLL(None).syscall(CREATE_RULESET, None, ctypes.c_size_t(0), 1))


def has_filter() -> bool:
    """Whether this kernel has seccomp filters, and there is a list for this architecture."""
    if sys.platform != "linux" or platform.machine() not in ARCHITECTURES:
        return False
    return Path("/proc/sys/kernel/seccomp/actions_avail").exists()


def restrict_files(folder: Path, trees: Sequence[Path]) -> bool:
    """Let this process change files in a folder only, and read the folder and some trees.

    Returns whether the kernel could.
    """
    version = landlock_version()
    if version == 0:
        return False
    all_rights = (1 << RIGHTS_BY_VERSION[min(version, max(RIGHTS_BY_VERSION))]) - 1
    attributes = struct.pack("Q", all_rights)
    if version >= 4:
        attributes += struct.pack("Q", BOTH_TCP)
    if version >= 6:
        attributes += struct.pack("Q", BOTH_SCOPES)
    call = ctypes.CDLL(None).syscall
    rules = call(CREATE_RULESET, attributes, ctypes.c_size_t(len(attributes)), 0)
    if rules < 0:
        return False
    rights_in_folder = all_rights & ~EXECUTE
    for bit in SPECIAL_FILES:
        rights_in_folder &= ~(1 << bit)
    _allow(rules, folder, rights_in_folder)
    for tree in trees:
        _allow(rules, tree, READ_FILE | READ_FOLDER)
    _allow(rules, Path(os.devnull), READ_FILE | WRITE_FILE)
    is_restricted = call(RESTRICT_SELF, rules, 0) == 0
    os.close(rules)
    return is_restricted


def _allow(rules: int, path: Path, rights: int) -> None:
    """Add a rule that allows something below a path, if there is such a path."""
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return
    if not os.path.isdir(path):
        rights &= OF_FILES
    rule = struct.pack("=Qi", rights, place)
    ctypes.CDLL(None).syscall(ADD_RULE, rules, 1, rule, 0)
    os.close(place)


def _trees_of_python(hidden: Sequence[Path]) -> Iterator[Path]:
    """Where Python, its packages and the system's libraries are, without what is hidden."""
    places = [Path(sys.base_prefix), Path(sys.prefix), *map(Path, sys.path)]
    places += map(Path, ("/usr", "/lib", "/lib64", "/etc", "/dev/urandom", "/dev/random"))
    for place in places:
        if place.is_absolute() and place.exists():
            yield from _without(place.resolve(), [path.resolve() for path in hidden])


def _without(tree: Path, hidden: Sequence[Path]) -> Iterator[Path]:
    """The parts of a tree that have none of the hidden paths in them."""
    if tree in hidden:
        return
    if not any(tree in path.parents for path in hidden):
        yield tree
        return
    for part in tree.iterdir():
        if not part.is_symlink():
            yield from _without(part, hidden)


def filter_system_calls() -> bool:
    """Refuse every system call that is not listed; whether the kernel could."""
    if not has_filter():
        return False
    instructions = _filter_program(ARCHITECTURES[platform.machine()], os.getpid())
    code = b"".join(struct.pack("HBBI", *instruction) for instruction in instructions)
    memory = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("HxxxxxxQ", len(instructions), ctypes.addressof(memory))
    prctl = ctypes.CDLL(None).prctl
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, program, 0, 0) == 0


def _filter_program(architecture: int, process: int) -> list[Instruction]:
    """The filter: the listed calls are allowed, some with certain arguments only."""
    column = 1 if architecture == AARCH64 else 0
    numbers = {name: row[column] for name, row in (ALLOWED | CONDITIONAL).items()}
    program: list[Instruction] = [
        (LOAD, 0, 0, ARCHITECTURE_AT),
        (JUMP_IF_EQUAL, 1, 0, architecture),
        (RETURN, 0, 0, REFUSE),
        (LOAD, 0, 0, NUMBER_AT),
        (JUMP_IF_AT_LEAST, 0, 1, OF_X32),
        (RETURN, 0, 0, REFUSE),
    ]
    for name in ALLOWED:
        program += _for_call(numbers[name], [(RETURN, 0, 0, ALLOW)])
    program += _for_call(numbers["fcntl"], _unless(1, OWNERSHIP))
    program += _for_call(numbers["ioctl"], _if_one_of(1, QUESTIONS))
    program += _for_call(numbers["prlimit64"], _if_one_of(0, (0, process)))
    threads_only = [_load(0), (JUMP_IF_BITS, 0, 1, CLONE_THREAD)]
    threads_only += [(RETURN, 0, 0, ALLOW), (RETURN, 0, 0, REFUSE)]
    program += _for_call(numbers["clone"], threads_only)
    program += _for_call(numbers["clone3"], [(RETURN, 0, 0, ABSENT)])  # then clone is tried
    own_signals = [_load(0), (JUMP_IF_EQUAL, 1, 0, process), (RETURN, 0, 0, REFUSE)]
    own_signals += _unless(2, (signal.SIGKILL,))
    program += _for_call(numbers["tgkill"], own_signals)
    program.append((RETURN, 0, 0, REFUSE))
    return program


def _load(argument: int) -> Instruction:
    """Load the lower half of an argument of the call."""
    return (LOAD, 0, 0, ARGUMENTS_AT + 8 * argument)


def _for_call(number: int | None, block: list[Instruction]) -> list[Instruction]:
    """A block for one call, which other calls jump over."""
    if number is None:  # this architecture does not have it
        return []
    return [(JUMP_IF_EQUAL, 0, len(block), number), *block]


def _if_one_of(argument: int, values: Sequence[int]) -> list[Instruction]:
    """Allow the call if an argument has one of these values."""
    block = [_load(argument)]
    for value in values:
        block += [(JUMP_IF_EQUAL, 0, 1, value), (RETURN, 0, 0, ALLOW)]
    return [*block, (RETURN, 0, 0, REFUSE)]


def _unless(argument: int, values: Sequence[int]) -> list[Instruction]:
    """Allow the call unless an argument has one of these values."""
    block = [_load(argument)]
    for value in values:
        block += [(JUMP_IF_EQUAL, 0, 1, value), (RETURN, 0, 0, REFUSE)]
    return [*block, (RETURN, 0, 0, ALLOW)]


def names_of_mechanisms() -> list[str]:
    """The mechanisms that this system has, as far as can be said without using them."""
    names = []
    if resource is not None:
        names.append(LIMITS)
    if landlock_version():
        names.append(LANDLOCK)
    if has_filter():
        names.append(SECCOMP)
    return names
