"""`--json`: what a command found, for a script. One JSON value on standard output and nothing else
there; progress and complaints stay on standard error."""

from __future__ import annotations

import argparse
import json
import math
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np


def add_json_argument(parser: argparse.ArgumentParser) -> None:
    """The option, the same everywhere."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")


def print_json(value: object) -> None:
    """Print what `plain` makes of a result."""
    print(json.dumps(plain(value), indent=1, ensure_ascii=False, allow_nan=False))


def plain(value: object) -> object:
    """A result in what JSON knows: dataclasses and paths too, null for what is not finite.

    Raises
    ------
    TypeError
        If there is anything else in it.
    """
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, dict):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{type(value).__name__} has no form in JSON")
