"""The options of the commands, and the types of numbers that argparse checks."""

import argparse
import tomllib
from collections.abc import Callable, Iterator, Mapping
from math import inf
from pathlib import Path
from string import Formatter
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

_COMMANDS = tomllib.loads(Path(__file__).with_name("options.toml").read_text(encoding="utf-8"))
"""_COMMANDS: the options of each command by the title of their group and by their flags."""


def options_of(
    command: str, names: Mapping[str, Any]
) -> Iterator[tuple[str, list[str], dict[str, Any]]]:
    """Of each option of a command in `options.toml` the title of its group, the flags and the
    arguments of `add_argument`; `names` are those of the command's module."""
    names = globals() | dict(names)
    for title, options in _COMMANDS[command].items():
        for flags, stated in options.items():
            while isinstance(stated, str):
                stated = next(
                    group[flags] for group in _COMMANDS[stated].values() if flags in group
                )
            settings = {key: _filled_in(value, names) for key, value in stated.items()}
            for key in {"type", "choices"} & set(settings):
                if isinstance(settings[key], str):
                    settings[key] = Formatter().get_field(settings[key], (), names)[0]
            yield title, flags.split(), settings


def _filled_in(value: Any, names: Mapping[str, Any]) -> Any:
    """A text with what its braces name, in one line; a list of texts as argparse wants it."""
    if isinstance(value, list) and value:
        return tuple(value)
    return " ".join(value.format_map(names).split()) if isinstance(value, str) else value


def add_options(parser: argparse.ArgumentParser, command: str, names: Mapping[str, Any]) -> None:
    """Add the options of a command to its parser."""
    groups: dict[str, argparse._ActionsContainer] = {"options": parser}
    for title, flags, settings in options_of(command, names):
        if title not in groups:
            groups[title] = parser.add_argument_group(title)
        groups[title].add_argument(*flags, **settings)


def reading(args: argparse.Namespace) -> dict[str, Any]:
    """How motion files are read, as arguments of `load_motion`: what `--unit`, `--up` and `--floor`
    say, and the mappings in the files that `--mapping` names (None, one or several)."""
    from numpy_cae.mocap import read_mapping

    mappings = [read_mapping(path) for path in getattr(args, "mapping", [])]
    mapping = mappings if len(mappings) > 1 else next(iter(mappings), None)
    return {"unit": args.unit, "up": args.up, "floor": args.floor, "mapping": mapping}
