"""The lessons as pages of the site: articles in which the code of pictures is folded.

A notebook in `lessons/` is copied with a line of downloads below its title. A solution, and a
cell that draws a picture, gets the tag "hide-input". The alternative texts of pictures stand in the
metadata of their cells, under "alt". The index is made of the table and the pictures in
`lessons/README.md`.
"""

import json
import re
import shutil
from collections.abc import Callable
from html import escape
from pathlib import Path

from numpy_cae.course.notebooks import as_text, find_lessons, read_notebook, student_copy

ROW = re.compile(r"^\| \[(\d\db?) ([^]]+)\]\((\w+)\.ipynb\)" + 4 * r" *\| *(.*?)" + r" *\|$", re.M)
"""A line of the table: number, title, file, what one writes, source, minutes, what it needs."""
PICTURE = re.compile(r'<img src="pictures/(\d\db?)\.png" alt="\d\db?: ([^"]*)"')
ATTACHED = re.compile(r"!\[([^]]*)\]\(attachment:([^)]*)\)")
"""The picture with which a lesson begins: alternative text, file."""
CARD = """<li><img src="../_static/{number}.png" alt="{picture}">
<a href="{file}.html">{number} {title}</a><p>You write {writes}.</p>
<p class="quiet">{minutes} minutes, needs {needs}</p></li>"""


def write_lessons(lessons: Path, site: Path, write: Callable[[Path, str], None]) -> None:
    """Write the notebooks and their index to `site`, with `write`, a function of path and text."""
    readme = (lessons / "README.md").read_text(encoding="utf-8")
    pictures = dict(PICTURE.findall(readme))
    cards = []
    for number, title, file, writes, _, minutes, needs in ROW.findall(readme):
        card = CARD.format(
            number=number,
            file=file,
            title=escape(title.capitalize()),
            picture=escape(pictures[number]),
            writes=_code_as_html(writes),
            minutes=minutes,
            needs=needs,
        )
        cards.append(card)
    lines = ["# Lessons\n", '<ul class="cards">', *cards, "</ul>\n"]
    lines += ["```{toctree}", ":maxdepth: 1", ":hidden:", ":glob:\n", "[0-9]*", "```\n"]
    write(site / "index.md", "\n".join(lines))
    solved = site / "downloads" / "solved"
    to_solve = site / "downloads" / "to_solve"
    solved.mkdir(parents=True, exist_ok=True)
    to_solve.mkdir(parents=True, exist_ok=True)
    for path in find_lessons(lessons):
        notebook = read_notebook(path)
        shutil.copy2(path, solved / path.name)
        (to_solve / path.name).write_text(as_text(student_copy(notebook)), encoding="utf-8")
        article = _article(notebook, path.name)
        write(site / path.name, json.dumps(article))


def _article(notebook: dict, name: str) -> dict:
    """The notebook with downloads, folded code and alternative texts."""
    for cell in notebook["cells"]:
        if cell.pop("attachments", None):  # the picture of the gallery, which the site has
            cell["source"] = ATTACHED.sub(r'<img alt="\1" src="../_static/\2">', cell["source"])
        if cell["metadata"].get("nbgrader", {}).get("solution"):  # read the exercise first
            cell["metadata"].setdefault("tags", []).append("hide-input")
        if any("image/png" in output.get("data", {}) for output in cell.get("outputs", ())):
            _describe_picture(cell)
    notebook["cells"].insert(1, _downloads_cell(name))
    notebook["metadata"]["html_theme.sidebar_secondary.remove"] = True  # room for wide code
    return notebook


def _describe_picture(cell: dict) -> None:
    """Fold the code of a picture, and give the picture its alternative text."""
    source = cell["source"]
    metadata = cell["metadata"]
    tags = metadata.setdefault("tags", [])
    if "def " not in source or metadata.get("jupyter", {}).get("source_hidden"):
        tags.append("hide-input")
    metadata["mystnb"] = {"image": {"alt": " ".join(metadata["alt"])}}


def _downloads_cell(name: str) -> dict:
    """The cell with the links to both forms of a notebook."""
    downloads = (
        f"{{download}}`Notebook to solve <downloads/to_solve/{name}>` "
        f"{{download}}`Notebook with solutions <downloads/solved/{name}>`"
    )
    source = f":::{{container}} downloads\n{downloads}\n:::"
    return {"cell_type": "markdown", "id": "downloads", "metadata": {}, "source": source}


def _code_as_html(text: str) -> str:
    """Text of Markdown with its names in code, as HTML."""
    return re.sub(r"`([^`]*)`", lambda match: f"<code>{escape(match[1])}</code>", text)
