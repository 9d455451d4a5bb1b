"""Write a file completely or not at all, and never in place of one that is still needed.

A file that is half written when the disk fills up or the process is killed must never replace a
good one. So the file is written under a temporary name in the same folder, brought to the disk
(fsync) and then renamed, which the operating system does in one step. A process that is killed
while it writes leaves the temporary file, `.NAME.PROCESS.part.SUFFIX`, which the next writing of
the same file removes.

A link is followed: the file that it leads to is written. The new file has the mode and the owner of
the one that it replaces. What is no regular file (a pipe, a device) is refused.

The commands write inside of `replacing(False)`, unless the user gives --overwrite. There a file
that exists is only replaced if nothing is lost: if it is empty, if it has the bytes that are to be
written, or if it is a page that this program made (`stamped`) and nobody has edited, and the new
file is a page, too. So no output replaces a motion that the same command reads, a file of another
kind, or a list that the user has corrected. A command that knows more about a file writes it inside
of `replacing(True)`: a repair replaces an earlier repair of the same motion.
"""

import filecmp
import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from numpy_cae.errors import FileError

LONGEST_NAME = 50
"""The temporary name has at most this many characters of the name: systems allow 255 bytes in
all."""
STAMP = "<!-- made by numpy-cae; the SHA-256 of the text above is {} -->\n"
"""The last line of a page, by which a page that was edited is known."""
_may_replace = ContextVar("may_replace", default=True)
"""Whether files that exist are replaced in any case."""


@contextmanager
def replacing(is_allowed: bool) -> Iterator[None]:
    """Set for a block whether `atomic_write` replaces every file that exists, or only where nothing
    is lost."""
    token = _may_replace.set(is_allowed)
    try:
        yield
    finally:
        _may_replace.reset(token)


@contextmanager
def atomic_write(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path to write to, of the same suffix; rename it to `path` at the end.

    If the block raises an exception, `path` is unchanged and the temporary file is removed.

    Raises
    ------
    FileError
        If the folder of `path` is missing, `path` is a folder or no regular file, writing fails, or
        a file that exists may not be replaced (see `replacing`).
    """
    path = Path(path)
    require_place(path)
    target = Path(os.path.realpath(path))
    begin = f".{path.stem[:LONGEST_NAME]}."
    end = f".part{path.suffix}"
    temporary = target.with_name(f"{begin}{os.getpid()}{end}")
    try:
        _remove_leftovers(target.parent, begin, end)
        before = target.stat() if target.exists() else None
        if before:
            # Nobody else may read the new file before it has the mode of the old one.
            temporary.touch(mode=0o600)
        yield temporary
        _require_nothing_lost(path, temporary)
        if before:
            _copy_owner_and_mode(before, temporary)
        with temporary.open("r+b") as file:
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except OSError as error:
        raise FileError(path, None, f"cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def require_place(path: Path) -> None:
    """Raise FileError if the folder of `path` is missing, or `path` is a folder, a pipe, a device
    or a link to nowhere."""
    # os.path returns False for names that are too long, where pathlib raises.
    if os.path.isdir(path):
        raise FileError(path, None, "cannot be written: there is a folder of this name")
    if os.path.exists(path) and not os.path.isfile(path):
        raise FileError(path, None, "cannot be written: is no regular file, but a pipe or a device")
    target = os.path.realpath(path)
    if os.path.islink(target):
        raise FileError(path, None, "cannot be written: is a link that leads to itself")
    folder = os.path.dirname(target)
    if not os.path.isdir(folder):
        where = folder if os.path.islink(path) else path.parent
        raise FileError(path, None, f"cannot be written: there is no folder {where}")


def make_folder(path: Path) -> None:
    """Make a folder, and those above it, if it is not there; FileError if it cannot be made."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise FileError(path, None, "is a file, expected a folder") from None
    except OSError as error:
        raise FileError(path, None, f"cannot be made: {error.strerror}") from error


def require_free(path: Path) -> None:
    """Raise FileError if there is no place for `path`, or a file that may not be replaced and is
    not empty: for work that is too long to be refused at its end."""
    require_place(path)
    if not _may_replace.get() and path.exists() and path.stat().st_size:
        raise _exists_error(path)


def stamped(page: str) -> str:
    """The text of a page, HTML or Markdown, with a last line by which an edited page is known."""
    page = page.removesuffix("\n") + "\n"
    return page + STAMP.format(hashlib.sha256(page.encode()).hexdigest())


def is_unedited_page(path: Path) -> bool:
    """Whether a file is a page that `stamped` made and nobody has edited."""
    content = path.read_bytes()
    text = content[: -len(STAMP.format("0" * 64))]
    return content == text + STAMP.format(hashlib.sha256(text).hexdigest()).encode()


def _require_nothing_lost(path: Path, new: Path) -> None:
    """Raise FileError if the new file may not replace the one at `path`."""
    if _may_replace.get() or not path.exists() or path.stat().st_size == 0:
        return
    if filecmp.cmp(path, new, shallow=False):
        return
    if is_unedited_page(path) and is_unedited_page(new):
        return
    raise _exists_error(path)


def _exists_error(path: Path) -> FileError:
    return FileError(path, None, "exists and has other contents; --overwrite replaces it")


def _copy_owner_and_mode(before: os.stat_result, new: Path) -> None:
    """Give a file the owner, as far as the user may, and the mode of the one that it replaces."""
    if hasattr(os, "chown"):
        with suppress(PermissionError):
            os.chown(new, before.st_uid, before.st_gid)
    os.chmod(new, stat.S_IMODE(before.st_mode))


def _remove_leftovers(folder: Path, begin: str, end: str) -> None:
    """Remove the temporary files of these names whose process has ended."""
    for name in os.listdir(folder):
        process = name[len(begin) : -len(end)]
        if name == f"{begin}{process}{end}" and process.isdecimal() and has_ended(int(process)):
            with suppress(OSError):
                (folder / name).unlink()


def has_ended(process: int) -> bool:
    """Whether no process has this number; False where that cannot be asked (Windows)."""
    if os.name != "posix":
        return False
    try:
        os.kill(process, 0)
    except (OSError, OverflowError) as error:
        return not isinstance(error, PermissionError)  # which a process of another user raises
    return False
