"""The questions of lessons/QUIZ.md as a GIFT file, which Moodle imports into a question bank.

    python -m tools.gift quiz.gift

A question whose answer is one number is marked by Moodle. All others are essay questions, marked by
the teacher; the answer is their feedback. Canvas imports QTI and no GIFT: there, copy the questions
from QUIZ.md.
"""

import re
import sys
from pathlib import Path

QUIZ = Path(__file__).parents[1] / "lessons" / "QUIZ.md"
SPECIAL = re.compile(r"([~=#{}:\\])")
NUMBER = re.compile(r"(?:[^;,]*= )?([-−]?\d[\d ]*(?:\.\d+)?)\.?")
"""An answer that is one number, or a calculation that ends with one."""


def escaped(text: str) -> str:
    """A text in which the characters that GIFT uses stand for themselves."""
    return SPECIAL.sub(r"\\\1", text)


def as_gift(quiz: str) -> str:
    """The questions of all lessons, one category each."""
    blocks = []
    for lesson in re.split(r"^## ", quiz, flags=re.M)[1:]:
        title, *lines = lesson.splitlines()
        blocks.append(f"$CATEGORY: numpy_cae/{title}")
        for line in lines:
            if asked := re.fullmatch(r"(\d+)\. (.+) → (.+)", line):
                place, question, answer = asked.groups()
                name = f"{title.partition(' ')[0]}.{place}"
                number = NUMBER.fullmatch(answer)
                plain = number[1].replace("−", "-").replace(" ", "") if number else ""
                answers = f"#{plain}" + ":0.0005" * ("." in plain) if plain else ""
                kept = f"####{escaped(answer)}"
                text = escaped(question)
                blocks.append(f"::{name}::[markdown]{text} {{{answers}{kept}}}")
    return "\n\n".join(blocks) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m tools.gift quiz.gift")
    text = as_gift(QUIZ.read_text(encoding="utf-8"))
    Path(sys.argv[1]).write_text(text, encoding="utf-8")
    marked = text.count("{#") - text.count("{####")
    print(f"{sys.argv[1]}: {text.count('::[markdown]')} questions, Moodle marks {marked} of them")
