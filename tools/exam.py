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

QUESTIONS_A_LESSON = 2
LETTERS = "abcd"


def exam(quiz: str, seed: int, numbers: list[str]) -> tuple[str, str]:
    """The text of an exam and that of its key."""
    rng = random.Random(seed)
    lessons: dict[str, list[Question]] = {}
    for question in questions_of(quiz):
        if question.is_marked and (not numbers or question.lesson in numbers):
            lessons.setdefault(question.lesson, []).append(question)
    drawn: list[Question] = []
    for questions in lessons.values():
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
