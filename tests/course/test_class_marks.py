"""The marks of a class end to end: exports of Moodle and Canvas, and what comes back to them."""

import csv
import json
import zipfile
from pathlib import Path
from threading import Event

import pytest
from submissions import FRAMES_SEEN, WRONG_FRAMES_SEEN, hand_in

from numpy_cae.cli import main
from numpy_cae.course.marks.class_marks import ClassMarks
from numpy_cae.course.marks.roster import read_roster

EXPORTS = json.loads(Path(__file__).with_name("exports.json").read_text("utf-8"))
CLASS = [
    ("Ann Lee_1327601", FRAMES_SEEN),
    ("Ann Lee_1327602", WRONG_FRAMES_SEEN),
    ("Mu Li_1327603", FRAMES_SEEN),
    ("Li Mu_1327604", FRAMES_SEEN),
]
pytestmark = pytest.mark.usefixtures("shared_grading")


class Marking:
    """A folder of submissions, and the command that marks it."""

    def __init__(self, folder, capsys):
        self.folder = folder
        self.submitted = folder / "in"
        self.table = folder / "marks.csv"
        self.capsys = capsys
        self.options = []

    def hand_in(self, name: str, source: str) -> Path:
        return hand_in(self.submitted / name, source)

    def hand_in_class(self) -> None:
        """What four students of Moodle handed in."""
        for student, source in CLASS:
            self.hand_in(f"{student}_assignsubmission_file/07_going_deep.ipynb", source)

    def use_roster(self, rows: list[str]) -> None:
        roster = self.folder / "grades.csv"
        roster.write_text("\n".join([*rows, ""]), "utf-8")
        self.options = ["--roster", str(roster)]

    def run(self, *options: object) -> str:
        """Mark, and return what is printed."""
        words = [str(option) for option in options]
        command = ["verify", str(self.submitted), "--csv", str(self.table), *self.options, *words]
        self.status = main(command)
        captured = self.capsys.readouterr()
        self.error = captured.err
        return captured.out

    def marks(self) -> dict[str, dict[str, str]]:
        return read_roster(self.table).students

    def imported(self) -> list[dict[str, str]]:
        with (self.folder / "marks_import.csv").open(newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))


@pytest.fixture
def marking(tmp_path, capsys):
    return Marking(tmp_path, capsys)


@pytest.mark.parametrize("export", ["worksheet in English", "worksheet in German"])
def test_moodles_worksheet_gets_its_grades_by_the_number_of_the_row(export, marking):
    marking.use_roster(EXPORTS[export]["rows"])
    marking.hand_in_class()
    printed = marking.run()
    assert "NO ROW" not in printed
    grades = [row[EXPORTS[export]["column"]] for row in marking.imported()]
    assert grades == EXPORTS[export]["grades"]


def test_moodles_worksheet_keeps_its_columns(marking):
    rows = EXPORTS["worksheet in English"]["rows"]
    marking.use_roster(rows)
    marking.hand_in_class()
    marking.run()
    assert (
        ",".join(f'"{name}"' if " " in name else name for name in marking.imported()[0]) == rows[0]
    )


def test_points_of_another_maximum_are_said(marking):
    marking.use_roster(EXPORTS["worksheet in German"]["rows"])
    marking.hand_in_class()
    assert "'Bewertung': 60 points of lesson 07 are 30 there" in marking.run()


def test_a_worksheet_of_one_assignment_refuses_two_lessons(marking):
    marking.use_roster(EXPORTS["worksheet in English"]["rows"])
    marking.hand_in_class()
    marking.hand_in("Zoe Young_1327605_assignsubmission_file/a.ipynb", "def speeds(p, r): 0")
    marking.hand_in("Li Mu_1327604_assignsubmission_file/01_b.ipynb", "def speeds(p, r): 0")
    marking.run()
    assert marking.status == 2 and "there are lessons 01, 07: name the lesson" in marking.error


def in_gradebook(marking):
    """The class of the gradebook: four whose names two rows have, and four others."""
    marking.use_roster(EXPORTS["gradebook of Moodle"])
    marking.hand_in_class()
    for number, name in enumerate(["Bob Ray", "Eve Orr", "Sid Vane", "Kim Park"]):
        marking.hand_in(f"{name}_2{number}_assignsubmission_file/07_going_deep.ipynb", FRAMES_SEEN)


