"""Arguments that several subcommands share, the types of numbers that argparse checks, and the
checks of files to write."""

import argparse
import os
from collections.abc import Callable, Iterable, Mapping
from math import inf
from pathlib import Path
from typing import Any


def _number(
    to_number: Callable[[str], float], allowed: Callable[[float], bool], expected: str
) -> Any:
    """A type for argparse, which refuses numbers that are not allowed and says what is expected."""

    def parse(text: str) -> float:
        value = to_number(text)
        if not allowed(value):
            raise argparse.ArgumentTypeError(f"{text} is not {expected}")
        return value

    parse.__name__ = to_number.__name__  # argparse names it where the text is no number at all
    return parse


whole_number = _number(int, lambda n: n >= 0, "0 or more")
positive_number = _number(int, lambda n: n >= 1, "1 or more")
rate = _number(float, lambda x: 0 <= x < inf, "a finite number of 0 or more")
finite = _number(float, lambda x: -inf < x < inf, "a finite number")
positive = _number(float, lambda x: 0 < x < inf, "a finite number above 0")
fraction = _number(float, lambda x: 0 <= x <= 1, "between 0 and 1")

# Settings of `add_argument` for common types of argument; each use adds its help and default.
FLAG: dict[str, Any] = {"action": "store_true"}
COUNT: dict[str, Any] = {"type": positive_number, "metavar": "N"}
FILE: dict[str, Any] = {"type": Path, "metavar": "FILE"}
FOLDER: dict[str, Any] = {"type": Path, "metavar": "FOLDER"}
FOLDERS: dict[str, Any] = FOLDER | {"nargs": "+"}
PATTERNS: dict[str, Any] = {"nargs": "+", "metavar": "PATTERN", "default": []}

UP = ("x", "y", "z", "-x", "-y", "-z")

_MAPPING = (
    "file with the names of our joints in an unknown rig (made by `numpy-cae rig`); "
    "of several --mapping options each motion uses the first that fits"
)

SHARED: dict[str, dict[str, Any]] = {
    "seed": {"type": whole_number, "default": 0, "help": "seed of all random numbers (default: 0)"},
    "quiet": FLAG | {"help": "show no progress"},
    "overwrite": FLAG | {"help": "replace files that exist, even those that the command reads"},
    "html": FLAG | {"help": "also write a page beside the output that plays the motions"},
    "mapping": FILE | {"metavar": "JSON", "action": "append", "default": [], "help": _MAPPING},
    "unit": {"type": positive, "metavar": "METRES"}
    | {"help": "length unit of the files in metres, such as 0.01 (default: guessed)"},
    "up": {"choices": UP, "help": "axis that points up; write --up=-z for -z (default: guessed)"},
    "floor": {"type": finite, "metavar": "METRES"}
    | {"help": "height of the floor along the up axis (default: guessed)"},
}


def add_shared(parser: argparse.ArgumentParser, names: str) -> None:
    """Add some of the options in `SHARED`, whose names are separated by spaces."""
    for name in names.split():
        parser.add_argument(f"--{name}", **SHARED[name])


def reading(args: argparse.Namespace) -> dict[str, Any]:
    """How motion files are read, as arguments of `load_motion`: what `--unit`, `--up` and `--floor`
    say, and the mappings in the files that `--mapping` names (None, one or several)."""
    from numpy_cae.mocap import read_mapping

    mappings = [read_mapping(path) for path in getattr(args, "mapping", [])]
    mapping = mappings if len(mappings) > 1 else next(iter(mappings), None)
    return {"unit": args.unit, "up": args.up, "floor": args.floor, "mapping": mapping}


def require_at_most(option: str, value: float, most: float) -> None:
    """Raise ValueError if the number of an option is beyond all use."""
    if value > most:
        raise ValueError(f"{option} is {value:g}, expected at most {most:,.0f}")


def require_different(outputs: Mapping[str, Path | None]) -> None:
    """Raise ValueError if two options of a command, by name, would write one file."""
    options: dict[str, str] = {}
    for option, path in outputs.items():
        if path is not None:
            first = options.setdefault(os.path.realpath(path), option)
            if first != option:
                raise ValueError(f"{path}: {first} and {option} would both write it")


def require_not_read(path: Path, sources: Iterable[Path]) -> None:
    """Raise ValueError if a file to write is one of those that the command reads."""
    for source in sources:
        if path.exists() and source.exists() and path.samefile(source):
            raise ValueError(f"{path}: is the file that is read; --overwrite allows this")
