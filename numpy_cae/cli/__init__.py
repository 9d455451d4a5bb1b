"""The command `numpy-cae`: one file a subcommand.

What a person can mend (a damaged file, a missing joint, a wrong number) ends in one line on
standard error and exit status 2, never in a traceback.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from numpy_cae.cli import (
    bench,
    compare,
    demo,
    download,
    fill,
    interpolate,
    lessons,
    repair,
    report,
    sample,
    show,
    study,
    train,
    verify,
)

SUBCOMMANDS = (
    demo,
    download,
    train,
    repair,
    fill,
    interpolate,
    compare,
    sample,
    show,
    report,
    study,
    lessons,
    verify,
    bench,
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run `numpy-cae` with these arguments (the command line's where None); the exit status."""
    parser = argparse.ArgumentParser(
        prog="numpy-cae", description="Motion manifolds in NumPy, every derivative by hand."
    )
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for subcommand in SUBCOMMANDS:
        subcommand.add_parser(subparsers)
    args = parser.parse_args(argv)
    try:
        return args.run(args)
    except (ValueError, ArithmeticError, OSError) as error:
        print(f"numpy-cae {args.command}: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print(f"numpy-cae {args.command}: interrupted, nothing more was written", file=sys.stderr)
        return 130