def test_namesakes_in_moodles_gradebook_are_named_first(marking):
    in_gradebook(marking)
    first = marking.run().splitlines()[0]
    row = "NO ROW      Ann Lee 1327601: it may be ann.lee@uni.example or ann.lee2@uni.example"
    assert first == row


def test_mirrored_names_in_moodles_gradebook_are_named(marking):
    in_gradebook(marking)
    printed = marking.run()
    assert "NO ROW      Li Mu 1327604: it may be mu.li@uni.example or li.mu@uni.example" in printed


def test_rows_that_a_submission_may_belong_to_are_not_0(marking):
    in_gradebook(marking)
    marking.run()
    points = {row["Email address"]: row["Lesson 07"] for row in marking.imported()}
    assert {
        points[f"{name}@uni.example"] for name in ("ann.lee", "ann.lee2", "mu.li", "li.mu")
    } == {""}
    assert points["zoe@uni.example"] == "0" and points["bob@uni.example"] == "10"


def test_a_submission_without_a_row_is_a_status_1(marking):
    marking.use_roster(["student", "ann", "bob"])
    marking.hand_in("ann_07.ipynb", FRAMES_SEEN)
    marking.run()
    with_rows = marking.status
    marking.hand_in("cem_07.ipynb", FRAMES_SEEN)
    assert "left empty, since cem may be it" in marking.run()
    assert [row["Lesson 07"] for row in marking.imported()] == ["10", ""]
    assert with_rows == marking.status == 1  # a lesson with one exercise of six is not all right


def test_canvas_gets_its_own_column(marking):
    marking.use_roster(EXPORTS["gradebook of Canvas"])
    marking.hand_in("leeann_501_77_07_going_deep.ipynb", FRAMES_SEEN)
    marking.hand_in("youngzoe_502_78_07_going_deep.ipynb", WRONG_FRAMES_SEEN)
    marking.run()
    possible, ann, zoe, bob = marking.imported()
    assert "Lesson 07" not in ann
    column = [row["Lesson 07 (8812)"] for row in (possible, ann, zoe, bob)]
    assert column == ["60", "10", "0", "0"]


def test_canvas_keeps_the_grade_of_a_row_that_is_uncertain(marking):
    rows = [row.replace(",,70", ",55,70") for row in EXPORTS["gradebook of Canvas"]]
    marking.use_roster(rows)
    marking.hand_in("leeann_501_77_07_going_deep.ipynb", FRAMES_SEEN)
    marking.hand_in("raybob_503_79_notebook.html", FRAMES_SEEN)
    marking.run()
    assert marking.imported()[-1]["Lesson 07 (8812)"] == "55"


def test_two_odd_files_change_nobodys_maximum(marking):
    for student in "abcdefghi":
        marking.hand_in(f"{student}_07.ipynb", FRAMES_SEEN)
    for student in "yz":
        marking.hand_in(f"{student}_00.ipynb", "def square(x):\n    return x * x, None")
    marking.run()
    marks = marking.marks()
    assert "square" not in marks["a"] and marks["a"]["possible"] == "60"
    assert "y_00.ipynb is not counted: few handed its lesson in" in marks["y"]["problems"]


@pytest.mark.parametrize("name", ["a.html", "a.pdf", "a.rar", "mine.py", "notes"])
def test_what_cannot_be_graded_is_named_with_feedback(name, marking):
    document = marking.submitted / "Ann Lee_12_assignsubmission_file" / name
    document.parent.mkdir(parents=True)
    document.write_text("x = 1")
    marking.hand_in("Bob Ray_13_assignsubmission_file/07_going_deep.ipynb", FRAMES_SEEN)
    marking.run("--feedback", marking.folder / "feedback")
    assert f"{name} is handed in" in marking.marks()["Ann Lee 12"]["problems"]
    (feedback,) = (marking.folder / "feedback").glob("Ann*.md")
    assert f"{name} is handed in" in feedback.read_text()


