"""Arguments that several subcommands share, and the types of numbers that argparse checks."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from math import inf
from pathlib import Path


def _number(
    kind: Callable[[str], float], allowed: Callable[[float], bool], expected: str
) -> Callable[[str], float]:
    """A type for argparse: numbers that are allowed; others are refused with what is expected."""

    def parse(text: str) -> float:
        value = kind(text)
        if not allowed(value):
            raise argparse.ArgumentTypeError(f"{text} is not {expected}")
        return value

    parse.__name__ = kind.__name__  # argparse names it where the text is no number at all
    return parse


whole_number = _number(int, lambda n: n >= 0, "0 or more")
positive_number = _number(int, lambda n: n >= 1, "1 or more")
odd_number = _number(int, lambda n: n >= 1 and n % 2 == 1, "an odd number above 0")
rate = _number(float, lambda x: 0 <= x < inf, "a finite number of 0 or more")
positive = _number(float, lambda x: 0 < x < inf, "a finite number above 0")
fraction = _number(float, lambda x: 0 <= x <= 1, "between 0 and 1")
momentum = _number(float, lambda x: 0 <= x < 1, "from 0 to below 1")
bound = _number(float, lambda x: 0 < x < 1, "between 0 and 1, both excluded")


def add_motion_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that say how to read motion files."""
    parser.add_argument(
        "--mapping",
        type=Path,
        metavar="JSON",
        help="file that maps our joint names to those of the rig, for rigs that are not known",
    )
    parser.add_argument(
        "--unit",
        type=positive,
        metavar="METRES",
        help="length unit of the files in metres, 0.01 for centimetres (default: guessed)",
    )


def chosen_mapping(args: argparse.Namespace) -> dict[str, str] | None:
    """Read the mapping that `--mapping` names; None without one."""
    from numpy_cae.motion import read_mapping

    return None if args.mapping is None else read_mapping(args.mapping)


def require_place(path: Path) -> None:
    """Raise ValueError unless a file can be created there; call it before hours of work."""
    folder = path.resolve().parent
    if not folder.is_dir():
        raise ValueError(f"{path}: cannot be written: there is no folder {folder}")
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror}") from None
