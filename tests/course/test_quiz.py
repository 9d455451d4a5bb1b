"""The quiz, the exam drawn from it, the public exam, and the plans for teachers."""

import re
from pathlib import Path

import pytest

from tools import exam
from tools.gift import QUIZ, Question, questions_of

LESSONS = Path(__file__).parents[2] / "lessons"
QUESTIONS = list(questions_of(QUIZ.read_text(encoding="utf-8")))
CONTINUES = re.compile(
    r"^(Its|Of the|At that|Why\?|The gradient for \w\?|Which of them)|^What is its|^dy = .*db"
    r"|^How (long )?is that|three of them|for these|gradient there|left out of the count"
)
"""Words that refer to the question before, as questions of the quiz had them."""


def choices() -> list[Question]:
    return [question for question in QUESTIONS if question.wrong]


@pytest.mark.parametrize(
    "text",
    [
        "What are the last three of them?",
        "dy = (1, 10, 100). What is db?",
        "dy = (7, 9) for these. What is dx, if a tie goes to the earlier frame?",
        "Its pullback of dx = (1, 2, 3, 4)?",
        "Its gradient there?",
        "Its gradient for x̂?",
        "Of the second layer?",
        "How long is that at thirty frames a second?",
        "At that rate, by which factor is u multiplied in a step?",
        "What is its first input?",
        "Why?",
        "The gradient for p?",
        "Which of them is best in one dimension?",
        "How is that avoided?",
    ],
)
def test_a_question_that_continues_another_is_recognised(text):
    assert CONTINUES.search(text)


def test_no_question_of_the_quiz_continues_another():
    assert [question.text for question in QUESTIONS if CONTINUES.search(question.text)] == []


def test_the_right_choice_is_the_longest_about_as_often_as_by_chance():
    """Of three choices the longest is right in a third; a choice as long as it counts, too."""
    questions = choices()
    longest = sum(len(q.answer) >= max(map(len, q.wrong)) for q in questions)
    assert 0.28 < longest / len(questions) < 0.42


def test_the_right_choice_is_not_the_shortest_more_often_than_by_chance():
    questions = choices()
    shortest = sum(len(q.answer) <= min(map(len, q.wrong)) for q in questions)
    assert shortest / len(questions) < 0.42


def test_no_choice_of_a_question_stands_twice():
    for question in choices():
        assert len({question.answer, *question.wrong}) == 1 + len(question.wrong), question.text


@pytest.mark.parametrize(
    ("numbers", "missing"), [(["99"], "99"), (["03", "7"], "7"), (["99", "98"], "99, 98")]
)
def test_an_exam_of_a_lesson_without_questions_is_an_error(numbers, missing, tmp_path, capsys):
    with pytest.raises(SystemExit) as stopped:
        exam.main(["1", str(tmp_path / "exam"), *numbers])
    assert stopped.value.code == 2
    assert f"the quiz has no questions of lesson {missing};" in capsys.readouterr().err
    assert not (tmp_path / "exam").exists()


def test_an_exam_of_named_lessons_is_written(tmp_path):
    exam.main(["1", str(tmp_path / "exam"), "03", "07b"])
    assert len(re.findall(r"^\d\. ", (tmp_path / "exam" / "exam.md").read_text("utf-8"), re.M)) == 4


def plans() -> dict[str, list[str]]:
    """The rows of each plan, by the number of its weeks."""
    text = (LESSONS / "TEACHING.md").read_text(encoding="utf-8")
    sections = re.findall(r"^## (\w+) weeks.*?\n(.*?)(?=^## )", text, re.M | re.S)
    return {weeks: re.findall(r"^\|.*$", body, re.M) for weeks, body in sections}


@pytest.mark.parametrize("weeks", ["Two", "Six", "Eight", "Twelve"])
def test_a_plan_names_07b_before_08(weeks):
    lessons = re.findall(r"\b(07b|08)\b", "\n".join(plans()[weeks]))
    assert "08" in lessons
    assert lessons[0] == "07b"


@pytest.mark.parametrize("lesson", ["07b", "08", "10", "11"])
def test_the_public_exam_covers_a_lesson(lesson):
    text = (LESSONS / "EXAM.md").read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith("| lesson |"))
    assert lesson in row.replace("|", " ").split()


def test_each_question_of_the_public_exam_has_points_and_a_solution():
    text = (LESSONS / "EXAM.md").read_text(encoding="utf-8")
    questions, solutions = text.partition("## Questions")[2].split("## Solutions")
    points = next(line for line in text.splitlines() if line.startswith("| points |"))
    values = [int(value) for value in re.findall(r"\d+", points)]
    asked = re.findall(r"^\d+\. .*$", questions, re.M)
    assert len(values) == len(asked) == len(re.findall(r"^\d+\. ", solutions, re.M))
    for question, value in zip(asked, values, strict=True):
        parts = re.findall(r"\((\d+)\)", question)
        assert sum(map(int, parts)) == value or not parts, question
    assert f"{sum(values)} points" in text
