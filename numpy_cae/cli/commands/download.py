"""Download Acclaim files (.asf, .amc) of the Carnegie Mellon Graphics Lab Motion Capture Database.
Files that the folder already has are kept. The site publishes no checksums, and the package has
none: of the first download of a file only the form is checked, and the site does not encrypt (its
address begins with http). The file's SHA-256 is written to checksums.txt in the folder; a file
there or a later download that does not agree with it is refused. Put the checksums.txt of somebody
whom you trust into the folder to have the first download checked, too.

example: numpy-cae download cmu --subjects 2,7,35 -o cmu
"""

import argparse

from numpy_cae.cli.shared import arguments
from numpy_cae.download.cmu import SITE, TERMS, download_cmu


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The database, the subjects and the folder; the help ends with the terms of use."""
    parser.epilog = f"{parser.epilog}\n{TERMS}"
    add = parser.add_argument
    add("database", choices=["cmu"], help="name of the database")
    subjects = "numbers of the subjects to download, 1 to 144"
    add("--subjects", type=_subjects, required=True, metavar="N,N,…", help=subjects)
    add("-o", "--output", **arguments.FOLDER, required=True, help="folder for the files")
    add("--site", default=SITE, metavar="URL", help=f"address of a mirror (default: {SITE})")
    arguments.add_shared(parser, "quiet")


def run(args: argparse.Namespace) -> int:
    """Print the terms, download, print the number of files."""
    print(TERMS)
    files = download_cmu(args.output, args.subjects, args.site, not args.quiet)
    print(f"{args.output}: {len(files)} files")
    return 0


def _subjects(text: str) -> list[int]:
    """Numbers of subjects, from a text such as 1,2,35."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words or not all(word.isdecimal() and 0 < int(word) < 1000 for word in words):
        raise argparse.ArgumentTypeError(f"{text!r}: expected numbers such as 1,2,35")
    return list(dict.fromkeys(map(int, words)))
