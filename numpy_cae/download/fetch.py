"""One complete file from a web server; an interrupted download is continued.

The received bytes are kept in a file `.NAME.part`, also when the program ends, and the next call
continues there. It requests the last few kilobytes again and compares them, so that parts of two
versions of a file are never joined.
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
from typing import BinaryIO

from numpy_cae.errors import NumpyCaeError

CHUNK = 1 << 16
OVERLAP = 4096
"""Bytes that are requested again, to check that the server still has the same file."""
TIMEOUT = 30.0
"""Seconds without a byte after which a connection counts as broken."""
MAX_FAILURES = 5
"""Attempts in a row without a new byte."""

Progress = Callable[[int, "int | None"], None]
"""Called with the bytes so far and the bytes in all, None if unknown."""


class DownloadError(NumpyCaeError):
    """A file that could not be downloaded completely."""


class _Interrupted(Exception):
    """The connection ended early; the received bytes are kept."""


class _Changed(Exception):
    """The received bytes do not belong to the server's file: start again."""


def fetch(url: str, part: str | Path, progress: Progress | None = None, pause: float = 1.0) -> None:
    """Download a file into `part`, continuing after the bytes that it has.

    `part` is complete when the function returns; the caller renames it. `pause` is the time in
    seconds before the second attempt, doubled with each further one.

    Raises
    ------
    DownloadError
        If the server does not have the file, or `MAX_FAILURES` attempts in a row brought nothing.
    """
    part = Path(part)
    failures = restarts = 0
    while True:
        before = _size(part)
        try:
            return _request(url, part, progress or (lambda done, total: None))
        except urllib.error.HTTPError as error:
            reason = f"the server answers {error.code} {error.reason}"
            if error.code == 416:  # the server's file is shorter than the received bytes
                part.unlink()
                restarts += 1
            elif error.code < 500:
                raise DownloadError(f"{url}: {reason}") from None
        except _Changed as error:
            part.unlink(missing_ok=True)
            restarts += 1
            reason = str(error)
        except (_Interrupted, urllib.error.URLError, http.client.HTTPException, OSError) as error:
            reason = str(getattr(error, "reason", error))
        failures = 0 if _size(part) > before else failures + 1
        if MAX_FAILURES in (failures, restarts):
            raise DownloadError(
                f"{url}: {reason}; {MAX_FAILURES} attempts brought nothing more. The received "
                "bytes are kept: run the command again to continue"
            )
        time.sleep(pause * 2 ** max(0, failures - 1))


def _request(url: str, part: Path, progress: Progress) -> None:
    """One request, from shortly before the end of the part to the end of the file."""
    known = _size(part)
    start = max(0, known - OVERLAP)
    headers = {"Accept-Encoding": "identity"}  # compressed bytes could not be continued
    if known:
        headers["Range"] = f"bytes={start}-"
    request = urllib.request.Request(url, headers=headers)
    with urllib.request.urlopen(request, timeout=TIMEOUT) as answer:
        text = answer.headers.get("Content-Length") or ""
        length = int(text) if text.isdecimal() else None
        if answer.status == 206:
            total: int | None = _total(answer.headers.get("Content-Range", ""), start, length)
        else:  # a server without ranges sends the whole file
            start, total = 0, length
        with open(part, "r+b" if known else "w+b") as file:
            file.seek(start)
            _copy(answer, file, start, known, lambda done: progress(done, total))
    size = _size(part)
    if total is not None and size != total:
        error = _Changed if size > total else _Interrupted
        raise error(f"received {size} of {total} bytes")


def _copy(
    answer: http.client.HTTPResponse,
    file: BinaryIO,
    at: int,
    known: int,
    progress: Callable[[int], None],
) -> None:
    """Write the answer into the file; the bytes below `known` are compared instead."""
    # read1 returns the bytes that have arrived; read would lose them if the connection breaks.
    while chunk := answer.read1(CHUNK):
        same = min(len(chunk), max(0, known - at))
        if same and file.read(same) != chunk[:same]:
            raise _Changed("the server's file differs from the received bytes")
        file.seek(at + same)
        file.write(chunk[same:])
        at += len(chunk)
        file.seek(at)
        progress(max(at, known))
    file.flush()
    os.fsync(file.fileno())


def _total(text: str, start: int, length: int | None) -> int:
    """The size of the whole file, from a header `bytes START-END/TOTAL`."""
    match = re.fullmatch(r"bytes (\d+)-(\d+)/(\d+)", text.strip())
    if match is None:
        raise _Changed(f"the server sent a part without a valid range ({text!r})")
    first, last, total = map(int, match.groups())
    if first != start or not first <= last < total or length not in (None, last - first + 1):
        raise _Changed(f"the server sent {text!r}, expected bytes from {start}")
    return total


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0
