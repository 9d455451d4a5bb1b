"""An exam drawn from the quiz by a seed, and its key in a file of its own.

    python -m tools.exam 2027 exam/ 00 01 03 05     (without numbers: every lesson)

writes exam/exam.md, to be handed out, and exam/key.md. The same seed draws the same questions in
the same order. Of each lesson two questions are drawn that can be marked without judgement: their
answer is a number or one of several choices.
"""

import random
import sys
from pathlib import Path
from typing import NoReturn

from tools.gift import QUIZ, Question, questions_of

QUESTIONS_A_LESSON = 2
LETTERS = "abcd"


def exam(quiz: str, seed: int, numbers: list[str]) -> tuple[str, str]:
    """The text of an exam and that of its key.

    Raises
    ------
    ValueError
        The quiz has no questions of a lesson in `numbers`.
    """
    rng = random.Random(seed)
    marked: dict[str, list[Question]] = {}
    for question in questions_of(quiz):
        if question.is_marked:
            marked.setdefault(question.lesson, []).append(question)
    missing = [number for number in numbers if number not in marked]
    if missing:
        raise ValueError(
            f"the quiz has no questions of lesson {', '.join(missing)}; "
            f"its lessons are {', '.join(marked)}"
        )
    drawn: list[Question] = []
    for lesson, questions in marked.items():
        if not numbers or lesson in numbers:
            drawn += rng.sample(questions, QUESTIONS_A_LESSON)
    rng.shuffle(drawn)
    paragraphs = [f"# Exam {seed}", "One point a question. Name: ____________________"]
    key = [f"# Key of exam {seed}"]
    for number, question in enumerate(drawn, 1):
        lines = [f"{number}. {question.text}"]
        answer = question.answer
        if question.wrong:
            choices = [question.answer, *question.wrong]
            choices = rng.sample(choices, len(choices))
            for letter, text in zip(LETTERS, choices, strict=False):
                lines.append(f"   ({letter}) {text}")
            answer = f"({LETTERS[choices.index(question.answer)]}) {answer}"
        paragraphs.append("\n".join(lines))
        key.append(f"{number}. {answer} (lesson {question.lesson}, question {question.place})")
    return "\n\n".join(paragraphs) + "\n", "\n".join(key) + "\n"


def main(arguments: list[str]) -> None:
    """Write the exam and the key; status 2 if the arguments name no exam."""
    if len(arguments) < 2 or not arguments[0].isdecimal():
        stop("usage: python -m tools.exam SEED FOLDER [LESSON ...]")
    try:
        texts = exam(QUIZ.read_text(encoding="utf-8"), int(arguments[0]), arguments[2:])
    except ValueError as error:
        stop(f"No exam is written: {error}.")
    folder = Path(arguments[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in zip(("exam.md", "key.md"), texts, strict=True):
        (folder / name).write_text(text, encoding="utf-8")
        print(folder / name)


def stop(message: str) -> NoReturn:
    """End the program with a message and status 2."""
    print(message, file=sys.stderr)
    raise SystemExit(2)


if __name__ == "__main__":
    main(sys.argv[1:])