def test_a_page_in_a_zip_is_named(marking):
    marking.submitted = marking.folder / "in.zip"
    with zipfile.ZipFile(marking.submitted, "w") as packed:
        packed.writestr("ann/a.html", "<p>")
        packed.writestr("bob/a.html", "<p>")
        packed.writestr("bob/07_bob.py", FRAMES_SEEN)
    printed = marking.run()
    assert "NOT GRADED  ann: a.html: a.html is handed in, and a .html cannot be graded" in printed
    assert "bob: a.html" not in printed


def test_a_correction_counts_in_every_run_and_is_printed(marking):
    marking.hand_in("bob_07.ipynb", WRONG_FRAMES_SEEN)
    corrections = "student,exercise,points,reason\nbob,frames_seen,8,appeal\n"
    (marking.folder / "corrections.csv").write_text(corrections)
    marking.run()
    assert "NOT AS NOW  bob: frames_seen: corrected to 8 from 0 (appeal)" in marking.run()
    assert marking.marks()["bob"]["frames_seen"] == "8"


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("bob,frames,8,x", "there is no such exercise"),
        ("bob,frames_seen,11,x", "whole numbers from 0 to 10 are possible"),
        ("bob,frames_seen,8,", "the reason is missing"),
        (",frames_seen,8,x", "a student and points are needed"),
    ],
)
def test_a_wrong_correction_is_refused(line, problem, marking):
    marking.hand_in("bob_07.ipynb", FRAMES_SEEN)
    (marking.folder / "corrections.csv").write_text(f"student,exercise,points,reason\n{line}\n")
    marking.run()
    assert marking.status == 2 and problem in marking.error


def test_a_correction_of_nobody_is_listed_first(marking):
    marking.hand_in("bob_07.ipynb", FRAMES_SEEN)
    corrections = "student,exercise,points,reason\nbo,frames_seen,8,x\n"
    (marking.folder / "corrections.csv").write_text(corrections)
    assert marking.run().startswith("NO STUDENT  corrections.csv: bo, frames_seen")


def test_the_best_of_all_runs_counts_and_is_said(marking):
    marking.hand_in("bob_07.ipynb", FRAMES_SEEN)
    marking.run()
    marking.hand_in("bob_07.ipynb", WRONG_FRAMES_SEEN)
    note = "frames_seen: 10 points of an earlier run count, not 0"
    assert f"NOT AS NOW  bob: {note}" in marking.run()
    assert marking.marks()["bob"]["frames_seen"] == "10"


def test_the_table_is_written_after_each_file(marking, monkeypatch):
    from numpy_cae.verify.grading import student_file

    graded = student_file.run
    write_marks = ClassMarks.write_marks
    is_written = Event()
    tables = []

    def write(marks, reports):
        write_marks(marks, reports)
        is_written.set()

    def run(request):
        if request["path"].endswith("c_07.ipynb"):
            is_written.wait(timeout=30)  # in another thread, while this one graded the next file
            tables.append(marking.marks())
        return graded(request)

    monkeypatch.setattr(ClassMarks, "write_marks", write)
    monkeypatch.setattr(student_file, "run", run)
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    for student in "abc":
        marking.hand_in(f"{student}_07.ipynb", FRAMES_SEEN)
    marking.run()
    assert tables[0]["a"]["frames_seen"] == "10"
    assert tables[0]["c"]["problems"] == "not graded yet"


def test_every_member_of_a_team_gets_its_marks(marking):
    marking.use_roster(["student", "ann", "bob", "cem"])
    marking.hand_in("ann_07.ipynb", FRAMES_SEEN)
    marking.hand_in("cem_07.ipynb", WRONG_FRAMES_SEEN)
    teams = marking.folder / "teams.txt"
    teams.write_text("ann, bob\n")
    assert "NO FILE" not in marking.run("--teams", teams)
    assert [row["Lesson 07"] for row in marking.imported()] == ["10", "10", "0"]


