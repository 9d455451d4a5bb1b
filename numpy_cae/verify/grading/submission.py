"""What a student hands in: a file of Python, or cells that are run one after the other."""

import re
from dataclasses import dataclass
from pathlib import Path

SUFFIXES = (".py", ".ipynb")
"""What files that are graded end with."""
LARGEST_PROGRAM = 2**20
"""A Python file may have at most this many bytes."""
DEFINITION = re.compile(r"^def (\w+)\(", re.MULTILINE)


@dataclass(frozen=True)
class Submission:
    """A student's file. `cells` are the parts that are run: (name, text).

    A Python file is one part, of bytes; a notebook (`is_notebook`) has parts of text. `fault` says
    why a file cannot be read. What reads notebooks may say to which `lesson` the file belongs, of
    which functions the cell was `copied`, and what costs no points, as `notes`.
    """

    path: Path
    cells: tuple[tuple[str, str | bytes], ...] = ()
    is_notebook: bool = False
    lesson: str = ""
    copied: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    fault: str = ""

    def functions_defined(self) -> set[str]:
        """The names of functions in the text, even if the text is not valid Python."""
        return names_defined(self._text())

    def calls(self, name: str) -> bool:
        """Whether the text seems to call a function, besides defining it."""
        calls = re.findall(rf"(?<![.\w]){name}\(", self._text())
        definitions = 1 if name in self.functions_defined() else 0
        return len(calls) > definitions

    def _text(self) -> str:
        texts = []
        for _, source in self.cells:
            texts.append(source if isinstance(source, str) else source.decode("latin-1"))
        return "\n".join(texts)


def read_submission(path: Path) -> Submission:
    """Read a Python file as it is; one that is too large, or no file, has a fault."""
    try:
        return Submission(path, ((str(path), read_bytes(path, LARGEST_PROGRAM)),))
    except (ValueError, OSError) as error:
        return Submission(path, fault=str(error))


def read_bytes(path: Path, largest: int) -> bytes:
    """The contents of a file of at most so many bytes.

    Raises
    ------
    ValueError
        If it is larger, or no file.
    """
    if not path.is_file():
        raise ValueError("it is no file" if path.exists() else "there is no such file")
    with path.open("rb") as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise ValueError(f"it is larger than {largest // 2**20} MB")
    return content


def names_defined(text: str) -> set[str]:
    """The names of the functions that a text defines."""
    return set(DEFINITION.findall(text))
