"""The lessons as pages of the site: articles in which the code of pictures is folded.

A notebook in `lessons/` is copied with a line of downloads below its title. A solution, and a
cell that draws a picture, gets the tag "hide-input". A picture without an alternative text in the
metadata of its cell (`"mystnb": {"image": {"alt": ...}}`) gets one from the texts in the code that
draws it. The index is made of the table and the pictures in `lessons/README.md`.
"""

import ast
import json
import re
import shutil
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path
from textwrap import shorten

from numpy_cae.course.notebooks import find_lessons, write_student_copies

TEXTS = {"title", "set_title", "suptitle", "xlabel", "ylabel", "set_xlabel", "set_ylabel", "label",
         "annotate", "text", "xticklabels", "set_xticklabels", "LiveCurve", "Actor"}  # fmt: skip
"""Names of functions and arguments of Matplotlib and `numpy_cae.viz` whose strings are shown."""
ROW = re.compile(r"^\| \[(\d\db?) ([^]]+)\]\((\w+)\.ipynb\)" + 4 * r" *\| *(.*?)" + r" *\|$", re.M)
"""A line of the table: number, title, file, what one writes, source, minutes, what it needs."""
PICTURE = re.compile(r'<img src="pictures/(\d\db?)\.png" alt="\d\db?: ([^"]*)"')
CARD = """<li><img src="../_static/{number}.png" alt="PICTURE">
<a href="{file}.html">{number} TITLE</a><p>You write WRITES.</p>
<p class="quiet">{minutes} minutes, needs {needs}</p></li>"""


def write_lessons(lessons: Path, site: Path, write: Callable[[Path, str], None]) -> None:
    """Write the notebooks and their index to `site`, with `write`, a function of path and text."""
    readme = (lessons / "README.md").read_text(encoding="utf-8")
    rows, pictures = ROW.findall(readme), dict(PICTURE.findall(readme))
    cards = []
    for number, title, file, writes, _, minutes, needs in rows:
        card = CARD.format(number=number, file=file, minutes=minutes, needs=needs)
        card = card.replace("TITLE", escape(title.capitalize())).replace("WRITES", _marked(writes))
        cards.append(card.replace("PICTURE", escape(pictures[number])))
    listed = ["# Lessons\n", '<ul class="cards">', *cards, "</ul>\n"]
    listed += ["```{toctree}", ":maxdepth: 1", ":hidden:", ":glob:\n", "[0-9]*", "```\n"]
    write(site / "index.md", "\n".join(listed))
    solved = site / "downloads" / "solved"
    solved.mkdir(parents=True, exist_ok=True)
    write_student_copies(lessons, site / "downloads" / "to_solve")
    for path in find_lessons(lessons):
        shutil.copy2(path, solved / path.name)
        notebook = json.loads(path.read_text(encoding="utf-8"))
        write(
            site / path.name,
            json.dumps(_article(notebook, path.name, pictures[path.name.partition("_")[0]])),
        )


def _article(notebook: dict, name: str, gallery: str) -> dict:
    """The notebook with downloads, folded code and alternative texts."""
    downloads = (
        f"{{download}}`Notebook to solve <downloads/to_solve/{name}>` "
        f"{{download}}`Notebook with solutions <downloads/solved/{name}>`"
    )
    cells = notebook["cells"]
    before = ""  # the text before the cell
    for cell in cells:
        if cell["cell_type"] == "markdown":
            before = "".join(cell["source"])
        if cell["metadata"].get("nbgrader", {}).get("solution"):  # read the exercise first
            cell["metadata"].setdefault("tags", []).append("hide-input")
        if not any("image/png" in output.get("data", {}) for output in cell.get("outputs", ())):
            continue
        source, metadata = "".join(cell["source"]), cell["metadata"]
        tags = metadata.setdefault("tags", [])
        if "def " not in source or metadata.get("jupyter", {}).get("source_hidden"):
            tags.append("hide-input")
        image = metadata.setdefault("mystnb", {}).setdefault("image", {})
        image.setdefault("alt", gallery if "gallery" in tags else alternative_text(source, before))
    links = {"cell_type": "markdown", "id": "downloads", "metadata": {}}
    cells.insert(1, links | {"source": f":::{{container}} downloads\n{downloads}\n:::"})
    notebook["metadata"]["html_theme.sidebar_secondary.remove"] = True  # room for wide code
    return notebook


def alternative_text(source: str, before: str = "") -> str:
    """What the code of a picture writes into it: titles, axes, lines. Where that is nothing, the
    last paragraph before the picture, at most 250 characters of it."""
    shown = list(dict.fromkeys(_strings(ast.parse(re.sub(r"^[%!].*", "", source, flags=re.M)))))
    if not shown:
        paragraph = before.strip().rpartition("\n\n")[2]
        plain = re.sub(r"\]\([^)]*\)|[*`$\[\]]|<[^>]*>", "", paragraph)
        shown = [shorten(plain, 250, placeholder=" …")]
    return f"Picture: {'; '.join(shown)}"


def _strings(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        given = [*node.args] if name in TEXTS else []
        given += [word.value for word in node.keywords if word.arg in TEXTS]
        for value in given:
            text = "".join(
                str(part.value)
                for part in getattr(value, "values", [value])
                if isinstance(part, ast.Constant) and isinstance(part.value, str)
            )
            if text.strip():
                yield " ".join(text.replace("$", "").split())


def _marked(text: str) -> str:
    """Text of Markdown with its names in code, as HTML."""
    return re.sub(r"`([^`]*)`", lambda found: f"<code>{escape(found[1])}</code>", text)
