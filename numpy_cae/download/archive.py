"""A zip archive into a folder and nowhere else.

A name inside an archive is a stranger's: `../../.bashrc` climbs out of the folder, and so does an
absolute one ("zip slip"). Nothing of such an archive is unpacked.
"""

from __future__ import annotations

import re
import shutil
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from numpy_cae.download.fetch import DownloadError

LARGEST = 1 << 28
"""Bytes of one file, unpacked: ten times the longest take of the CMU database."""


def members(archive: zipfile.ZipFile, wanted: re.Pattern) -> list[zipfile.ZipInfo]:
    """The members whose last name matches, every name of the archive having been looked at.

    Raises
    ------
    DownloadError
        If a name leaves the folder, or a wanted member says that it is larger than `LARGEST`.
    """
    chosen = []
    for info in archive.infolist():
        name = info.filename.replace("\\", "/")
        path = PurePosixPath(name)
        if path.is_absolute() or ".." in path.parts or re.match(r"[A-Za-z]:", name):
            raise DownloadError(
                f"{archive.filename}: holds {info.filename!r}, a path that leaves the folder; "
                "nothing of it was unpacked"
            )
        if not info.is_dir() and wanted.fullmatch(path.name):
            if info.file_size > LARGEST:
                raise DownloadError(
                    f"{archive.filename}: {info.filename!r} says that it is {info.file_size} "
                    f"bytes, expected at most {LARGEST}; nothing was unpacked"
                )
            chosen.append(info)
    return chosen


def unpack(
    archive: zipfile.ZipFile, infos: list[zipfile.ZipInfo], folder: Path
) -> Iterator[tuple[str, Path]]:
    """Each member in turn as a part in `folder`: its own name and the part, for the caller to
    check, move or remove.

    Raises
    ------
    DownloadError
        If the disk has no room for all of them.
    zipfile.BadZipFile
        If a member is damaged.
    """
    needed, free = sum(info.file_size for info in infos), shutil.disk_usage(folder).free
    if needed > free:
        raise DownloadError(
            f"{folder}: {needed / 1e9:.1f} GB are needed, the disk has {free / 1e9:.1f}"
        )
    for info in infos:
        name = PurePosixPath(info.filename.replace("\\", "/")).name
        part = folder / f".{name}.part"
        try:
            with archive.open(info) as packed, open(part, "wb") as file:
                shutil.copyfileobj(packed, file)
        except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError):
            part.unlink(missing_ok=True)
            raise zipfile.BadZipFile(f"{info.filename!r} is damaged") from None
        yield name, part
