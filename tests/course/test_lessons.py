"""Every lesson from a fresh kernel: the instructor's copy, and the student's, nothing solved.

The numbers in the lessons' prose are those of the cells.

A number with a decimal point, a percentage, or a number with a unit of length or time that stands
in a lesson's text or formulas has to stand in a code cell of the same lesson, too: in its source
(a setting, an example, an assertion) or in what it printed. Printed numbers may have more digits;
28% may be printed as 0.28. So:

- Write a derivation's numbers beside a cell that computes and prints them.
- Do not quote a result that depends on the time, the machine or the data: let the cell print the
  sentence, or say in words what holds on any data.
- A number of the papers stands in quotation marks ("a factor of 0.9") or in `code`: these and the
  addresses of links are not compared.
"""

import base64
import hashlib
import html
import json
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from numpy_cae import viz
from numpy_cae.course import catalogue
from numpy_cae.course.catalogue import EXERCISES
from numpy_cae.course.catalogue import LESSONS as EXERCISES_OF
from numpy_cae.course.notebooks import (
    MILESTONES,
    find_lessons,
    number_of,
    read_notebook,
    student_copy,
)
from numpy_cae.course.submitted_file import is_exercise
from numpy_cae.motion import PARENTS
from numpy_cae.verify.grading.student_file import grade
from tools.exam import exam
from tools.execute_lessons import execute, mine_before, shorten, source_hash
from tools.gallery import FIRST_PICTURE, MADE_OF, picture_of, picture_path
from tools.gift import QUIZ, as_gift
from tools.slides import MOTIONS, NOTE, STEP, deck, slides_of, unpack_motions, with_still

FOLDER = Path(__file__).parents[2] / "lessons"
LESSONS = find_lessons(FOLDER)
DRAWS = ("plt.show()", "viz.strip_figure(", "viz.in_notebook(", "viz.slider_figure(")
LARGEST, LARGEST_PICTURE = 1_550_000, 70_000  # a lesson begins with a copy of its picture

every_lesson = pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)
AND_MILESTONES = [*LESSONS, *sorted(FOLDER.glob(MILESTONES))]
every_notebook = pytest.mark.parametrize("path", AND_MILESTONES, ids=lambda path: path.stem)


def checks(notebook: dict) -> list[dict]:
    return [c for c in notebook["cells"] if c["metadata"].get("nbgrader", {}).get("grade")]


def points_of(cell: dict) -> int:
    return EXERCISES[cell["metadata"]["nbgrader"]["grade_id"].removesuffix("_check")].points


def assert_all_points(notebook: dict) -> None:
    for cell in checks(notebook):
        points, text = points_of(cell), shown(cell, "text/plain")
        assert f" {points} of {points} points" in text and "FAILED" not in text, text


def shown(cell: dict, kind: str) -> str:
    """What a cell shows in one of the forms of its outputs."""
    return "".join("".join(o.get("data", {}).get(kind, "")) for o in cell.get("outputs", ()))


def pictures(notebook: dict) -> tuple[int, int]:
    """How many cells of a notebook show a picture, and how many an animation."""
    drawn = [bool(shown(cell, "image/png")) for cell in notebook["cells"]]
    return sum(drawn), sum("motion-viewer" in shown(c, "text/html") for c in notebook["cells"])


