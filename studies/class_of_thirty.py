"""A class of thirty is graded by the command, and some of it by nbgrader: the marks are compared.

    python -m studies class_of_thirty --folder class30             # by the command
    python -m studies class_of_thirty --folder class30 --nbgrader  # six by nbgrader, too

The folder gets the students' copies of lessons 03 and 14, filled in with right answers of three
kinds, known mistakes, stubs, and answers that do not end, do not compile, stop the process, print
without end, replace the check, or import the package; a roster `class.csv`; and the tables. Names
are odd, a third hands in lesson 14, too, one file is late, one student hands in nothing. The table
has how long grading took, how many marks are as expected, and each mark in which the two ways
differ.
"""

import csv
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from numpy_cae.course.catalogue import EXERCISES
from numpy_cae.course.copies import STUBBED, choose_lessons, student_copy
from numpy_cae.course.mistakes import patches_of
from numpy_cae.course.notebook import read_notebook, write_notebook
from numpy_cae.verify.grading.submission import is_exercise
from numpy_cae.verify.operations.catalogue import CATALOGUE as OPERATIONS
from studies.shared.result import Result, Table

ROOT = Path(__file__).parents[1]
LESSONS = ("03", "14")
STYLES = ROOT.joinpath("tests", "course", "right_styles.txt").read_text("utf-8")
NAMES = (
    "ann", "ben", "carla", "david", "eve", "fay", "gus", "hana", "ivo", "jo", "kim", "lea", "max",
    "nia", "otto", "pia", "quin", "rosa", "sam", "tom", "=cmd()", "Zoë Müller", "anna-lena o'hara",
    "03", "a.b", "x" * 200, "\u202egnp", "tab\tname", "李雷", "nothing handed in",
)  # fmt: skip
BY_NBGRADER = (0, 6, 12, 13, 15, 16)
RIGHT_OR_STUBS = (0, 1, 3)

TWICE = """
right = {0}


def {0}(*arguments):
    value, pullback = right(*arguments)
    return value, lambda dy: pullback(2 * dy)
"""
"""TWICE: the gradients of an operation are twice what they should be."""


def task_of(cell: dict) -> str:
    """The exercise of a cell."""
    return cell["metadata"]["nbgrader"]["grade_id"]


def solved(name: str, source: str) -> str:
    """The cell of the instructor's copy."""
    return source


def in_a_style(number: int) -> Callable[[str, str], str]:
    """Another right function, in a style that a student would use."""

    def answer(name: str, source: str) -> str:
        styles = re.findall(rf"^def {name}\(.*?(?=\ndef |\Z)", STYLES, re.DOTALL | re.MULTILINE)
        return styles[number % len(styles)] if styles else source

    return answer


def mistaken(rng: random.Random) -> Callable[[str, str], str]:
    """A wrong function: doubled gradients, or one of the known mistakes, drawn at random."""

    def answer(name: str, source: str) -> str:
        if name in OPERATIONS:
            return source + TWICE.format(name)
        return rng.choice(patches_of(name)).source(name, EXERCISES[name].solution)

    return answer


def beginning(text: str) -> Callable[[str, str], str]:
    """The right function with a line of its own, before all that the cell does."""
    return lambda name, source: f"{text}\n{source}"


def in_the_body(text: str) -> Callable[[str, str], str]:
    """A function whose body is replaced."""

    def answer(name: str, source: str) -> str:
        head = source[: source.index('"""')]
        return f"{head}{text}\n"

    return answer


def loops(name: str, source: str) -> str:
    """Functions that are right, but for one of each lesson, which does not end."""
    endless = in_the_body("while True: pass")
    return endless(name, source) if name in ("unfold", "path_energy") else source


HOSTILE = (
    loops,
    lambda name, source: f"def {name}(\n",
    in_the_body("import os; os._exit(0)"),
    beginning("print('x' * 10**8)"),
    beginning("import numpy_cae.course as course\ncourse.report = lambda *a: 100"),
    beginning("np.array_equal = np.allclose = lambda *a, **k: True"),
    in_the_body("raise SystemExit"),
    lambda name, source: "",
)


def answers(number: int) -> tuple[int, Callable[[str, str], str] | None]:
    """What the student of this number does with an exercise, None to keep the stub; and its kind,
    which is in `RIGHT_OR_STUBS` where the points are known."""
    if 12 <= number < 12 + len(HOSTILE):
        return len(RIGHT_OR_STUBS) + 1, HOSTILE[number - 12]
    kinds = (solved, in_a_style(number), mistaken(random.Random(number)), None)
    kind = number // 3 % len(kinds) if number < 12 else number % 3
    return kind, kinds[kind]


