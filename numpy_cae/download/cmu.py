"""The Carnegie Mellon Graphics Lab Motion Capture Database, as its site serves it.

    subjects/02/02.asf, subjects/02/02_01.amc     a skeleton and its takes
    search.php?subjectnumber=02                   a page that links a subject's files
    allasfamc.zip                                 all of them

The site asks not to be crawled, so the whole database is fetched as the one archive.
"""

from __future__ import annotations

import os
import re
import time
import urllib.parse
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from numpy_cae.download.archive import members, unpack
from numpy_cae.download.fetch import DownloadError, fetch
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
_FILE = re.compile(r"(?P<subject>\d{2,3})(?:_\d{2,3})?\.(?:asf|amc)", re.IGNORECASE)

Said = Callable[[str, int, "int | None"], None]


@dataclass
class Tally:
    """What came of a download.

    Attributes
    ----------
    new, known : int
        Files that came, and files that were there before.
    refused : list of str
        Files that came and do not parse, and why; none of them is in the folder.
    """

    new: int = 0
    known: int = 0
    refused: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class CmuSite:
    """Where to fetch from.

    Parameters
    ----------
    address : str
        Such as "http://mocap.cs.cmu.edu".
    pause : float
        Seconds between two requests, to be a polite guest.
    """

    address: str = SITE
    pause: float = 0.2

    def __post_init__(self):
        if urllib.parse.urlsplit(self.address).scheme not in ("http", "https"):
            raise ValueError(f"{self.address!r} is no address of a site, expected http://…")

    def url(self, path: str) -> str:
        return f"{self.address.rstrip('/')}/{path}"


def download_cmu(
    folder: str | Path,
    subjects: Sequence[int] | None = None,
    site: CmuSite | None = None,
    said: Said | None = None,
) -> Tally:
    """Fetch Acclaim files into `folder/02/02.asf`, `folder/02/02_01.amc`, …

    A file stands under its name only when it has come whole and parses; it is then never fetched
    again. What was cut off is continued by the next call.

    Parameters
    ----------
    folder : path
        Made if it is not there.
    subjects : sequence of int, optional
        By default the whole database, as one archive.
    site : CmuSite, optional
    said : (name, bytes so far, bytes in all or None) -> None, optional

    Raises
    ------
    DownloadError
        If something does not come, or the archive is damaged or has paths that leave the folder.
    MotionFileError
        If another process downloads into the folder.
    """
    folder, site, tally = Path(folder), site or CmuSite(), Tally()
    folder.mkdir(parents=True, exist_ok=True)
    said = said or (lambda name, done, total: None)
    with lock(folder / "download"):
        if subjects is None:
            _take_archive(folder, site, tally, said)
        else:
            for subject in subjects:
                _take_subject(folder, site, f"{subject:02d}", tally, said)
    return tally


def _take_subject(folder: Path, site: CmuSite, subject: str, tally: Tally, said: Said) -> None:
    place = _place(folder, subject)
    page = place / ".page.part"
    page.unlink(missing_ok=True)
    fetch(site.url(f"search.php?subjectnumber={int(subject)}"), page, pause=site.pause)
    names = _named(page.read_text(encoding="latin-1"), subject)
    page.unlink()
    if not any(name.endswith(".amc") for name in names):
        raise DownloadError(f"{site.address}: names no takes of subject {int(subject)}")
    # The skeleton first: the takes are read with it.
    for name in [f"{subject}.asf", *(name for name in names if name.endswith(".amc"))]:
        if (place / name).exists():
            tally.known += 1
            continue
        part = place / f".{name}.part"
        time.sleep(site.pause)
        fetch(
            site.url(f"subjects/{subject}/{name}"),
            part,
            lambda done, total, name=name: said(name, done, total),
            site.pause,
        )
        _settle(part, place / name, tally)


def _named(page: str, subject: str) -> list[str]:
    """The files of the subject that a page links, in order."""
    found = {match.group().lower() for match in _FILE.finditer(page)}
    return sorted(name for name in found if _FILE.fullmatch(name)["subject"] == subject)


def _take_archive(folder: Path, site: CmuSite, tally: Tally, said: Said) -> None:
    path = folder / ARCHIVE
    if not path.exists():
        part = folder / f".{ARCHIVE}.part"
        fetch(site.url(ARCHIVE), part, lambda done, total: said(ARCHIVE, done, total), site.pause)
        if not zipfile.is_zipfile(part):
            part.unlink()
            raise DownloadError(f"{site.url(ARCHIVE)}: what came is no zip archive")
        os.replace(part, path)
    try:
        with zipfile.ZipFile(path) as archive:
            for name, part in _unpacked(archive, folder, tally):
                said(name, 0, None)
                _settle(part, _place(folder, _FILE.fullmatch(name)["subject"]) / name, tally)
    except zipfile.BadZipFile as error:
        path.unlink()
        raise DownloadError(f"{path}: {error}; it was removed, to be fetched again") from None


def _unpacked(archive: zipfile.ZipFile, folder: Path, tally: Tally) -> Iterator[tuple[str, Path]]:
    """The Acclaim files that the folder lacks, skeletons first."""
    missing = []
    for info in members(archive, _FILE):
        name = Path(info.filename).name
        if (folder / _FILE.fullmatch(name)["subject"] / name).exists():
            tally.known += 1
        else:
            missing.append(info)
    return unpack(archive, sorted(missing, key=lambda info: not _is_skeleton(info)), folder)


def _is_skeleton(info: zipfile.ZipInfo) -> bool:
    return info.filename.lower().endswith(".asf")


def _place(folder: Path, subject: str) -> Path:
    """The folder of a subject, which must lie where its name says: no link leads elsewhere."""
    place = folder / subject
    place.mkdir(exist_ok=True)
    if place.is_symlink() or not place.resolve().is_relative_to(folder.resolve()):
        raise DownloadError(f"{place}: is a link to another place, expected a folder of its own")
    return place


def _settle(part: Path, path: Path, tally: Tally) -> None:
    """Read the part as what it is to be; into its place if that works, else away with it.

    Acclaim does not say how many frames there are. A server that promises too few bytes is noticed
    by a last line without an end or a frame that is not whole.
    """
    try:
        if not part.read_bytes()[-1:] == b"\n":
            raise MotionFileError(part, None, "its last line has no end: is it cut off?")
        if path.suffix.lower() == ".asf":
            read_asf(part)
        else:
            read_amc(part, path.parent / f"{path.stem.split('_')[0]}.asf")
    except MotionFileError as error:
        part.unlink()
        where = "" if error.line is None else f" line {error.line}:"
        # The skeleton can be the one that is at fault.
        culprit = path.name if error.path == part else f"{path.name} ({error.path.name})"
        tally.refused.append(f"{culprit}:{where} {error.problem}")
        return
    os.replace(part, path)
    tally.new += 1