@every_notebook
def test_stored_as_executed(path):
    notebook = read_notebook(path)
    assert notebook["metadata"]["numpy_cae"]["source_hash"] == source_hash(notebook), (
        f"the outputs are older than the source: python -m tools.execute_lessons {number_of(path)}"
    )
    assert path.stat().st_size < LARGEST
    drawn, moving = pictures(notebook)
    assert drawn >= 2 and moving >= 1
    text = path.read_text(encoding="utf-8")
    assert '"output_type": "error"' not in text and '"name": "stderr"' not in text
    counts = [cell["execution_count"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert counts == list(range(1, len(counts) + 1))
    assert_all_points(notebook)


@every_lesson
def test_its_picture_in_the_gallery_is_of_its_outputs(path):
    picture, number = picture_path(path), number_of(path)
    shown = hashlib.sha256(picture_of(read_notebook(path))).hexdigest()
    with Image.open(picture) as stored:
        assert stored.info[MADE_OF] == shown, f"run: python -m tools.gallery {number}"
    assert picture.stat().st_size < LARGEST_PICTURE
    (cell,) = [each for each in read_notebook(path)["cells"] if each["id"] == FIRST_PICTURE]
    attached = cell["attachments"][f"{number}.png"]["image/png"]
    assert base64.b64decode(attached) == picture.read_bytes(), f"python -m tools.gallery {number}"
    assert f"](attachment:{number}.png)" in cell["source"]
    listed = f'<a href="{path.name}"><img src="pictures/{number}.png"'
    assert listed in FOLDER.joinpath("README.md").read_text(encoding="utf-8")


@every_notebook
def test_every_picture_has_an_alternative_text_of_its_own(path):
    texts = []
    for cell in read_notebook(path)["cells"]:
        for output in cell.get("outputs", ()):
            if "image/png" in output.get("data", {}):
                texts.append(output["metadata"]["image/png"]["alt"])
    assert min(map(len, texts)) > 30 and len(set(texts)) == len(texts)


@every_lesson
def test_marked_for_nbgrader_and_without_solutions_in_the_student_copy(path):
    notebook = read_notebook(path)
    cells, ids = notebook["cells"], [cell["id"] for cell in notebook["cells"]]
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    assert len(set(ids)) == len(ids) and cells[0]["source"].startswith("# ")
    copied = student_copy(notebook)["cells"]
    exercises = [place for place, cell in enumerate(cells) if is_exercise(cell)]
    assert len(checks(notebook)) == len(exercises) > 0
    for place in exercises:
        check, name = cells[place + 1], cells[place]["metadata"]["nbgrader"]["grade_id"]
        assert f"def {name}(" in cells[place]["source"] and '"""' in cells[place]["source"]
        assert "    # YOUR CODE HERE\n    raise NotImplementedError()" in copied[place]["source"]
        assert check["source"] == f'course.report("{name}", {name})'
        assert check["metadata"]["nbgrader"]["points"] == EXERCISES[name].points
        assert check["metadata"]["nbgrader"]["locked"]
        assert cells[place + 2]["source"] == f'{name} = course.solved("{name}", {name})'
        copied[place] = {"source": cells[place]["source"]}
    assert [cell["source"] for cell in copied] == [cell["source"] for cell in cells]
    assert not any(cell.get("outputs") for cell in copied)


@every_lesson
def test_long_plots_are_folded_and_what_prose_explains_can_be_tried_by_hand(path):
    code = [cell for cell in read_notebook(path)["cells"] if cell["cell_type"] == "code"]
    for cell in code:
        if any(call in cell["source"] for call in DRAWS) and "nbgrader" not in cell["metadata"]:
            folded = cell["metadata"].get("jupyter", {}).get("source_hidden")
            assert folded or cell["source"].count("\n") < 12, cell["source"]
    figures = [shown(cell, "text/plain") for cell in code]
    assert any("figure with sliders" in text for text in figures)
    assert "Predict, then run" in path.read_text(encoding="utf-8")
    assert "functions are yours" in "".join(code[-1]["outputs"][0]["text"])


def test_every_question_of_the_quiz_is_in_the_file_for_moodle():
    text = QUIZ.read_text(encoding="utf-8")
    made = as_gift(text)
    assert made.count("::[markdown]") == 160 == len(re.findall(r"^\d+\. ", text, re.M))
    assert 160 - made.count("{####") >= 120
    assert "of 160 frames? {#10080####160 · 63 \\= 10 080}" in made


def test_an_exam_is_made_by_its_seed_and_its_key_stands_apart():
    text = QUIZ.read_text(encoding="utf-8")
    asked, key = exam(text, 7, ["03", "07b"])
    assert exam(text, 7, ["03", "07b"]) == (asked, key) != exam(text, 8, ["03", "07b"])
    assert re.findall(r"^\d\. ", asked, re.M) == re.findall(r"^\d\. ", key, re.M)
    assert key.count("(lesson 07b") == 2 and "lesson" not in asked


def test_lesson_00_ends_with_the_glossary():
    glossary = Path(__file__).parents[2] / "docs" / "glossary.md"
    last = read_notebook(LESSONS[0])["cells"][-1]["source"]
    assert last == glossary.read_text(encoding="utf-8").replace("# ", "## ").strip()


@every_lesson
def test_a_deck_has_a_thought_a_slide_and_needs_no_network(path):
    slides = slides_of(path)
    assert 8 <= len(slides) <= 14 and all(slide.startswith("# ") for slide in slides)
    shown = [re.sub(r"\$\$.*?\$\$", "", NOTE.split(each)[0], flags=re.DOTALL) for each in slides]
    assert max(len(each.split()) for each in shown) < 40
    pytest.importorskip("mdit_py_plugins")
    page = deck(path)
    assert page.count("<section>") == len(slides) and "BEGIN SOLUTION" not in page
    assert not re.findall(r"""(?:src|href)=["']https?:""", page)


@every_lesson
def test_a_deck_has_notes_an_equation_in_steps_and_a_question_before_its_answer(path):
    slides = [NOTE.split(slide) for slide in slides_of(path)]
    assert all(len(parts) == 2 and parts[1].strip() for parts in slides), "a note for each slide"
    first_steps = [STEP.split(shown) for shown, _ in slides]
    assert any(len(steps) > 1 and "?" in steps[0] for steps in first_steps)
    assert any(len(steps) > 1 and "$$" in steps[0] for steps in first_steps)


def test_an_animation_is_printed_as_its_poses():
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.normal(0, 0.01, (40, 20, 3)), axis=0)
    actors = [viz.Actor(walk, PARENTS, "a"), viz.Actor(walk[:30] + 0.1, PARENTS, "b", viz.TRUTH)]
    player = viz.in_notebook(actors, 30)._repr_html_()
    assert with_still(player, "a walk").count('class="still" alt="a walk"') == 1
    data = json.loads(MOTIONS.search(html.unescape(player))[1])
    first, second = unpack_motions(data["motions"], data["frames"])
    np.testing.assert_allclose(first.positions, walk, atol=5e-4)
    held = np.concatenate([walk[:30] + 0.1, np.repeat(walk[29:30] + 0.1, 10, axis=0)])
    np.testing.assert_allclose(second.positions, held, atol=5e-4)
    assert (second.label, second.colour, second.parents) == ("b", viz.TRUTH, PARENTS)
    assert with_still("<p>no motion</p>", "") == "<p>no motion</p>"


@every_lesson
def test_links_to_the_glossary_name_its_headings(path):
    headings = re.findall(r"^### (.+)$", read_notebook(LESSONS[0])["cells"][-1]["source"], re.M)
    prose = "".join(c["source"] for c in read_notebook(path)["cells"][:-1])
    linked = set(re.findall(rf"\]\((?:{LESSONS[0].name})?#([\w-]+)\)", prose))
    assert linked <= {heading.replace(" ", "-") for heading in headings}


@pytest.mark.lessons
@every_notebook
def test_it_runs_with_short_trainings_and_every_check_passes(path):
    ran = execute(shorten(read_notebook(path), path), mine_before(path))
    assert_all_points(ran)
    assert pictures(ran) == pictures(read_notebook(path))


@pytest.mark.lessons
@every_notebook
def test_the_instructor_copy_runs_and_every_check_passes(path):
    ran = execute(read_notebook(path), mine_before(path))
    assert_all_points(ran)
    assert pictures(ran) == pictures(read_notebook(path))


@pytest.mark.lessons
@every_lesson
def test_the_student_copy_runs_and_every_check_fails(path):
    notebook = read_notebook(path)
    ran = execute(student_copy(notebook))
    for cell in checks(ran):
        text = shown(cell, "text/plain")
        assert f" 0 of {points_of(cell)} points" in text, text
        assert "not solved yet" in text and "hint" not in text
    assert pictures(ran) == pictures(notebook)  # with the package's own in place of what is missing


@pytest.mark.lessons
@every_lesson
def test_a_grader_gives_all_points_to_the_solutions_and_none_to_the_stubs(path, tmp_path):
    solved = grade(path, catalogue)
    assert solved.held and solved.points == solved.possible, str(solved)
    assert [r.operation for r in solved.reports] == [e.name for e in EXERCISES_OF[number_of(path)]]
    unsolved = tmp_path / path.name
    unsolved.write_text(json.dumps(student_copy(read_notebook(path))), encoding="utf-8")
    report = grade(unsolved, catalogue)
    assert report.points == 0 and report.possible == solved.possible and not report.faults


NOT_COMPARED = re.compile(
    r"```.*?```|`[^`]*`|\"[^\"\n]{1,300}?\"|“.*?”|\]\([^)]*\)|<[^>]*>", re.DOTALL
)
NUMBER = r"(?<![\w.])\d+(?:\.\d+)?(?![\w]|\.\d)"
QUOTED = re.compile(rf"({NUMBER})(?:\s*\\?(%)|[ ~]?(?:cm|mm|ms|µs|seconds)\b)?")


def quoted(text: str) -> list[str]:
    """The numbers of a text that have to be in a cell."""
    found = QUOTED.finditer(NOT_COMPARED.sub(" ", text))
    return [m[1] + (m[2] or "") for m in found if "." in m[1] or m[0] != m[1]]


def printed(cells: list[dict]) -> list[str]:
    """The numbers in the source of code cells and in what they printed."""
    texts = [cell["source"] for cell in cells]
    for output in (o for cell in cells for o in cell.get("outputs", ())):
        texts += [output.get("text", ""), output.get("data", {}).get("text/plain", "")]
    return re.findall(r"(?<![\w.])\d+(?:\.\d*)?(?:e[+-]?\d+)?%?", "\n".join(map("".join, texts)))


def stands_in(number: str, printed: list[str]) -> bool:
    """Whether a number is one of those printed, to the decimals that it has."""
    value = float(number.rstrip("%"))
    half = 0.5 * 10.0 ** -len(number.rstrip("%").partition(".")[2]) + 1e-9

    def same(other: str) -> bool:
        factor = 100 if number.endswith("%") and not other.endswith("%") else 1
        return abs(factor * float(other.rstrip("%")) - value) <= half

    return any(map(same, printed))


def unfounded(notebook: dict) -> list[str]:
    """The cells with numbers of the prose that no cell of the lesson has."""
    founded = printed([cell for cell in notebook["cells"] if cell["cell_type"] == "code"])
    return [
        f"{cell['id']}: {number}"
        for cell in notebook["cells"]
        if cell["cell_type"] == "markdown"
        for number in quoted(cell["source"])
        if not stands_in(number, founded)
    ]


@every_lesson
def test_the_numbers_of_the_prose_stand_in_a_cell(path):
    assert unfounded(read_notebook(path)) == []


@pytest.mark.thorough
@every_lesson
def test_a_lesson_runs_on_real_motion_and_its_numbers_hold(path, data_folder):
    assert unfounded(execute(read_notebook(path), mine_before(path), str(data_folder))) == []


def test_a_number_that_no_cell_has_is_found():
    text = 'It is 1.43 cm, 28% of $3.2$, "slowly by 0.9", `0.7`, [a](b-1.5.md), and 12 frames.'
    assert quoted(text) == ["1.43", "28%", "3.2"]
    prose = {"cell_type": "markdown", "id": "prose", "source": text}
    code = {"cell_type": "code", "source": "error", "outputs": [{"text": ["1.429 and 0.2811\n"]}]}
    assert unfounded({"cells": [prose, code]}) == ["prose: 3.2"]
    assert unfounded({"cells": [prose, code | {"source": "error = 3.2"}]}) == []
    code["outputs"] = [{"data": {"text/plain": "1.439"}}]
    assert unfounded({"cells": [prose, code]}) == ["prose: 1.43", "prose: 28%", "prose: 3.2"]
