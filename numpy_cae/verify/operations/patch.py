"""An operation with some lines of its source replaced: a planted bug, or another convention.

The patches of an operation are in a text file that has its name, one after the other:

    tanh_derivative_of_x (gradient for x)
        The derivative is 1 - x², where it should be 1 - y².
        - return dy * (1 - y * y)
        + return dy * (1 - x * x)

In parentheses is the property that catches the change. Lines with a minus are found in the source
of the operation, apart from their indentation, and replaced by the lines with a plus that follow
them. There may be several such replacements.
"""

import ast
import inspect
import re
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from numpy_cae.verify.operations.operation import OPERATIONS

FOLDER = Path(__file__).parent
HEADER = re.compile(r"(\w+) \(([\w ]*)\)")


@dataclass(frozen=True)
class Patch:
    """A change of one operation, and the property that catches it."""

    name: str
    operation: str
    caught_by: str
    sentence: str
    replacements: tuple[tuple[str, str], ...]  # of old lines by new ones
    calls: tuple["Patch", ...] = ()  # of the operations that it calls

    @cache  # noqa: B019 (there are few patches, which live as long as the program)
    def function(self) -> Callable:
        """The changed operation; a ValueError if the patch does not fit the operation's source."""
        return self.applied_to(OPERATIONS[self.operation].reference)

    def applied_to(self, right: Callable) -> Callable:
        """A right function, changed by the patch."""
        namespace = dict(right.__globals__)
        namespace |= {called.operation: called.function() for called in self.calls}
        exec(compile(self.source(self.name, right), f"<{self.name}>", "exec"), namespace)
        return namespace[self.name]

    def source(self, called: str = "suspect", right: Callable | None = None) -> str:
        """The source of the changed operation, under another name and without its docstring.

        A ValueError if the patch does not fit.
        """
        text = source_of(right or OPERATIONS[self.operation].reference)
        for old, new in self.replacements:
            lines = r"\n *".join(re.escape(line.strip()) for line in old.splitlines())
            places = [*re.finditer(rf"^( *){lines}$", text, re.MULTILINE)]
            if len(places) != 1:
                raise ValueError(f"{self.name}: found {len(places)} times, expected once: {old}")
            (place,) = places
            text = text[: place.start()] + textwrap.indent(new, place[1]) + text[place.end() :]
        return text.replace(f"def {self.operation}(", f"def {called}(", 1)


def read_patches(folder: Path) -> tuple[Patch, ...]:
    """The patches in the text files of a folder."""
    paths = sorted(folder.glob("*.txt"))
    return tuple(p for path in paths for p in patches_in(path.read_text("utf-8"), path.stem))


def patches_in(text: str, operation: str) -> Iterator[Patch]:
    """The patches of an operation in a text of the form above."""
    for block in re.split(r"\n(?=\w)", text.strip()):
        header, text = block.split("\n", 1)
        name, caught_by = HEADER.fullmatch(header).groups()
        text = textwrap.dedent(text)
        sentence = " ".join(re.findall(r"^[^-+].*", text, re.M))
        pairs = re.findall(r"((?:^-.*\n)+)((?:^\+.*\n?)+)", text + "\n", re.M)
        replacements = tuple((_unmarked(old), _unmarked(new)) for old, new in pairs)
        yield Patch(name, operation, caught_by, sentence, replacements)


def _unmarked(lines: str) -> str:
    return re.sub("^[-+] ?", "", lines.rstrip("\n"), flags=re.M)


@cache
def source_of(function: Callable) -> str:
    """The source of a function, without its docstring and comments."""
    source = inspect.getsource(function)
    (function,) = ast.parse(source).body
    lines = source.splitlines()
    docstring = function.body[0]
    kept = lines[: docstring.lineno - 1] + lines[docstring.end_lineno :]
    code = (line.partition("  # ")[0] for line in kept if not line.strip().startswith("#"))
    return "\n".join(code)


BUGS = read_patches(FOLDER / "planted_bugs")
"""Classic mistakes in derivatives, each caught by the property that it names."""
CONVENTIONS = read_patches(FOLDER / "conventions")
"""Other conventions of an operation: right in their own way, but not what the contract says."""


def bugs_of(operation: str) -> tuple[Patch, ...]:
    """The bugs of one operation."""
    return tuple(bug for bug in BUGS if bug.operation == operation)


def bug_named(name: str) -> Patch:
    """The bug of this name; a KeyError if there is none."""
    return {bug.name: bug for bug in BUGS}[name]


@cache
def conventions_of(operation: str) -> tuple[Patch, ...]:
    """The documented conventions other than ours; those of `gru` are those of its step."""
    if operation == "gru":
        steps = conventions_of("gru_step")
        return tuple(Patch(s.name, "gru", "", s.sentence, (), calls=(s,)) for s in steps)
    return tuple(patch for patch in CONVENTIONS if patch.operation == operation)
