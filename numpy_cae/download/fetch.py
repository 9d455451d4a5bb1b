"""One complete file from a web server; an interrupted download is continued.

The received bytes are kept in a file `.NAME.part`, also when the program ends, and the next call
continues there. It requests the last few kilobytes again and compares them, so that parts of two
versions of a file are never joined.
"""

import http.client
import os
import re
import threading
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
TIMEOUT = 15.0
"""Seconds without a byte after which a connection counts as broken."""
PATIENCE, LEAST = 60.0, 1 << 16
"""A download that brings fewer new bytes in so many seconds is given up."""
MAX_BYTES = 4 << 30
"""Of a file; the archive of the CMU database has over a gigabyte."""
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


class _TooLarge(Exception):
    """More bytes than the file may have."""


def fetch(
    url: str,
    part: str | Path,
    progress: Progress | None = None,
    pause: float = 1.0,
    most: int = MAX_BYTES,
) -> None:
    """Download a file into `part`, continuing after the bytes that it has.

    `part` is complete when the function returns; the caller renames it. `pause` is the time in
    seconds before the second attempt, doubled with each further one.

    Raises DownloadError if the server does not have the file or it has more than `most` bytes, if
    `MAX_FAILURES` attempts in a row brought nothing, `PATIENCE` seconds fewer than `LEAST` bytes.
    """
    part = Path(part)
    ended: list[Exception | None] = []

    def download() -> None:
        try:
            ended.append(_attempts(url, part, progress or (lambda done, total: None), pause, most))
        except BaseException as error:
            ended.append(error)

    # A server that sends a byte now and then, even in its headers, would hold this thread for ever.
    thread = threading.Thread(target=download, daemon=True)
    thread.start()
    size, since = _size(part), time.monotonic()
    while thread.is_alive():
        thread.join(0.2)
        now = _size(part)
        if now < size or now >= size + LEAST:
            size, since = now, time.monotonic()
        elif time.monotonic() - since > PATIENCE and thread.is_alive():
            raise DownloadError(
                f"{url}: fewer than {LEAST} new bytes in {PATIENCE:g} seconds. The received bytes "
                "are kept: run the command again to continue"
            )
    if ended[0] is not None:
        if part.exists() and _size(part) == 0:
            part.unlink()
        raise ended[0]


def _attempts(url: str, part: Path, progress: Progress, pause: float, most: int) -> None:
    """Request the file until it is complete."""
    failures = restarts = 0
    while True:
        before = _size(part)
        try:
            return _request(url, part, progress, most)
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
        except _TooLarge:
            part.unlink()
            problem = f"has more than {most} bytes, which is the limit; nothing was kept"
            raise DownloadError(f"{url}: {problem}") from None
        except (_Interrupted, urllib.error.URLError, http.client.HTTPException, OSError) as error:
            reason = str(getattr(error, "reason", error))
        except (ValueError, OverflowError) as error:  # such as the address of a redirection
            raise DownloadError(f"{url}: the server's answer is invalid: {error}") from None
        failures = 0 if _size(part) > before else failures + 1
        if MAX_FAILURES in (failures, restarts):
            raise DownloadError(
                f"{url}: {reason}; {MAX_FAILURES} attempts brought nothing more. The received "
                "bytes are kept: run the command again to continue"
            )
        time.sleep(pause * 2 ** max(0, failures - 1))


def _request(url: str, part: Path, progress: Progress, most: int) -> None:
    """One request, from shortly before the end of the part to the end of the file."""
    known = _size(part)
    start = max(0, known - OVERLAP)
    headers = {"Accept-Encoding": "identity"}  # compressed bytes could not be continued
    if known:
        headers["Range"] = f"bytes={start}-"
    request = urllib.request.Request(url, headers=headers)
    with urllib.request.urlopen(request, timeout=TIMEOUT) as answer:
        text = answer.headers.get("Content-Length") or ""
        length = int(text) if re.fullmatch(r"[0-9]{1,18}", text) else None
        if answer.status == 206:
            total: int | None = _total(answer.headers.get("Content-Range", ""), start, length)
        else:  # a server without ranges sends the whole file
            start, total = 0, length
        with open(part, "r+b" if known else "w+b") as file:
            file.seek(start)
            if total is not None and total > most:
                raise _TooLarge
            _copy(answer, file, start, known, most, lambda done: progress(done, total))
    size = _size(part)
    if total is not None and size != total:
        error = _Changed if size > total else _Interrupted
        raise error(f"received {size} of {total} bytes")


def _copy(
    answer: http.client.HTTPResponse,
    file: BinaryIO,
    at: int,
    known: int,
    most: int,
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
        if at > most:
            raise _TooLarge
        file.seek(at)
        progress(max(at, known))
    file.flush()
    os.fsync(file.fileno())


def _total(text: str, start: int, length: int | None) -> int:
    """The size of the whole file, from a header `bytes START-END/TOTAL`."""
    match = re.fullmatch(r"bytes ([0-9]{1,18})-([0-9]{1,18})/([0-9]{1,18})", text.strip())
    if match is None:
        raise _Changed(f"the server sent a part without a valid range ({text[:80]!r})")
    first, last, total = map(int, match.groups())
    if first != start or not first <= last < total or length not in (None, last - first + 1):
        raise _Changed(f"the server sent {text[:80]!r}, expected bytes from {start}")
    return total


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0
