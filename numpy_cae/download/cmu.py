"""The Carnegie Mellon Graphics Lab Motion Capture Database, from its own site.

    subjects/02/02.asf, subjects/02/02_01.amc     a skeleton and its takes
    search.php?subjectnumber=2                    a page that links a subject's files
    allasfamc.zip                                 all of them

The site publishes no checksums. The first download of a file is therefore not checked; its SHA-256
is written to `checksums.txt` in the folder. Every file that is listed there is compared with its
checksum when it is used or downloaded again. A teacher can give students this file.
"""

import re
import time
import urllib.request
import zipfile
from collections.abc import Sequence
from http.client import HTTPException
from pathlib import Path
from urllib.error import HTTPError

from numpy_cae.errors import NumpyCaeError

SITE = "http://mocap.cs.cmu.edu"
ARCHIVE = "allasfamc.zip"
CHECKSUMS = "checksums.txt"
PAUSE = 0.2
"""PAUSE: seconds before each request; the site asks not to be crawled."""
TERMS = """\
mocap.cs.cmu.edu says: "This data is free for use in research projects. You may include this data
in commercially-sold products, but you may not resell this data directly, even in converted form."
It asks to be acknowledged so: "The data used in this project was obtained from mocap.cs.cmu.edu.
The database was created with funding from NSF EIA-0196217."
"""


class DownloadError(NumpyCaeError):
    """A file that could not be downloaded."""


def download_cmu(
    folder: str | Path,
    subjects: Sequence[int] | None = None,
    site: str = SITE,
    show_progress: bool = False,
) -> list[Path]:
    """Download Acclaim files with pooch; files that the folder has are not downloaded again.

    Parameters
    ----------
    folder : path
        Gets `02/02.asf`, `02/02_01.amc`, … and `checksums.txt`; created if it does not exist.
    subjects : sequence of int, optional
        Numbers of the subjects. By default the archive of all, which is unpacked in `folder`.
    site : str
        Address of the site or of a mirror.
    show_progress : bool
        Show a progress bar for each file, which needs tqdm.

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
        advice = "downloads need pooch: install it with `pip install numpy_cae[download]`"
        raise DownloadError(advice) from None
    folder, site = Path(folder), site.rstrip("/")
    checksums = folder / CHECKSUMS
    downloads = pooch.create(folder, site, retry_if_failed=2)
    if not show_progress:
        pooch.get_logger().setLevel("WARNING")
    files: list[str] = []
    try:
        for name, address in _addresses(site, subjects).items():
            downloads.registry[name], downloads.urls[name] = None, address
        if checksums.exists():
            downloads.load_registry(checksums)
        for name in downloads.urls:
            path = folder / name
            if not path.exists():
                time.sleep(PAUSE)
            unzip = pooch.Unzip(extract_dir=".") if name == ARCHIVE else None
            fetched = downloads.fetch(name, unzip, progressbar=show_progress)
            files += fetched if unzip else [fetched]
            if downloads.registry[name] is None:
                downloads.registry[name] = f"sha256:{pooch.file_hash(path)}"
    except (OSError, ValueError, HTTPException, zipfile.BadZipFile) as error:
        if isinstance(error, HTTPError):
            error.close()  # it holds the connection open
        raise DownloadError(f"{site}: {error}") from None
    finally:
        known = {name: checksum for name, checksum in downloads.registry.items() if checksum}
        if known:
            lines = [f"{name} {checksum}" for name, checksum in sorted(known.items())]
            checksums.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return [Path(file) for file in files if file.lower().endswith((".asf", ".amc"))]


def _addresses(site: str, subjects: Sequence[int] | None) -> dict[str, str]:
    """The files to download, by their names in the folder: a skeleton before its takes."""
    if subjects is None:
        return {ARCHIVE: f"{site}/{ARCHIVE}"}
    addresses = {}
    for subject in subjects:
        number = f"{subject:02d}"
        with urllib.request.urlopen(f"{site}/search.php?subjectnumber={subject}") as answer:
            page = answer.read().decode("latin-1").lower()
        takes = sorted(set(re.findall(rf"\b{number}_\d{{2,3}}\.amc", page)))
        if not takes:
            raise ValueError(f"there are no takes of subject {subject}")
        for name in (f"{number}.asf", *takes):
            addresses[f"{number}/{name}"] = f"{site}/subjects/{number}/{name}"
    return addresses
