"""Write a deck of slides for each lesson from its text in `lessons/slides`.

    python -m tools.slides slides/ 03 05        (without numbers: every lesson)

The text of a deck is Markdown: slides stand between lines of `---`, and each begins with a heading.
`![what is seen](cell-id)` shows the picture, the animation or the figure with sliders of the
lesson's cell with this id, as it is stored in the executed notebook. Formulas are TeX. A deck needs
no network, since MathJax is copied beside it from `sphinx-mathjax-offline`
(`pip install '.[docs]'`). Arrow keys and the space bar turn the slides; printed, each slide has a
page of its own.
"""

import re
import shutil
import sys
from html import escape
from importlib.util import find_spec
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.copies import choose_lessons
from numpy_cae.course.notebooks import number_of, read_notebook

LESSONS = Path(__file__).parents[1] / "lessons"
PAGE = Path(__file__).with_name("slides.html")
MATHJAX = "tex-svg-full.js"
PICTURE = re.compile(r"!\[([^]]*)\]\(([\w-]+)\)")


def slides_of(lesson: Path) -> list[str]:
    """The slides of a lesson, as Markdown."""
    text = (lesson.parent / "slides" / f"{number_of(lesson)}.md").read_text(encoding="utf-8")
    return [slide.strip() for slide in re.split(r"^---$", text, flags=re.MULTILINE)]


def picture_html(notebook: dict, cell_id: str, alternative: str) -> str:
    """What a cell shows, as HTML; a ValueError if the lesson has no such cell, or it shows none.

    `alternative` is the alternative text of a picture.
    """
    for cell in notebook["cells"]:
        if cell["id"] == cell_id:
            for output in reversed(cell.get("outputs", ())):
                data = output.get("data", {})
                if "image/png" in data:
                    png = "".join(data["image/png"]).replace("\n", "")
                    return f'<img alt="{escape(alternative)}" src="data:image/png;base64,{png}">'
                if "text/html" in data:
                    return "".join(data["text/html"])
    raise ValueError(f"no cell {cell_id!r} shows a picture")


def deck(lesson: Path) -> str:
    """The page of a lesson's slides."""
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    notebook = read_notebook(lesson)
    markdown = MarkdownIt("commonmark", {"html": True}).enable("table")
    markdown.use(dollarmath_plugin, renderer=_formula)
    pages = []
    for slide in slides_of(lesson):
        text = PICTURE.sub(lambda match: f"PICTURE-{match[2]}", slide)
        page = markdown.render(text)
        for alternative, cell_id in PICTURE.findall(slide):
            picture = picture_html(notebook, cell_id, alternative)
            page = page.replace(f"PICTURE-{cell_id}", picture)
        pages.append(f"<section>{page}</section>")
    page = PAGE.read_text(encoding="utf-8").replace("@title@", escape(lesson.stem))
    return page.replace("@mathjax@", MATHJAX).replace("@slides@", "\n".join(pages))


def _formula(text: str, options: dict) -> str:
    mark = r"\[{}\]" if options["display_mode"] else r"\({}\)"
    return escape(mark.format(text))


def write_decks(folder: Path, numbers: list[str]) -> None:
    """Write the decks of the lessons with these numbers, and MathJax, into a folder."""
    offline = find_spec("sphinx-mathjax-offline")
    if offline is None or offline.origin is None:
        raise SystemExit("the slides need MathJax: pip install '.[docs]'")
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(Path(offline.origin).parent / "static" / "mathjax" / MATHJAX, folder / MATHJAX)
    for path in choose_lessons(LESSONS, numbers):
        with atomic_write(folder / f"{path.stem}.html") as temporary:
            temporary.write_text(deck(path), encoding="utf-8")
        print(folder / f"{path.stem}.html")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit("name a folder: python -m tools.slides slides/ 03")
    write_decks(Path(sys.argv[1]), sys.argv[2:])
