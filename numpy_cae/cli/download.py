"""`numpy-cae download cmu -o FOLDER`: download the CMU database, or some of its subjects."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from numpy_cae.download import CmuSite, DownloadError, download_cmu
from numpy_cae.download.cmu import SITE, TERMS


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "download",
        help="download motion files of the CMU database",
        description="Download Acclaim files (.asf, .amc) of the Carnegie Mellon Graphics Lab "
        "Motion Capture Database. An interrupted download continues when the command is run "
        "again; a file gets its name only when it is complete and can be read. " + TERMS,
        epilog="example: numpy-cae download cmu --subjects 2,7,35 -o cmu",
    )
    parser.add_argument("database", choices=["cmu"], help="name of the database")
    parser.add_argument(
        "--subjects",
        type=_subjects,
        metavar="N,N,…",
        help="numbers of the subjects to download (default: all, one archive of over a gigabyte)",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="FOLDER",
        help="folder for the files, created if it does not exist",
    )
    parser.add_argument(
        "--site",
        default=SITE,
        metavar="URL",
        help=f"address of the site or of a mirror (default: {SITE})",
    )
    parser.add_argument("--quiet", action="store_true", help="do not show the progress")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Print the terms, download, print the result."""
    site = CmuSite(args.site)
    print(TERMS)
    tally = download_cmu(args.output, args.subjects, site, None if args.quiet else _Progress().show)
    print(f"{args.output}: {tally.new} new files, {tally.known} downloaded before")
    if tally.refused:
        for refused in tally.refused:
            print(f"left out: {refused}", file=sys.stderr)
        raise DownloadError(f"{len(tally.refused)} downloaded files cannot be read, see above")
    return 0


def _subjects(text: str) -> list[int]:
    """Numbers of subjects, from a text such as 1,2,35."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words or not all(word.isdecimal() and 0 < int(word) < 1000 for word in words):
        raise argparse.ArgumentTypeError(f"{text!r}: expected numbers such as 1,2,35")
    return list(dict.fromkeys(map(int, words)))


class _Progress:
    """Prints a line for every file, and for a large one a line every five seconds."""

    def __init__(self):
        self.name, self.time = "", 0.0

    def show(self, name: str, done: int, total: int | None) -> None:
        now = time.monotonic()
        if name != self.name or now - self.time > 5:
            self.name, self.time = name, now
            share = f"{done / 1e6:.1f} of {total / 1e6:.1f} MB" if total else f"{done / 1e6:.1f} MB"
            print(name if not done else f"{name}: {share}", file=sys.stderr, flush=True)
