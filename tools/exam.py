"""An exam drawn from the quiz by a seed, and its key in a file of its own.

    python -m tools.exam 2027 exam/ 00 01 03 05     (without numbers: every lesson)

writes exam/exam.md, to be handed out, and exam/key.md. The same seed draws the same questions in
the same order. Of each lesson two questions are drawn that can be marked without judgement: their
answer is a number or one of several choices.
"""

import random
import sys
from pathlib import Path

from tools.gift import QUIZ, Question, questions_of

A_LESSON = 2
LETTERS = "abcd"


def exam(quiz: str, seed: int, numbers: list[str]) -> tuple[str, str]:
    """The text of an exam and that of its key."""
    rng = random.Random(seed)
    lessons: dict[str, list[Question]] = {}
    for each in questions_of(quiz):
        if each.is_marked and (not numbers or each.lesson in numbers):
            lessons.setdefault(each.lesson, []).append(each)
    drawn = [each for every in lessons.values() for each in rng.sample(every, A_LESSON)]
    rng.shuffle(drawn)
    asked = [f"# Exam {seed}", "One point a question. Name: ____________________"]
    key = [f"# Key of exam {seed}"]
    for number, each in enumerate(drawn, 1):
        choices = rng.sample([each.answer, *each.wrong], len(each.wrong) + 1) if each.wrong else []
        lines = [f"{number}. {each.text}"]
        lines += [f"   ({letter}) {text}" for letter, text in zip(LETTERS, choices, strict=False)]
        asked.append("\n".join(lines))
        letter = f"({LETTERS[choices.index(each.answer)]}) " if choices else ""
        key.append(f"{number}. {letter}{each.answer} (lesson {each.lesson}, question {each.place})")
    return "\n\n".join(asked) + "\n", "\n".join(key) + "\n"


def main() -> None:
    """Write the exam and the key."""
    if len(sys.argv) < 3 or not sys.argv[1].isdecimal():
        raise SystemExit("usage: python -m tools.exam SEED FOLDER [LESSON ...]")
    folder = Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    texts = exam(QUIZ.read_text(encoding="utf-8"), int(sys.argv[1]), sys.argv[3:])
    for name, text in zip(("exam.md", "key.md"), texts, strict=True):
        (folder / name).write_text(text, encoding="utf-8")
        print(folder / name)


if __name__ == "__main__":
    main()
