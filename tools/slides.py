"""Write a deck of slides for each lesson, from the cells that are tagged "slide".

nbconvert makes the HTML of the cells; the decks need no network, since MathJax is copied beside
them from `sphinx-mathjax-offline` (`pip install '.[docs]'`). Of a text cell a slide has a heading,
the first sentence below it, the displayed formulas and the tables; of a code cell what it shows,
animations and figures with sliders too. Arrow keys and the space bar turn the slides; printed, each
slide has a page of its own.

    python -m tools.slides slides/ 03 05        (without numbers: every lesson)
"""

import re
import shutil
import sys
from html import escape
from importlib.util import find_spec
from pathlib import Path

import nbformat
from nbconvert import HTMLExporter

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.copies import choose_lessons
from numpy_cae.course.notebook import read_notebook

TAG = "slide"
MATHJAX = "tex-svg-full.js"
PAGE = Path(__file__).with_name("slides.html")


def shortened(text: str) -> list[str]:
    """The slides of a text cell: one for each of its headings, and what stands before the first."""
    text = re.sub(r"<details>.*?</details>", "", text, flags=re.DOTALL)
    text = re.sub(r"\[([^]]+)\]\([^)]*\)", r"\1", text)  # a deck has no other pages
    parts = re.split(r"^(?=#{1,3} )", text, flags=re.MULTILINE)
    slides = []
    for part in filter(str.strip, parts):
        heading, _, rest = part.partition("\n") if part.startswith("#") else ("", "", part)
        formulas = re.findall(r"\$\$.*?\$\$", rest, flags=re.DOTALL)
        tables = re.findall(r"(?:^\|.*\n?)+", rest, flags=re.MULTILINE)
        goals = re.findall(r"^- \*\*(?:Goal|Time).*(?:\n  .*)*", rest, flags=re.MULTILINE)
        prose = re.sub(r"\$\$.*?\$\$|(?:^\|.*\n?)+|^- .*", "", rest, flags=re.DOTALL | re.MULTILINE)
        first = re.match(r".*?[.:?!](?=\s|$)", prose.strip(), flags=re.DOTALL)
        sentence = [first[0]] if first and heading else []
        if heading or formulas or tables:
            slides.append("\n\n".join([heading, *sentence, *goals, *formulas, *tables]))
    return slides


def deck(notebook: dict, title: str) -> str:
    """The page of a lesson's slides."""
    exporter = HTMLExporter(template_name="basic", exclude_input=True, exclude_output_prompt=True)
    slides: list[list] = [[]]
    for cell in notebook["cells"]:
        if TAG not in cell["metadata"].get("tags", ()):
            continue
        if cell["cell_type"] == "markdown":
            slides += [[nbformat.v4.new_markdown_cell(text)] for text in shortened(cell["source"])]
        else:
            shown = nbformat.from_dict({**cell, "metadata": {}})
            slides[-1].append(shown) if len(slides[-1]) == 1 else slides.append([shown])
    pages = []
    for cells in filter(None, slides):
        body, _ = exporter.from_notebook_node(nbformat.v4.new_notebook(cells=cells))
        pages.append(f"<section>{body}</section>")
    page = PAGE.read_text(encoding="utf-8").replace("@title@", escape(title))
    return page.replace("@mathjax@", MATHJAX).replace("@slides@", "\n".join(pages))


def write_decks(folder: Path, numbers: list[str]) -> None:
    """Write the decks of the lessons with these numbers, and MathJax, into a folder."""
    offline = find_spec("sphinx-mathjax-offline")
    if offline is None or offline.origin is None:
        raise SystemExit("the slides need MathJax: pip install '.[docs]'")
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(Path(offline.origin).parent / "static" / "mathjax" / MATHJAX, folder / MATHJAX)
    for path in choose_lessons(Path(__file__).parents[1] / "lessons", numbers):
        with atomic_write(folder / f"{path.stem}.html") as temporary:
            temporary.write_text(deck(read_notebook(path), path.stem), encoding="utf-8")
        print(folder / f"{path.stem}.html")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit("name a folder for the slides: python -m tools.slides slides/ 03")
    write_decks(Path(sys.argv[1]), sys.argv[2:])
