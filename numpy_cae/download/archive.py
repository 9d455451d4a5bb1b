"""Extract a zip archive into one folder.

Names in an archive are not trusted: `../../.bashrc` or an absolute path would be written outside
the folder ("zip slip"). Of an archive with such a name nothing is extracted.
"""

import os
import re
import shutil
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from numpy_cae.download.fetch import DownloadError

MAX_FILE_BYTES = 1 << 26
"""Twice the longest take of the CMU database."""
MAX_EXPANSION, FREE_BYTES = 50, 1 << 20
"""A member, and all wanted ones together, may unpack to so many times their packed size; motions
pack to a fourth. What is below `FREE_BYTES` does no harm."""


def find_members(archive: zipfile.ZipFile, wanted: re.Pattern) -> dict[str, zipfile.ZipInfo]:
    """The members whose file name matches, by file name.

    Raises BadZipFile if any name leaves the folder, a wanted member is too large or unpacks to
    implausibly many bytes, or none is wanted.
    """
    found = {}
    for info in archive.infolist():
        name = info.filename.replace("\\", "/")
        path = PurePosixPath(name)
        problem = None
        if path.is_absolute() or ".." in path.parts or re.match(r"[A-Za-z]:", name):
            problem = "is a path that leaves the folder"
        elif not info.is_dir() and wanted.fullmatch(path.name):
            if info.file_size > MAX_FILE_BYTES:
                problem = f"has {info.file_size} bytes, expected at most {MAX_FILE_BYTES}"
            elif _expands(info.file_size, info.compress_size):
                problem = f"unpacks to more than {MAX_EXPANSION} times its size"
            found[path.name] = info
        if problem is not None:
            raise zipfile.BadZipFile(f"{info.filename!r} {problem}; nothing was extracted")
    packed = os.path.getsize(archive.filename or "")
    if not found:
        raise zipfile.BadZipFile("holds no motion file")
    if _expands(sum(info.file_size for info in found.values()), packed):
        raise zipfile.BadZipFile(f"unpacks to more than {MAX_EXPANSION} times its size")
    return found


def _expands(size: int, packed: int) -> bool:
    return size > FREE_BYTES + MAX_EXPANSION * packed


def extract(
    archive: zipfile.ZipFile, members: dict[str, zipfile.ZipInfo], folder: Path
) -> Iterator[tuple[str, Path]]:
    """Extract each member to a temporary file in `folder`; yield its name and the file.

    Raises DownloadError if the disk is too small for all, BadZipFile if a member is damaged.
    """
    needed = sum(info.file_size for info in members.values())
    free = shutil.disk_usage(folder).free
    if needed > free:
        raise DownloadError(f"{folder}: needs {needed / 1e9:.1f} GB, {free / 1e9:.1f} are free")
    for name, info in members.items():
        part = folder / f".{name}.part"
        try:
            with archive.open(info) as packed, open(part, "wb") as file:
                shutil.copyfileobj(packed, file)
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError):
            part.unlink(missing_ok=True)
            raise zipfile.BadZipFile(f"{info.filename!r} is damaged") from None
        yield name, part