def test_feedback_goes_back_to_moodle_and_canvas(marking):
    marking.hand_in("Ann Lee_12_assignsubmission_file/07_going_deep.ipynb", FRAMES_SEEN)
    marking.hand_in("raybob_LATE_503_79_07_going_deep.ipynb", WRONG_FRAMES_SEEN)
    marking.run("--feedback", marking.folder / "feedback.zip")
    with zipfile.ZipFile(marking.folder / "feedback.zip") as packed:
        names = packed.namelist()
        notebook = json.loads(packed.read("raybob_LATE_503_79_feedback.ipynb"))
    assert "Ann Lee_12_assignsubmission_file_feedback.md" in names
    assert "frames_seen: 0 of 10 points" in notebook["cells"][0]["source"]


def test_moodle_finds_whose_feedback_a_file_is(marking):
    """By the rule of mod/assign/feedback/file/importziplib.php."""
    marking.hand_in("Ann Lee_12_assignsubmission_file/07_going_deep.ipynb", FRAMES_SEEN)
    marking.run("--feedback", marking.folder / "feedback.zip")
    with zipfile.ZipFile(marking.folder / "feedback.zip") as packed:
        (name,) = packed.namelist()
    _, number, kind, plugin, file = name.split("_", 4)
    assert (number, kind, plugin, file) == ("12", "assignsubmission", "file", "feedback.md")


def test_moodle_finds_the_columns_and_the_participant_of_a_worksheet(marking):
    """By the rule of mod/assign/feedback/offline/importgradeslib.php, in English."""
    marking.use_roster(EXPORTS["worksheet in English"]["rows"])
    marking.hand_in_class()
    marking.run()
    graded = {}
    for row in marking.imported():
        assert row["Last modified (grade)"] == "-"
        graded[row["Identifier"].removeprefix("Participant ")] = float(row["Grade"])
    assert graded["1327601"] == 10.0 and graded["1327602"] == 0.0


def test_a_lesson_that_was_counted_stays_when_the_class_grows(marking):
    for name in ("a_07.ipynb", "b_01.ipynb"):
        marking.hand_in(name, FRAMES_SEEN if "07" in name else "def speeds(p, r):\n    return 0")
    marking.run()
    for student in "cdefgh":
        marking.hand_in(f"{student}_07.ipynb", FRAMES_SEEN)
    marking.run()
    assert marking.marks()["b"]["speeds"] == "0"


def test_a_correction_counts_in_a_lesson_of_few(marking):
    for student in "abcde":
        marking.hand_in(f"{student}_07.ipynb", FRAMES_SEEN)
    corrections = "student,exercise,points,reason\na,speeds,7,shown in the lesson\n"
    (marking.folder / "corrections.csv").write_text(corrections)
    marking.run()
    assert marking.marks()["a"]["speeds"] == "7"


def test_results_for_programs(marking):
    marking.hand_in("ann_07.ipynb", FRAMES_SEEN)
    marking.run("--json", marking.folder / "results.json")
    results = json.loads((marking.folder / "results.json").read_text("utf-8"))["results"]
    first = {name: results[0][name] for name in ("student", "exercise", "points", "possible")}
    assert first == {"student": "ann", "exercise": "frames_seen", "points": 10, "possible": 10}
    assert "frames_seen: it holds" in results[0]["text"]


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b'"' + 200_000 * b"x" + b'"\nann\n', "line 1: field larger than field limit"),
        (b"\xff\xfe\x00\xd8a\x00", "it begins as UTF-16, and byte 2 is not: save it as UTF-8"),
        (b"\xef\xbb\xbfstudent\nL\xf6we\n", "it begins as UTF-8"),
    ],
)
def test_an_odd_roster_ends_in_a_sentence(content, problem, marking):
    marking.hand_in("ann_07.ipynb", FRAMES_SEEN)
    marking.use_roster(["student"])
    (marking.folder / "grades.csv").write_bytes(content)
    marking.run()
    assert marking.status == 2 and problem in marking.error


def test_a_roster_in_utf_32_is_read(marking):
    marking.hand_in("löwe_07.ipynb", FRAMES_SEEN)
    marking.use_roster(["student"])
    (marking.folder / "grades.csv").write_bytes("student\nlöwe\n".encode("utf-32"))
    assert "löwe        löwe, by student löwe" in marking.run()
