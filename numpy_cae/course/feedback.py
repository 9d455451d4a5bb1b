"""What a notebook shows of a report: colours, the rest folded, and what the function printed."""

import io
from html import escape

from numpy_cae.verify.grading.report import Report

MOST_LINES = 10
"""This many lines of what a function prints are shown; it is tested with hundreds of arrays."""
MOST_CHARACTERS = 4000
"""This many characters of what a function prints are kept."""
RIGHT = "#1b7a3d"
WRONG = "#b3261e"
OPEN = "#5f6368"
TITLE = '<b style="background:{};color:white;border-radius:3px;padding:0 .4em">{}</b>'
TEXT = '<pre style="white-space:pre-wrap;margin:.2em 0">{}</pre>'
FOLDED = "<details><summary>{}</summary>{}</details>"


class Printed(io.TextIOBase):
    """A stream that keeps the beginning of what is printed and counts the lines."""

    def __init__(self) -> None:
        self.beginning = ""
        self.lines = 0

    def write(self, text: str) -> int:
        self.beginning = (self.beginning + text)[:MOST_CHARACTERS]
        self.lines += text.count("\n")
        return len(text)

    def __str__(self) -> str:
        lines = self.beginning.splitlines()[:MOST_LINES]
        more = self.lines - len(lines)
        if more > 0:
            lines.append(f"... {more} more lines: your function is called many times")
        return "".join(f"{line}\n" for line in lines)


class Feedback(Report):
    """A report as a notebook shows it."""

    def items(self) -> list[str]:
        return [item.replace(' example("', ' course.example("') for item in super().items()]

    def _repr_html_(self) -> str:
        title = TITLE.format(self._colour(), escape(" ".join(self.title().split())))
        if self.held:
            statements = [f"{o.property_.name}: {o.property_.statement}" for o in self.outcomes]
            return title + FOLDED.format("what was checked", _text("\n".join(statements)))
        first, *further = self.items()
        hint = _text(further.pop()) if self.exercise.hint else ""
        more = FOLDED.format("other properties, points", _text("\n".join(further)))
        return "".join([title, _text(first), more, hint])

    def _colour(self) -> str:
        if self.held:
            return RIGHT
        return OPEN if self.unsolved else WRONG

    def __dir__(self) -> list[str]:
        """What tab completion offers: the exercise, with its solution, is not among it."""
        return ["held", "points", "possible"]


def _text(text: str) -> str:
    return TEXT.format(escape(text))
