"""The command `numpy-cae`: one module a subcommand, imported when that subcommand is chosen.

A module's docstring is the subcommand's description, with examples in its last paragraph;
`add_arguments(parser)` declares its arguments and `run(args)` returns the exit status.

Errors that a user can correct (a damaged file, a missing joint, a wrong number) end in one line on
standard error and exit status 2, without a traceback.
"""

import argparse
import sys
import textwrap
from collections.abc import Sequence
from importlib import import_module

from numpy_cae import __version__
from numpy_cae.errors import NumpyCaeError

SUBCOMMANDS = {
    "demo": "make motions, learn from them and repair one, in about a minute; needs no files",
    "download": "download motion files of the CMU database",
    "train": "learn a manifold from folders of motion files",
    "repair": "repair a motion by projecting it onto a manifold",
    "fill": "fill in a missing joint, or the frames between keyframes",
    "interpolate": "interpolate between two motions along a manifold",
    "compare": "compute the distances between motions",
    "sample": "sample new motions from a manifold",
    "rig": "say which joints, axes and unit a motion file has, and write a mapping for its rig",
    "show": "draw a motion file as a strip of poses and an animation",
    "report": "run every experiment of holden2015 and write one page of results",
    "study": "run every experiment of jang2018 and write its results",
    "lessons": "write student copies of the lessons, or run the originals",
    "verify": "check and grade the operations in a Python file",
    "bench": "measure the speed of training and projection",
}
"""Each subcommand, which is the module of that name, with its help in one line."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run `numpy-cae` with these arguments, by default the command line's; return the status."""
    argv = sys.argv[1:] if argv is None else list(argv)
    command = _command(argv)
    try:
        args = _parser(argv).parse_args(argv)  # imports for a second
        return args.run(args)
    except (NumpyCaeError, ValueError, OSError, MemoryError) as error:
        problem = f"not enough memory. {error}" if isinstance(error, MemoryError) else error
        print(f"numpy-cae {command}: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt as interrupt:
        state = str(interrupt) or "nothing more was written"
        print(f"numpy-cae {command}: interrupted; {state}", file=sys.stderr)
        return 130


def _command(argv: Sequence[str]) -> str | None:
    """The name of the subcommand."""
    return next((word for word in argv if not word.startswith("-")), None)


def _parser(argv: Sequence[str]) -> argparse.ArgumentParser:
    """The parser, with the options of the subcommand that `argv` names and of no other."""
    parser = argparse.ArgumentParser(
        prog="numpy-cae", description="Motion manifolds in NumPy, every derivative by hand."
    )
    parser.add_argument("--version", action="version", version=f"numpy-cae {__version__}")
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    chosen = _command(argv)
    for name, help_line in SUBCOMMANDS.items():
        if name == chosen:
            _add_subcommand(subparsers, name)
        else:
            subparsers.add_parser(name, help=help_line, add_help=False)
    return parser


def subcommand_parser(name: str) -> argparse.ArgumentParser:
    """The parser of one subcommand, for the documentation."""
    return _add_subcommand(argparse.ArgumentParser(prog="numpy-cae").add_subparsers(), name)


def _add_subcommand(subparsers, name: str) -> argparse.ArgumentParser:
    """A subcommand's parser, from its module."""
    module = import_module(f"numpy_cae.cli.{name}")
    description, _, examples = (module.__doc__ or "").partition("\n\nexample")
    subparser = subparsers.add_parser(
        name,
        help=SUBCOMMANDS[name],
        description=textwrap.fill(description, 79).replace("%", "%%"),
        epilog=f"example{examples}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    subparser.set_defaults(run=module.run)
    module.add_arguments(subparser)
    return subparser
