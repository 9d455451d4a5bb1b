"""The Carnegie Mellon Graphics Lab Motion Capture Database, from its own site.

    subjects/02/02.asf, subjects/02/02_01.amc     a skeleton and its takes
    search.php?subjectnumber=2                    a page that links a subject's files

The site publishes no checksums, and the package has none. The first download of a file is therefore
only checked for having what every .asf or .amc file has (`SIGNS`); its SHA-256 is written to
`checksums.txt` in the folder. At the next run every file that is listed there is compared with its
checksum: one that is there and differs is kept, and one that is downloaded again and differs is not
written; both are errors. A teacher can give students this file, which has two columns, the name of
a file of the database and its checksum.
"""

import hashlib
import re
import time
from collections.abc import Sequence
from multiprocessing import TimeoutError as RanOut
from multiprocessing.pool import ThreadPool
from pathlib import Path

from numpy_cae.atomic_write import atomic_write, replacing
from numpy_cae.errors import NumpyCaeError
from numpy_cae.progress import ProgressLine, time_to_go

SITE = "http://mocap.cs.cmu.edu"
CHECKSUMS = "checksums.txt"
FILE_NAMES = re.compile(r"(\d{2,3})/\1(\.asf|_\d{2,3}\.amc)")
"""Names of files in the folder; no other file is written."""
SIGNS = {".asf": re.compile(rb"(?m)^\s*:root"), ".amc": re.compile(rb"(?m)^\s*root\s")}
"""What a skeleton and a take have; an answer without it is kept from being taken for the file."""
PAUSE = 0.2
"""Seconds before each request; the site asks not to be crawled."""
PATIENCE = 60.0
"""A download ends with an error if nothing arrives for this time (s)."""
MOST_BYTES = 100_000_000
"""A download ends with an error if a file or a page has more bytes than this."""
MOST_SECONDS = 1000.0
"""A download ends with an error if it takes longer (s): the largest file at 100 kB a second."""
PART_BYTES = 2**20
TERMS = """\
mocap.cs.cmu.edu says: "This data is free for use in research projects. You may include this data
in commercially-sold products, but you may not resell this data directly, even in converted form."
It asks to be acknowledged so: "The data used in this project was obtained from mocap.cs.cmu.edu.
The database was created with funding from NSF EIA-0196217."
"""


class DownloadError(NumpyCaeError):
    """A file that could not be downloaded."""


def download_cmu(
    folder: str | Path, subjects: Sequence[int], site: str = SITE, show_progress: bool = False
) -> list[Path]:
    """Download Acclaim files with pooch; files that the folder has are not downloaded again.

    Parameters
    ----------
    folder : path
        Gets `02/02.asf`, `02/02_01.amc`, … and `checksums.txt`; created if it does not exist.
    subjects : sequence of int
        Numbers of the subjects, 1 to 144.
    site : str
        Address of the site or of a mirror.
    show_progress : bool
        Show how many files are downloaded.

    Returns
    -------
    list of Path
        The .asf and .amc files.

    Raises
    ------
    DownloadError
        If pooch is not installed, the site does not have a file, or a file does not agree with its
        checksum.
    """
    try:
        import pooch
    except ImportError:
        raise DownloadError("pooch is missing: `pip install numpy_cae[download]`") from None
    folder = Path(folder)
    site = site.rstrip("/")
    downloads = pooch.create(folder, site, retry_if_failed=2)
    pooch.get_logger().setLevel("WARNING")
    try:
        downloads.urls = _addresses(site, subjects)
        downloads.registry = dict.fromkeys(downloads.urls) | _read_checksums(folder / CHECKSUMS)
        with ProgressLine() as line:
            for number, name in enumerate(downloads.urls):
                if show_progress:
                    to_go = time_to_go(line.seconds, number / len(downloads.urls))
                    line.show(f"{number} of {len(downloads.urls)} files{to_go}")
                if (folder / name).exists():
                    _require_checksum(folder / name, downloads.registry[name])
                else:
                    time.sleep(PAUSE)
                path = downloads.fetch(name, downloader=_download)
                downloads.registry[name] = downloads.registry[name] or pooch.file_hash(path)
    except (OSError, ValueError) as error:
        raise DownloadError(f"{site}: {error}") from None
    finally:
        _write_checksums(folder / CHECKSUMS, downloads.registry)
    return [folder / name for name in downloads.urls]


