"""The command `numpy-cae`: one module of `commands` a subcommand, imported when it is chosen.

A module's docstring is the subcommand's description, with examples in its last paragraph;
`add_arguments(parser)` declares its arguments and `run(args)` returns the exit status.

Errors that a user can correct (a damaged file, a missing joint, a wrong number) end in one line on
standard error and exit status 2, without a traceback.
"""

import argparse
import logging
import os
import re
import shutil
import signal
import sys
import textwrap
from collections.abc import Sequence
from contextlib import suppress
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from numpy_cae import __version__
from numpy_cae.atomic_write import replacing
from numpy_cae.cli.shared.output import visible_output
from numpy_cae.errors import NumpyCaeError


def _first_sentence(name: str) -> str:
    """Of a subcommand's description, without importing its module."""
    path = Path(__file__).with_name("commands") / f"{name}.py"
    source = path.read_text(encoding="utf-8")
    return " ".join(source.split('"""')[1].split()).split(". ")[0]


GROUPS = {
    "to begin with": "demo",
    "motion files": "repair fill edit show rig",
    "networks": "train download interpolate compare sample",
    "lessons and checks": "lessons verify",
}
SUBCOMMANDS = {name: _first_sentence(name) for name in " ".join(GROUPS.values()).split()}
"""Each subcommand, which is the module of that name, with its help in one sentence."""


NARROWEST = 40
"""Help is laid out for at least this many columns."""
SHELLS = ("bash", "zsh", "tcsh")
"""The shells for which `--completion` prints a script."""
TOO_LARGE = "Maximum allowed "
"""What NumPy's ValueError says of an array of more bytes than there are addresses."""
NO_MEMORY = "failed to map segment|[Cc]annot allocate memory|can't start new thread"
"""What errors say that come from little memory, but are no MemoryError: where a compiled module is
loaded, and where a thread begins."""


class _PrintCompletion(argparse.Action):
    """Print the completion of a shell and end, as --help does."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> NoReturn:
        try:
            import shtab
        except ImportError:
            parser.error("--completion needs shtab: `pip install numpy_cae[completion]`")
        sys.stdout.write(shtab.complete(_whole_parser(), shell=values))
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """A parser whose errors are one line, with the words that may have been meant."""

    def error(self, message: str) -> NoReturn:
        advice = self._meant(message)
        self.exit(2, f"{self.prog}: {message}{advice}; see `{self.prog} --help`\n")

    def _meant(self, message: str) -> str:
        """What was meant by the subcommand or the options that a message calls wrong, in words; ""
        if nothing is like them."""
        words = [*SUBCOMMANDS, *self._option_string_actions]
        meant = []
        for word in _wrong_words(message):
            meant += get_close_matches(word, words, n=1)
        return f"; did you mean {' and '.join(meant)}?" if meant else ""


def _wrong_words(message: str) -> list[str]:
    """The words that a message of argparse calls no choice or no argument."""
    choice = re.search(r"invalid choice: '([^']*)'", message)
    if choice:
        return [choice[1]]
    _, is_unrecognized, rest = message.partition("unrecognized arguments: ")
    if not is_unrecognized:
        return []
    return [word.partition("=")[0] for word in rest.split() if word.startswith("-")]


@visible_output()
def main(argv: Sequence[str] | None = None) -> int:
    """Run `numpy-cae` with these arguments, by default the command line's; return the status."""
    argv = sys.argv[1:] if argv is None else list(argv)
    if not argv:
        _parser().print_help()
        return 0
    # The commands print the reader's notes themselves.
    logging.getLogger("numpy_cae.mocap.load").setLevel(logging.ERROR)
    # Options before the subcommand are the program's: they end it, or are errors.
    is_option = argv[0].startswith("-")
    name = _parser().parse_args(argv if is_option else argv[:1]).command
    try:
        args = subcommand_parser(name).parse_args(argv[1:])  # imports for half a second
        from numpy_cae.fast.thread_team import one_blas_thread  # imports NumPy: not for --help

        _raise_on_interrupt()
        # The second thread of BLAS would wait actively after each of many small products: twice the
        # processor time for nothing. `numpy_cae.fast` has threads of its own.
        with one_blas_thread(), replacing(getattr(args, "overwrite", False)):
            status = args.run(args)
        sys.stdout.flush()
        return status
    except BrokenPipeError:  # as in `numpy-cae repair … | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except (NumpyCaeError, ValueError, OSError, MemoryError) as error:
        is_memory = isinstance(error, MemoryError) or TOO_LARGE in str(error)
        problem = f"not enough memory. {error}" if is_memory else str(error)
        print(f"numpy-cae {name}: {problem.strip()}", file=sys.stderr)
        return 2
    except (ImportError, RuntimeError) as error:
        if not re.search(NO_MEMORY, str(error)):
            raise
        print(f"numpy-cae {name}: not enough memory. {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt as interrupt:
        advice = str(interrupt) or "nothing more was written"
        print(f"numpy-cae {name}: interrupted; {advice}", file=sys.stderr)
        return 130


def _raise_on_interrupt() -> None:
    """Let Ctrl-C raise KeyboardInterrupt from now on, unless it is ignored (see `__main__`)."""
    with suppress(ValueError):  # only the main thread has signals
        if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def _parser() -> argparse.ArgumentParser:
    """The parser of the first word: a subcommand, --help or --version."""
    parser = _Parser(
        "numpy-cae",
        usage="numpy-cae [-h] [--version] [--completion SHELL] COMMAND ...",
        description=_overview(),
        epilog="example: numpy-cae demo\n\n`numpy-cae COMMAND --help` prints options and examples.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--version", action="version", version=f"numpy-cae {__version__}")
    completion = "print what completes commands and options in a shell"
    add("--completion", choices=SHELLS, action=_PrintCompletion, help=completion)
    add("command", nargs="?", choices=list(SUBCOMMANDS), metavar="COMMAND", help=argparse.SUPPRESS)
    return parser


def _whole_parser() -> argparse.ArgumentParser:
    """One parser of all subcommands, which imports all of them."""
    parser = argparse.ArgumentParser("numpy-cae")
    parser.add_argument("--version", action="store_true", help="print the version")
    subcommands = parser.add_subparsers()
    for name, sentence in SUBCOMMANDS.items():
        subcommands.add_parser(
            name,
            parents=[subcommand_parser(name)],
            conflict_handler="resolve",
            help=sentence.replace("%", "%%"),
        )
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
    return max(NARROWEST, min(shutil.get_terminal_size().columns, 81) - 2)


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
