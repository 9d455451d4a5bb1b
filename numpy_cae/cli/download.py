"""`numpy-cae download cmu -o FOLDER`: the CMU database, or some of its subjects."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from numpy_cae.download import CmuSite, DownloadError, download_cmu
from numpy_cae.download.cmu import SITE, TERMS


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Whose database, which subjects, where to."""
    parser = subparsers.add_parser(
        "download",
        help="fetch motion files of the CMU database",
        description="Fetch Acclaim files (.asf, .amc) of the Carnegie Mellon Graphics Lab Motion "
        "Capture Database. What was cut off goes on where it stopped when the command is run "
        "again; a file stands under its name only when it is whole and could be read. " + TERMS,
        epilog="example: numpy-cae download cmu --subjects 2,7,35 -o cmu",
    )
    parser.add_argument("database", choices=["cmu"], help="whose")
    parser.add_argument(
        "--subjects",
        type=_subjects,
        metavar="N,N,…",
        help="only these (default: all, one archive of over a gigabyte)",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument(
        "--site", default=SITE, metavar="URL", help=f"a mirror, or a test's server; default: {SITE}"
    )
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Say the terms, fetch, count."""
    site = CmuSite(args.site)
    print(TERMS)
    tally = download_cmu(args.output, args.subjects, site, None if args.quiet else _Shown().said)
    print(f"{args.output}: {tally.new} new files, {tally.known} there before")
    if tally.refused:
        for refused in tally.refused:
            print(f"left out: {refused}", file=sys.stderr)
        raise DownloadError(f"{len(tally.refused)} files came that cannot be read, see above")
    return 0


def _subjects(text: str) -> list[int]:
    """1,2,35: numbers of subjects."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words or not all(word.isdecimal() and 0 < int(word) < 1000 for word in words):
        raise argparse.ArgumentTypeError(f"{text!r}: expected numbers such as 1,2,35")
    return list(dict.fromkeys(map(int, words)))


class _Shown:
    """A line for every file, and for a large one a line every few seconds."""

    def __init__(self):
        self.name, self.when = "", 0.0

    def said(self, name: str, done: int, total: int | None) -> None:
        now = time.monotonic()
        if name != self.name or now - self.when > 5:
            self.name, self.when = name, now
            share = f"{done / 1e6:.1f} of {total / 1e6:.1f} MB" if total else f"{done / 1e6:.1f} MB"
            print(name if not done else f"{name}: {share}", file=sys.stderr, flush=True)