def _require_checksum(path: Path, checksum: str | None) -> None:
    """Raise ValueError if a file is not the one of its checksum: `pooch` would replace it."""
    if checksum is None:
        return
    if hashlib.sha256(path.read_bytes()).hexdigest() != checksum.removeprefix("sha256:"):
        advice = "remove the file, or its line there, to go on"
        raise ValueError(f"{path}: differs from its checksum in {CHECKSUMS}; {advice}")


def _download(url: str, output: str, registry: object) -> None:
    """Download a file; `pooch` calls this. ValueError if it is no Acclaim file."""
    received = _request(url)
    if received[:100].lstrip().startswith(b"<"):
        raise ValueError(f"{url}: is a web page (perhaps of a network to log in to)")
    if not received.strip():
        raise ValueError(f"{url}: the answer is empty; try again later")
    if b"\0" in received or not SIGNS[Path(url).suffix].search(received):
        raise ValueError(f"{url}: the answer is no {Path(url).suffix} file; try again later")
    Path(output).write_bytes(received)


def _request(url: str) -> bytes:
    """What is at an address; OSError or ValueError where it takes too long or is too large."""
    with ThreadPool(1) as threads:  # a thread that still downloads is not waited for
        try:
            return threads.apply_async(_read_answer, (url,)).get(MOST_SECONDS)
        except RanOut:
            raise OSError(f"{url}: not complete after {MOST_SECONDS:g} s") from None


def _read_answer(url: str) -> bytes:
    import requests  # which pooch needs

    received = b""
    with requests.get(url, timeout=PATIENCE, stream=True) as answer:
        answer.raise_for_status()
        for part in answer.iter_content(PART_BYTES):
            received += part
            if len(received) > MOST_BYTES:
                raise ValueError(f"a file or a page has more than {MOST_BYTES} bytes")
    return received


def _write_checksums(path: Path, checksums: dict[str, str | None]) -> None:
    """Write the checksums, unless none is known."""
    lines = [f"{name} {checksum}\n" for name, checksum in sorted(checksums.items()) if checksum]
    if lines:
        with replacing(True), atomic_write(path) as temporary:  # its lines are among these
            temporary.write_text("".join(lines), encoding="utf-8")


def _read_checksums(path: Path) -> dict[str, str | None]:
    """The checksums of known files; ValueError that names a line of another kind."""
    checksums: dict[str, str | None] = {}
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    for number, line in enumerate(lines, 1):
        name, _, checksum = line.partition(" ")
        if not FILE_NAMES.fullmatch(name) or not re.fullmatch(r"(sha256:)?[0-9a-f]{64}", checksum):
            expected = "expected a file of the database and its SHA-256"
            raise ValueError(f"{path}:{number}: {line[:60]!r}, {expected}")
        checksums[name] = checksum
    return checksums


def _addresses(site: str, subjects: Sequence[int]) -> dict[str, str]:
    """The files to download, by their names in the folder: a skeleton before its takes."""
    addresses = {}
    for subject in subjects:
        number = f"{subject:02d}"
        page = _request(f"{site}/search.php?subjectnumber={subject}").decode("latin-1").lower()
        takes = sorted(set(re.findall(rf"\b{number}_\d{{2,3}}\.amc", page)))
        if not takes:
            raise ValueError(f"there are no takes of subject {subject}")
        for name in (f"{number}.asf", *takes):
            addresses[f"{number}/{name}"] = f"{site}/subjects/{number}/{name}"
    return addresses
