"""The pages that docs/conf.py makes: equations of docstrings, lessons as articles, their index."""

import json
from pathlib import Path

import pytest

from tools.equations import as_tex, is_equation
from tools.lesson_pages import write_lessons

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The lessons' pages: name to text."""
    pages = {}
    folder = tmp_path_factory.mktemp("lessons")
    write_lessons(ROOT / "lessons", folder, lambda path, text: pages.update({path: text}))
    return {path.name: text for path, text in pages.items()}


def test_an_equation_is_written_in_tex():
    lines = ["    y = Σ_k x[k - K//2] · ŵ[k]   with zeros"]
    assert is_equation(lines) and not is_equation(["    >>> x = 1"])
    tex = r"& y = \sum _k x[k - \lfloor K/2\rfloor ] \cdot  \hat{w}[k] \qquad \text{ with zeros }"
    assert tex in as_tex(lines)


def test_every_picture_of_a_lesson_has_a_text_and_every_lesson_a_card(site):
    lessons = [name for name in site if name.endswith(".ipynb")]
    for name in lessons:
        for cell in json.loads(site[name])["cells"]:
            if any("image/png" in output.get("data", {}) for output in cell.get("outputs", ())):
                assert len(cell["metadata"]["mystnb"]["image"]["alt"]) > 10, (name, cell["source"])
        assert f'<a href="{name.removesuffix(".ipynb")}.html">' in site["index.md"]
    assert len(lessons) == site["index.md"].count("<li>") > 10
