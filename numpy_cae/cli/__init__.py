"""The command `numpy-cae`: one module of `commands` a subcommand, imported when it is chosen.

A module's docstring is the subcommand's description, with examples in its last paragraph;
`add_arguments(parser)` declares its arguments and `run(args)` returns the exit status.

Errors that a user can correct (a damaged file, a missing joint, a wrong number) end in one line on
standard error and exit status 2, without a traceback.
"""

import argparse
import logging
import os
import shutil
import sys
import textwrap
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from numpy_cae import __version__
from numpy_cae.cli.shared.output import visible_output
from numpy_cae.errors import NumpyCaeError


def _first_sentence(name: str) -> str:
    """Of a subcommand's description, without importing its module."""
    path = Path(__file__).with_name("commands") / f"{name}.py"
    source = path.read_text(encoding="utf-8")
    return " ".join(source.split('"""')[1].split()).split(". ")[0]


GROUPS = {
    "to begin with": "demo",
    "motion files": "repair fill show rig",
    "networks": "train download interpolate compare sample",
    "lessons and checks": "lessons verify",
}
SUBCOMMANDS = {name: _first_sentence(name) for name in " ".join(GROUPS.values()).split()}
"""Each subcommand, which is the module of that name, with its help in one sentence."""


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; see `{self.prog} --help`\n")


@visible_output()
def main(argv: Sequence[str] | None = None) -> int:
    """Run `numpy-cae` with these arguments, by default the command line's; return the status."""
    argv = sys.argv[1:] if argv is None else list(argv)
    # The commands print the reader's notes themselves.
    logging.getLogger("numpy_cae.mocap.load").setLevel(logging.ERROR)
    name = _parser().parse_args(argv[:1]).command
    try:
        args = subcommand_parser(name).parse_args(argv[1:])  # imports for a second
        status = args.run(args)
        sys.stdout.flush()
        return status
    except BrokenPipeError:  # as in `numpy-cae repair … | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except (NumpyCaeError, ValueError, OSError, MemoryError) as error:
        problem = f"not enough memory. {error}" if isinstance(error, MemoryError) else str(error)
        print(f"numpy-cae {name}: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt as interrupt:
        advice = str(interrupt) or "nothing more was written"
        print(f"numpy-cae {name}: interrupted; {advice}", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    """The parser of the first word: a subcommand, --help or --version."""
    parser = _Parser(
        "numpy-cae",
        usage="numpy-cae [-h] [--version] COMMAND ...",
        description=_overview(),
        epilog="example: numpy-cae demo\n\n`numpy-cae COMMAND --help` prints options and examples.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--version", action="version", version=f"numpy-cae {__version__}")
    add("command", choices=list(SUBCOMMANDS), metavar="COMMAND", help=argparse.SUPPRESS)
    return parser


def _overview() -> str:
    """The subcommands in groups, each with its sentence."""
    lines = ["Motion manifolds in NumPy, every derivative by hand."]
    for group, names in GROUPS.items():
        lines.append(f"\n{group}:")
        for name in names.split():
            text = f"  {name:<13}{SUBCOMMANDS[name]}"
            lines.append(textwrap.fill(text, _columns(), subsequent_indent=" " * 15))
    return "\n".join(lines).replace("%", "%%")


def _columns() -> int:
    return min(shutil.get_terminal_size().columns, 81) - 2


def subcommand_parser(name: str) -> argparse.ArgumentParser:
    """The parser of one subcommand, from its module."""
    module = import_module(f"numpy_cae.cli.commands.{name}")
    description, _, examples = (module.__doc__ or "").partition("\n\nexample")
    parser = _Parser(
        f"numpy-cae {name}",
        description=textwrap.fill(description, _columns()).replace("%", "%%"),
        epilog=f"example{examples}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(command=name, run=module.run)
    module.add_arguments(parser)
    return parser
