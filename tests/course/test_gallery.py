"""The gallery: one small picture a lesson, made of what the lesson shows."""

import base64
import hashlib
import io
from pathlib import Path

import pytest
from PIL import Image

from numpy_cae.cli import main
from numpy_cae.course.gallery import MADE_OF, picture_of, picture_path, write_picture
from numpy_cae.course.notebook import find_lessons, read_notebook, write_notebook

FOLDER = Path(__file__).parents[2] / "lessons"
LARGEST = 70_000


def drawn(colour, size=(900, 300)):
    beside = io.BytesIO()
    Image.new("RGBA", size, colour).save(beside, "PNG")
    return base64.b64encode(beside.getvalue()).decode()


def a_cell(name, *pictures, tags=()):
    outputs = [{"output_type": "display_data", "data": {"image/png": one}} for one in pictures]
    metadata = {"tags": list(tags)} if tags else {}
    return {"cell_type": "code", "id": name, "metadata": metadata, "source": "", "outputs": outputs}


def a_lesson(*cells):
    return {"cells": list(cells), "metadata": {}, "nbformat": 4, "nbformat_minor": 5}


def is_current(notebook, path):
    """Whether the small picture was made from the present outputs."""
    with Image.open(path) as picture:
        return picture.info[MADE_OF] == hashlib.sha256(picture_of(notebook)).hexdigest()


@pytest.mark.parametrize("path", find_lessons(FOLDER), ids=lambda path: path.stem)
def test_each_lesson_has_its_picture_in_the_gallery(path):
    number = path.name[:2]
    assert is_current(read_notebook(path), picture_path(path)), (
        f"pictures/{number}.png is not of what the lesson shows: "
        f"numpy-cae lessons --gallery --only {number}"
    )
    assert picture_path(path).stat().st_size < LARGEST
    listed = f'<a href="{path.name}"><img src="pictures/{number}.png"'
    assert listed in FOLDER.joinpath("README.md").read_text(encoding="utf-8")


def test_the_tagged_picture_stands_for_the_lesson_or_the_last():
    first, last = drawn("red"), drawn("blue")
    assert picture_of(a_lesson(a_cell("a", first), a_cell("b", last))) == base64.b64decode(last)
    tagged = a_lesson(a_cell("a", first, tags=["gallery"]), a_cell("b", last))
    assert picture_of(tagged) == base64.b64decode(first)


def test_it_is_made_small_on_white_and_goes_stale(tmp_path):
    lesson = tmp_path / "03_convolution.ipynb"
    shown = a_lesson(a_cell("a", drawn((0, 0, 255, 0))))
    path = write_picture(shown, lesson)
    assert path == tmp_path / "pictures" / "03.png"
    with Image.open(path) as picture:
        assert picture.size == (480, 160)
        assert picture.convert("RGB").getpixel((5, 5)) == (255, 255, 255)
    assert is_current(shown, path)
    assert not is_current(a_lesson(a_cell("a", drawn("red"))), path)


def test_the_command_makes_the_pictures_and_runs_nothing(tmp_path, capsys):
    lesson = tmp_path / "03_convolution.ipynb"
    write_notebook(a_lesson(a_cell("a", drawn("red"))), lesson)
    assert main(["lessons", "--gallery", "--from", str(tmp_path)]) == 0
    assert capsys.readouterr().out.strip() == str(tmp_path / "pictures" / "03.png")
    write_notebook(a_lesson(a_cell("a")), lesson)
    assert main(["lessons", "--gallery", "--from", str(tmp_path)]) == 2
    assert f"{lesson}: the lesson shows no picture" in capsys.readouterr().err
    assert main(["lessons", "student", "--gallery", "--from", str(tmp_path)]) == 2