def hand_in(folder: Path) -> dict[tuple[str, str], int]:
    """Write the class's files; the points of students whose answers are all right, or stubs."""
    expected: dict[tuple[str, str], int] = {}
    for path in choose_lessons(ROOT / "lessons", list(LESSONS)):
        for number, name in enumerate(NAMES[:-1]):
            if number % 3 and path.name.startswith("14"):
                continue  # a missing lesson
            kind, answer = answers(number)
            notebook = read_notebook(path)
            copy = student_copy(notebook)
            for cell, right in zip(copy["cells"], notebook["cells"], strict=True):
                if is_exercise(right) and answer:
                    cell["source"] = answer(task_of(right), STUBBED.sub("", right["source"]))
            into = folder / name / path.name
            into.parent.mkdir(parents=True, exist_ok=True)
            write_notebook(copy, into)
            if kind in RIGHT_OR_STUBS:
                tasks = [task_of(cell) for cell in filter(is_exercise, copy["cells"])]
                expected |= {(name, t): EXERCISES[t].points if answer else 0 for t in tasks}
    return expected


def by_command(folder: Path) -> tuple[dict[tuple[str, str], str], list[list[object]]]:
    """Grade the class with its roster; the points of each student's exercise, as text, and rows of
    what was measured."""
    roster = folder / "class.csv"
    table = folder / "marks.csv"
    with roster.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["student", "surname"], *([name, "?"] for name in NAMES)])
    table.unlink(missing_ok=True)
    command = [sys.executable, "-m", "numpy_cae", "verify", str(folder / "class"), "--csv"]
    late = folder / "late.txt"
    late.write_text(f"{NAMES[10]}\n", encoding="utf-8")
    command += [str(table), "--roster", str(roster), "--late", str(late), "--similar"]
    began = time.perf_counter()
    status = subprocess.run([*command, "--feedback", str(folder / "feedback")], check=False)
    measured: list[list[object]] = [["exit status", status.returncode, ""]]
    measured.append(["seconds", round(time.perf_counter() - began), ""])
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    measured.append(["rows, one of them the maxima", len(rows), ""])
    tasks = [task for task in EXERCISES if task in rows[0]]
    marks = {(row["student"], task): row[task] for row in rows[1:] for task in tasks}
    return marks, measured


def by_nbgrader(folder: Path) -> dict[tuple[str, str], float]:
    """The points of some students' exercises by nbgrader, with the configuration of a release."""
    from nbgrader.api import Gradebook

    course = folder / "nbgrader"
    shutil.rmtree(course, ignore_errors=True)
    course.mkdir()
    run = [sys.executable, "-m"]
    release = [*run, "numpy_cae", "lessons", "--release", str(course / "week.zip"), *LESSONS]
    subprocess.run(release, check=True)
    shutil.unpack_archive(course / "week.zip", course)
    for number in BY_NBGRADER:
        shutil.copytree(
            folder / "class" / NAMES[number], course / "submitted" / NAMES[number] / "week"
        )
    for task in (("generate_assignment", "week", "--force"), ("autograde", "week")):
        subprocess.run([*run, "nbgrader", *task], check=True, cwd=course)
    found = {}
    with Gradebook(f"sqlite:///{course / 'gradebook.db'}") as book:
        for submission in book.assignment_submissions("week"):
            for notebook in submission.notebooks:
                for grade in notebook.grades:
                    task = grade.name.removesuffix("_check")
                    found[submission.student.id, task] = grade.score
    return found


def run(folder: Path, nbgrader: bool = False) -> Result:
    """Grade the class both ways; the folder receives its files."""
    shutil.rmtree(folder / "class", ignore_errors=True)
    expected = hand_in(folder / "class")
    marks, rows = by_command(folder)
    written = {key.lstrip("'"): key for key, _ in marks}
    wrong = {k: v for k, v in expected.items() if marks[written.get(k[0], k[0]), k[1]] != str(v)}
    right = f"{len(expected) - len(wrong)} of {len(expected)}"
    rows.append(["marks of right answers and stubs that are as expected", right, str(wrong)])
    if nbgrader:
        found = by_nbgrader(folder)
        other = {k: (marks[k], v) for k, v in found.items() if float(marks[k] or 0) != v}
        rows.append(["marks by nbgrader that differ", f"{len(other)} of {len(found)}", str(other)])
    return Result("A class of thirty", [Table("", ["measured", "value", "differ"], rows)])
