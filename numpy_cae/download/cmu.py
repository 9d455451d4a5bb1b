"""The Carnegie Mellon Graphics Lab Motion Capture Database, from its own site.

    subjects/02/02.asf, subjects/02/02_01.amc     a skeleton and its takes
    search.php?subjectnumber=02                   a page that links a subject's files
    allasfamc.zip                                 all of them

The site asks not to be crawled, so the whole database is downloaded as one archive.
"""

import os
import re
import shutil
import time
import urllib.parse
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from numpy_cae.download.fetch import MAX_BYTES, DownloadError, fetch
from numpy_cae.lock import lock
from numpy_cae.motion import MotionFileError, read_amc, read_asf

SITE = "http://mocap.cs.cmu.edu"
ARCHIVE = "allasfamc.zip"
TERMS = """\
mocap.cs.cmu.edu says: "This data is free for use in research projects. You may include this data
in commercially-sold products, but you may not resell this data directly, even in converted form."
It asks to be acknowledged so: "The data used in this project was obtained from mocap.cs.cmu.edu.
The database was created with funding from NSF EIA-0196217."
"""
MAX_FILE_BYTES = 1 << 26
"""Twice the longest take of the CMU database."""
MAX_EXPANSION, FREE_BYTES = 50, 1 << 20
"""A member, and all wanted ones together, may unpack to so many times their packed size; motions
pack to a fourth. What is below `FREE_BYTES` does no harm."""
MAX_PAGE = 4_000_000
"""Bytes of a page that links a subject's files."""
_FILE = re.compile(r"(?P<subject>\d{2,3})(?:_\d{2,3})?\.(?:asf|amc)", re.IGNORECASE)

Progress = Callable[[str, int, "int | None"], None]
"""Called with a file's name, its bytes so far, and its bytes in all, None if unknown."""


@dataclass
class Tally:
    """The numbers of files that are new and that were known before; and the reasons for which
    others, which are not kept, cannot be read."""

    new: int = 0
    known: int = 0
    refused: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class CmuSite:
    """The site's address, and the seconds between two requests, which limit the server's load."""

    address: str = SITE
    pause: float = 0.2

    def __post_init__(self):
        if urllib.parse.urlsplit(self.address).scheme not in ("http", "https"):
            raise ValueError(f"{self.address!r} is not the address of a site, expected http://…")

    def fetch(
        self, path: str, part: Path, name: str, progress: Progress, most: int = MAX_FILE_BYTES
    ) -> None:
        """Download one file of the site, of at most so many bytes, into `part`."""
        time.sleep(self.pause)
        url = f"{self.address.rstrip('/')}/{path}"
        fetch(url, part, lambda done, total: progress(name, done, total), self.pause, most)


def download_cmu(
    folder: str | Path,
    subjects: Sequence[int] | None = None,
    site: CmuSite | None = None,
    progress: Progress | None = None,
) -> Tally:
    """Download Acclaim files into `folder/02/02.asf`, `folder/02/02_01.amc`, …, by default all.

    A file gets its name only when it is complete and can be read; it is then never downloaded
    again. An interrupted download is continued by the next call.

    Raises DownloadError if a download fails, or the archive is damaged or has paths that leave the
    folder; FileError if another process downloads into the folder.
    """
    folder, site = Path(folder), site or CmuSite()
    progress = progress or (lambda name, done, total: None)
    folder.mkdir(parents=True, exist_ok=True)
    tally = Tally()
    with lock(folder / "download"):
        if subjects is None:
            _download_archive(folder, site, tally, progress)
        for subject in subjects or ():
            _download_subject(folder, site, f"{subject:02d}", tally, progress)
    return tally


def _download_subject(
    folder: Path, site: CmuSite, subject: str, tally: Tally, progress: Progress
) -> None:
    page = folder / ".page.part"
    page.unlink(missing_ok=True)
    try:
        address = f"search.php?subjectnumber={int(subject)}"
        site.fetch(address, page, "", lambda *_: None, MAX_PAGE)
        linked = _FILE.finditer(page.read_text(encoding="latin-1"))
    finally:
        page.unlink(missing_ok=True)
    names = {match.group().lower() for match in linked if match["subject"] == subject}
    takes = sorted(name for name in names if name.endswith(".amc"))
    if not takes:
        raise DownloadError(f"{site.address}: has no takes of subject {int(subject)}")
    target = _subject_folder(folder, subject)
    for name in [f"{subject}.asf", *takes]:  # the takes are read with the skeleton
        if (target / name).exists():
            tally.known += 1
            continue
        part = target / f".{name}.part"
        site.fetch(f"subjects/{subject}/{name}", part, name, progress)
        _accept(part, target / name, tally)


def _download_archive(folder: Path, site: CmuSite, tally: Tally, progress: Progress) -> None:
    path = folder / ARCHIVE
    if not path.exists():
        part = folder / f".{ARCHIVE}.part"
        site.fetch(ARCHIVE, part, ARCHIVE, progress, MAX_BYTES)
        if not zipfile.is_zipfile(part):
            part.unlink()
            raise DownloadError(f"{site.address}/{ARCHIVE}: the received file is no zip archive")
        os.replace(part, path)
    try:
        with zipfile.ZipFile(path) as archive:
            members = find_members(archive, _FILE)
            missing = {}
            for name in sorted(members, key=lambda name: not name.lower().endswith(".asf")):
                if (folder / _FILE.fullmatch(name)["subject"] / name).exists():
                    tally.known += 1
                else:
                    missing[name] = members[name]
            for name, part in extract(archive, missing, folder):
                progress(name, 0, None)
                target = _subject_folder(folder, _FILE.fullmatch(name)["subject"])
                _accept(part, target / name, tally)
    except zipfile.BadZipFile as error:
        path.unlink()
        raise DownloadError(f"{path}: {error}; it was removed, run the command again") from None


def _subject_folder(folder: Path, subject: str) -> Path:
    """The folder of a subject, which may not be a link to another one."""
    path = folder / subject
    path.mkdir(exist_ok=True)
    if path.is_symlink() or not path.resolve().is_relative_to(folder.resolve()):
        raise DownloadError(f"{path}: is a link, expected a folder")
    return path


def _accept(part: Path, path: Path, tally: Tally) -> None:
    """Rename the part to `path` if it can be read as that file, otherwise remove it.

    Acclaim does not state the number of frames. A truncated file is recognised by a last line
    without a line end or by an incomplete frame.
    """
    try:
        if part.read_bytes()[-1:] != b"\n":
            raise MotionFileError(part, None, "its last line has no end: is it truncated?")
        if path.suffix.lower() == ".asf":
            read_asf(part)
        else:
            read_amc(part, path.parent / f"{path.stem.split('_')[0]}.asf")
    except MotionFileError as error:
        part.unlink()
        where = "" if error.line is None else f" line {error.line}:"
        # The skeleton may be the file that is damaged.
        name = path.name if error.path == part else f"{path.name} ({error.path.name})"
        tally.refused.append(f"{name}:{where} {error.problem}")
        return
    os.replace(part, path)
    tally.new += 1


def find_members(archive: zipfile.ZipFile, wanted: re.Pattern) -> dict[str, zipfile.ZipInfo]:
    """The members of a zip archive whose file name matches, by file name.

    Names in an archive are not trusted: `../../.bashrc` or an absolute path would be written
    outside the folder ("zip slip"). Of an archive with such a name nothing is extracted.

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
