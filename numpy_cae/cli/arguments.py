"""Arguments that several subcommands share, and numbers that argparse checks."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from numpy_cae.motion import read_mapping


def whole_number(text: str) -> int:
    """0, 1, 2, …"""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text} is below 0")
    return value


def positive_number(text: str) -> int:
    """1, 2, 3, …"""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is below 1")
    return value


def odd_number(text: str) -> int:
    """1, 3, 5, …"""
    value = positive_number(text)
    if value % 2 == 0:
        raise argparse.ArgumentTypeError(f"{text} is even")
    return value


def rate(text: str) -> float:
    """A finite number of 0 or more."""
    value = float(text)
    if not 0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a finite number of 0 or more")
    return value


def fraction(text: str) -> float:
    """0 to 1."""
    value = float(text)
    if not 0 <= value <= 1:
        raise argparse.ArgumentTypeError(f"{text} is not between 0 and 1")
    return value


def bound(text: str) -> float:
    """Between 0 and 1, both excluded."""
    value = float(text)
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not between 0 and 1, both excluded")
    return value


def positive(text: str) -> float:
    """A finite number above 0."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not a finite number above 0")
    return value


def add_motion_arguments(parser: argparse.ArgumentParser) -> None:
    """How motion files are to be read."""
    parser.add_argument(
        "--mapping",
        type=Path,
        metavar="JSON",
        help="a file with {our joint: joint of the rig}, for rigs that are not known",
    )
    parser.add_argument(
        "--unit",
        type=positive,
        metavar="METRES",
        help="metres in one unit of length of the files, 0.01 for centimetres (default: guessed)",
    )


def chosen_mapping(args: argparse.Namespace) -> dict[str, str] | None:
    """The mapping that `--mapping` names, read."""
    return None if args.mapping is None else read_mapping(args.mapping)


def require_place(path: Path) -> None:
    """Raise ValueError unless a file can be made there: asked before hours of work, not after."""
    folder = path.resolve().parent
    if not folder.is_dir():
        raise ValueError(f"{path}: cannot be written: there is no folder {folder}")
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ValueError(f"{path}: cannot be written: {error.strerror}") from None
