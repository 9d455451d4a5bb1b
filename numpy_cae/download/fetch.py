"""One file from a web server, whole: what was cut off is continued where it was cut off.

What has come so far stands in a part beside the file's place, `.NAME.part`, and outlives the
program: the next run goes on from there. It asks for the last few kilobytes again and compares
them, so that nothing is glued to the beginning of another version of the file.
"""

from __future__ import annotations

import http.client
import os
import re
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path

from numpy_cae.errors import NumpyCaeError

CHUNK = 1 << 16
OVERLAP = 4096
"""Bytes that are asked for again, to see that the file is still the one that was begun."""
TIMEOUT = 30.0
"""Seconds without a byte after which a connection counts as cut."""
TRIES = 5
"""In a row that bring nothing before it is given up."""


class DownloadError(NumpyCaeError, OSError):
    """A file that did not come, or not whole."""


class _Cut(Exception):
    """The connection ended early; what has come is kept."""


class _Changed(Exception):
    """What has come does not belong to what the server has: begin again."""


def fetch(
    url: str,
    part: str | Path,
    said: Callable[[int, int | None], None] | None = None,
    pause: float = 1.0,
) -> None:
    """Bring a file into `part`, going on from what is there.

    Parameters
    ----------
    url : str
    part : path
        Whole when the function returns; moving it into its place is the caller's.
    said : (bytes so far, bytes in all or None) -> None, optional
        Called as bytes come in.
    pause : float
        Seconds before a second try, doubled with each after it.

    Raises
    ------
    DownloadError
        If the server has no such file, or `TRIES` tries in a row brought nothing.
    """
    part = Path(part)
    fruitless = begun_again = 0
    while True:
        before = _size(part)
        try:
            return _go_on(url, part, said or (lambda done, total: None))
        except urllib.error.HTTPError as error:
            if error.code < 500:
                raise DownloadError(f"{url}: the server says {error.code} {error.reason}") from None
            reason = f"the server says {error.code} {error.reason}"
        except _Changed as error:
            part.unlink(missing_ok=True)
            begun_again += 1
            reason = str(error)
        except (_Cut, urllib.error.URLError, http.client.HTTPException, TimeoutError) as error:
            reason = str(getattr(error, "reason", error))
        except ConnectionError as error:
            reason = error.strerror or "the connection was cut"
        fruitless = 0 if _size(part) > before else fruitless + 1
        # A server that contradicts itself would be asked for ever.
        if TRIES in (fruitless, begun_again):
            raise DownloadError(
                f"{url}: {reason}; {TRIES} tries brought nothing more. What has come is kept: run "
                "the command again to go on"
            )
        time.sleep(pause * 2 ** max(0, fruitless - 1))


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0


def _go_on(url: str, part: Path, said: Callable[[int, int | None], None]) -> None:
    """One request, from where the part ends, to its end."""
    there = _size(part)
    start = max(0, there - OVERLAP)
    # Compressed on the way, its bytes could be neither counted nor continued.
    headers = {"Accept-Encoding": "identity"}
    if there:
        headers["Range"] = f"bytes={start}-"
    request = urllib.request.Request(url, headers=headers)
    try:
        answer = urllib.request.urlopen(request, timeout=TIMEOUT)
    except urllib.error.HTTPError as error:
        if error.code == 416:
            raise _Changed("the server's file is shorter than what has come") from None
        raise
    with answer:
        length = _whole_number(answer.headers.get("Content-Length"))
        if answer.status == 206:
            total = _check_range(answer.headers.get("Content-Range", ""), start, length)
        else:  # 200: a server that knows no ranges sends everything
            start, total = 0, length
        with open(part, "r+b" if there else "w+b") as file:
            file.seek(start)
            _copy(answer, file, start, there, total, said)
    if total is not None and _size(part) != total:
        if _size(part) > total:
            raise _Changed(f"{_size(part)} bytes came where {total} were promised")
        raise _Cut(f"{_size(part)} of {total} bytes came")


def _copy(answer, file, at: int, there: int, total: int | None, said) -> None:
    """Bytes into the file; those below `there` are compared with what the file has."""
    while True:
        # read1 hands over what has come; read would lose it where the rest never comes.
        chunk = answer.read1(CHUNK)
        if not chunk:
            break
        known = min(len(chunk), max(0, there - at))
        if known and file.read(known) != chunk[:known]:
            raise _Changed("the server's file is another one than what has come")
        file.seek(at + known)
        file.write(chunk[known:])
        at += len(chunk)
        file.seek(at)
        said(max(at, there), total)
    file.flush()
    os.fsync(file.fileno())


def _check_range(text: str, start: int, length: int | None) -> int:
    """The size of the whole file, from `bytes START-END/TOTAL`."""
    match = re.fullmatch(r"bytes (\d+)-(\d+)/(\d+)", text.strip())
    if match is None:
        raise _Changed(f"the server sent a part and does not say which ({text!r})")
    first, last, total = map(int, match.groups())
    if first != start or not first <= last < total or length not in (None, last - first + 1):
        raise _Changed(f"the server sent bytes {text!r}, asked for {start} onwards")
    return total


def _whole_number(text: str | None) -> int | None:
    return int(text) if text is not None and text.isdecimal() else None
