"""The questions of lessons/QUIZ.md as a GIFT file, which Moodle imports into a question bank.

    python -m tools.gift quiz.gift

Moodle marks a question whose answer is one number, and one that has wrong choices, each behind a ✗.
All others are essay questions, marked by the teacher; the answer is their feedback. Canvas imports
QTI and no GIFT: there, copy the questions from QUIZ.md.
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

QUIZ = Path(__file__).parents[1] / "lessons" / "QUIZ.md"
SPECIAL = re.compile(r"([~=#{}:\\])")
NUMBER = re.compile(r"(?:[^;,]*= )?([-−]?\d[\d ]*(?:\.\d+)?)\.?")
"""An answer that is one number, or a calculation that ends with one."""


def escape_gift(text: str) -> str:
    """A text in which the characters that GIFT uses stand for themselves."""
    return SPECIAL.sub(r"\\\1", text)


@dataclass(frozen=True)
class Question:
    """A question of the quiz; `wrong` are the choices that are not its answer."""

    lesson: str
    place: str
    text: str
    answer: str
    wrong: tuple[str, ...]

    @property
    def number(self) -> str:
        """The answer as one number, or ""."""
        number = NUMBER.fullmatch(self.answer)
        return number[1].replace("−", "-").replace(" ", "") if number else ""

    @property
    def is_marked(self) -> bool:
        """Whether a learning platform can mark it."""
        return bool(self.wrong or self.number)

    def as_gift(self) -> str:
        """The question in the format GIFT, with its answer as feedback."""
        name = f"{self.lesson}.{self.place}"
        feedback = f"####{escape_gift(self.answer)}"
        return f"::{name}::[markdown]{escape_gift(self.text)} {{{self._gift_answers()}{feedback}}}"

    def _gift_answers(self) -> str:
        """The choices, or the number with its tolerance; nothing for an essay question."""
        if self.wrong:
            wrong = [f"~{escape_gift(choice)}" for choice in self.wrong]
            return " ".join([f"={escape_gift(self.answer)}", *wrong])
        if "." in self.number:
            return f"#{self.number}:0.0005"
        return f"#{self.number}" if self.number else ""


def questions_of(quiz: str) -> Iterator[Question]:
    """The questions of all lessons, in their order."""
    for lesson in re.split(r"^## ", quiz, flags=re.M)[1:]:
        title, *lines = lesson.splitlines()
        for line in lines:
            if question := re.fullmatch(r"(\d+)\. (.+) → (.+)", line):
                place, text, answers = question.groups()
                answer, *wrong = (choice.rstrip(".") for choice in answers.split(" ✗ "))
                yield Question(title.partition(" ")[0], place, text, answer, tuple(wrong))


def as_gift(quiz: str) -> str:
    """The questions of all lessons, one category each."""
    titles = {title[:3].strip(): title for title in re.findall(r"^## (.+)$", quiz, flags=re.M)}
    blocks = []
    for question in questions_of(quiz):
        category = f"$CATEGORY: numpy_cae/{titles[question.lesson]}"
        if category not in blocks:
            blocks.append(category)
        blocks.append(question.as_gift())
    return "\n\n".join(blocks) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m tools.gift quiz.gift")
    text = as_gift(QUIZ.read_text(encoding="utf-8"))
    Path(sys.argv[1]).write_text(text, encoding="utf-8")
    marked = text.count("::[markdown]") - text.count("{####")
    print(f"{sys.argv[1]}: {text.count('::[markdown]')} questions, Moodle marks {marked} of them")
