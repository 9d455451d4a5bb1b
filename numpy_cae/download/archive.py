"""Extract a zip archive into one folder.

Names in an archive are not trusted: `../../.bashrc` or an absolute path would be written outside
the folder ("zip slip"). Of an archive with such a name nothing is extracted.
"""

from __future__ import annotations

import re
import shutil
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from numpy_cae.download.fetch import DownloadError

MAX_FILE_BYTES = 1 << 28
"""Ten times the longest take of the CMU database."""


def find_members(archive: zipfile.ZipFile, wanted: re.Pattern) -> dict[str, zipfile.ZipInfo]:
    """The members whose file name matches, by file name.

    Raises DownloadError if any name leaves the folder or a wanted member is too large.
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
            found[path.name] = info
        if problem is not None:
            name = f"{archive.filename}: {info.filename!r}"
            raise DownloadError(f"{name} {problem}; nothing was extracted")
    return found


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
