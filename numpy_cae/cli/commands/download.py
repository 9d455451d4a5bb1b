"""Download Acclaim files (.asf, .amc) of the Carnegie Mellon Graphics Lab Motion Capture Database.
Files that the folder already has are kept. The site publishes no checksums: the first download of
a file is not checked. Its checksum is written to checksums.txt in the folder, and a later download
that does not agree with it is refused.

example: numpy-cae download cmu --subjects 2,7,35 -o cmu
"""

import argparse

from numpy_cae.download import cmu

EPILOG = f"\n{cmu.TERMS}"


def run(args: argparse.Namespace) -> int:
    """Print the terms, download, print the number of files."""
    print(cmu.TERMS)
    files = cmu.download_cmu(args.output, args.subjects, args.site, not args.quiet)
    print(f"{args.output}: {len(files)} files")
    return 0


def _subjects(text: str) -> list[int]:
    """Numbers of subjects, from a text such as 1,2,35."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words or not all(word.isdecimal() and 0 < int(word) < 1000 for word in words):
        raise argparse.ArgumentTypeError(f"{text!r}: expected numbers such as 1,2,35")
    return list(dict.fromkeys(map(int, words)))
