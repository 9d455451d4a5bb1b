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
        return self.applied_to(definition_of(self.operation))

    def applied_to(self, right: Callable) -> Callable:
        """A right function, changed by the patch."""
        namespace = dict(right.__globals__)
        for called in self.calls:
            namespace[called.operation] = called.function()
        exec(compile(self.source(self.name, right), f"<{self.name}>", "exec"), namespace)
        return namespace[self.name]

    def source(self, called: str = "suspect", right: Callable | None = None) -> str:
        """The source of the changed operation, under another name and without its docstring.

        A ValueError if the patch does not fit.
        """
        text = source_of(right or definition_of(self.operation))
        for old, new in self.replacements:
            lines = [re.escape(line.strip()) for line in old.splitlines()]
            pattern = r"\n *".join(lines)
            places = list(re.finditer(rf"^( *){pattern}$", text, re.MULTILINE))
            if len(places) != 1:
                raise ValueError(f"{self.name}: found {len(places)} times, expected once: {old}")
            place = places[0]
            text = text[: place.start()] + textwrap.indent(new, place[1]) + text[place.end() :]
        return text.replace(f"def {self.operation}(", f"def {called}(", 1)


def definition_of(name: str) -> Callable:
    """The definition of an operation: its value and its pullback."""
    definition = OPERATIONS[name].reference
    if definition is None:
        raise ValueError(f"{name} has no definition with a pullback")
    return definition


def read_patches(folder: Path) -> tuple[Patch, ...]:
    """The patches in the text files of a folder."""
    patches: list[Patch] = []
    for path in sorted(folder.glob("*.txt")):
        patches += patches_in(path.read_text("utf-8"), path.stem)
    return tuple(patches)


HEADER = re.compile(r"(\w+) \(([\w ]*)\)")
REPLACEMENT = re.compile(r"((?:^-.*\n)+)((?:^\+.*\n?)+)", re.MULTILINE)
"""Lines with a minus, and the lines with a plus that replace them."""


def patches_in(text: str, operation: str) -> Iterator[Patch]:
    """The patches of an operation in a text of the form above."""
    for block in re.split(r"\n(?=\w)", text.strip()):
        header, _, indented = block.partition("\n")
        match = HEADER.fullmatch(header)
        if match is None:
            raise ValueError(f"{operation}: a patch begins with a name and (property): {header}")
        name, caught_by = match.groups()
        lines = textwrap.dedent(indented)
        sentence = " ".join(re.findall(r"^[^-+].*", lines, re.MULTILINE))
        pairs = REPLACEMENT.findall(lines + "\n")
        replacements = tuple((_without_marks(old), _without_marks(new)) for old, new in pairs)
        yield Patch(name, operation, caught_by, sentence, replacements)


def _without_marks(lines: str) -> str:
    """Lines without the minus or plus before each."""
    return re.sub("^[-+] ?", "", lines.rstrip("\n"), flags=re.MULTILINE)


@cache
def source_of(function: Callable) -> str:
    """The source of a function, without its docstring and comments."""
    source = inspect.getsource(function)
    definition = ast.parse(source).body[0]
    if not isinstance(definition, ast.FunctionDef):
        raise ValueError(f"{function} is not defined with def")
    docstring = definition.body[0]
    lines = source.splitlines()
    code = []
    for number, line in enumerate(lines, 1):
        is_docstring = docstring.lineno <= number <= (docstring.end_lineno or 0)
        if not is_docstring and not line.strip().startswith("#"):
            code.append(line.partition("  # ")[0])
    return "\n".join(code)


BUGS = read_patches(FOLDER / "planted_bugs")
"""Classic mistakes in derivatives, each caught by the property that it names."""
CONVENTIONS = read_patches(FOLDER / "conventions")
"""Other conventions of an operation: right in their own way, but not what the contract says."""
_BUGS_BY_NAME = {bug.name: bug for bug in BUGS}


def bugs_of(operation: str) -> tuple[Patch, ...]:
    """The bugs of one operation."""
    return tuple(bug for bug in BUGS if bug.operation == operation)


def bug_named(name: str) -> Patch:
    """The bug of this name; a KeyError if there is none."""
    return _BUGS_BY_NAME[name]


@cache
def conventions_of(operation: str) -> tuple[Patch, ...]:
    """The documented conventions other than ours; those of `gru` are those of its step."""
    if operation == "gru":
        conventions = []
        for step in conventions_of("gru_step"):
            conventions.append(Patch(step.name, "gru", "", step.sentence, (), calls=(step,)))
        return tuple(conventions)
    return tuple(patch for patch in CONVENTIONS if patch.operation == operation)
