"""The numbers in the lessons' prose are those of the cells.

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

import re
from pathlib import Path

import pytest

from numpy_cae.course.copies import find_lessons, read_notebook
from tools.execute_lessons import execute, mine_before

LESSONS = find_lessons(Path(__file__).parents[2] / "lessons")
every_lesson = pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)
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
