"""Download Acclaim files (.asf, .amc) of the Carnegie Mellon Graphics Lab Motion Capture Database.
An interrupted download continues when the command is run again; a file gets its name only when it
is complete and can be read.

example: numpy-cae download cmu --subjects 2,7,35 -o cmu
"""

import argparse
import time

from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.output import note
from numpy_cae.download import CmuSite, DownloadError, download_cmu
from numpy_cae.download.cmu import SITE, TERMS, Progress


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The database, the subjects and the folder; the help ends with the terms of use."""
    parser.epilog = f"{parser.epilog}\n{TERMS}"
    add = parser.add_argument
    add("database", choices=["cmu"], help="name of the database")
    some = "numbers of the subjects to download (default: all, one archive of over a gigabyte)"
    add("--subjects", type=_subjects, metavar="N,N,…", help=some)
    output = "folder for the files, created if it does not exist"
    add("-o", "--output", **arguments.FOLDER, required=True, help=output)
    site = f"address of the site or of a mirror (default: {SITE})"
    add("--site", default=SITE, metavar="URL", help=site)
    arguments.add_shared(parser, "quiet")


def run(args: argparse.Namespace) -> int:
    """Print the terms, download, print the result."""
    site = CmuSite(args.site)
    print(TERMS)
    tally = download_cmu(args.output, args.subjects, site, None if args.quiet else _progress())
    print(f"{args.output}: {tally.new} new files, {tally.known} downloaded before")
    if tally.refused:
        for refused in tally.refused:
            note(f"left out: {refused}")
        raise DownloadError(f"{len(tally.refused)} downloaded files cannot be read, see above")
    return 0


def _subjects(text: str) -> list[int]:
    """Numbers of subjects, from a text such as 1,2,35."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words or not all(word.isdecimal() and 0 < int(word) < 1000 for word in words):
        raise argparse.ArgumentTypeError(f"{text!r}: expected numbers such as 1,2,35")
    return list(dict.fromkeys(map(int, words)))


def _progress() -> Progress:
    """A function that prints a line for every file, and for a large one every five seconds."""
    last = "", 0.0

    def show(name: str, done: int, total: int | None) -> None:
        nonlocal last
        if name != last[0] or time.monotonic() - last[1] > 5:
            last = name, time.monotonic()
            share = f"{done / 1e6:.1f} of {total / 1e6:.1f} MB" if total else f"{done / 1e6:.1f} MB"
            note(f"{name}: {share}" if done else name)

    return show
