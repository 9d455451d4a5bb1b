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

from numpy_cae.course.notebooks import as_text, find_lessons, number_of, read_notebook, student_copy

TEXTS = {"title", "set_title", "suptitle", "xlabel", "ylabel", "set_xlabel", "set_ylabel", "label",
         "annotate", "text", "xticklabels", "set_xticklabels", "LiveCurve", "Actor"}  # fmt: skip
"""Names of functions and arguments of Matplotlib and `numpy_cae.viz` whose strings are shown."""
ROW = re.compile(r"^\| \[(\d\db?) ([^]]+)\]\((\w+)\.ipynb\)" + 4 * r" *\| *(.*?)" + r" *\|$", re.M)
"""A line of the table: number, title, file, what one writes, source, minutes, what it needs."""
PICTURE = re.compile(r'<img src="pictures/(\d\db?)\.png" alt="\d\db?: ([^"]*)"')
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
        article = _article(notebook, path.name, pictures[number_of(path)])
        write(site / path.name, json.dumps(article))


def _article(notebook: dict, name: str, gallery: str) -> dict:
    """The notebook with downloads, folded code and alternative texts.

    `gallery` is the alternative text of the picture that the gallery shows.
    """
    text = ""  # the text before the cell
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            text = cell["source"]
        if cell["metadata"].get("nbgrader", {}).get("solution"):  # read the exercise first
            cell["metadata"].setdefault("tags", []).append("hide-input")
        if any("image/png" in output.get("data", {}) for output in cell.get("outputs", ())):
            _describe_picture(cell, text, gallery)
    notebook["cells"].insert(1, _downloads_cell(name))
    notebook["metadata"]["html_theme.sidebar_secondary.remove"] = True  # room for wide code
    return notebook


def _describe_picture(cell: dict, text: str, gallery: str) -> None:
    """Fold the code of a picture, and give the picture an alternative text."""
    source = cell["source"]
    metadata = cell["metadata"]
    tags = metadata.setdefault("tags", [])
    if "def " not in source or metadata.get("jupyter", {}).get("source_hidden"):
        tags.append("hide-input")
    image = metadata.setdefault("mystnb", {}).setdefault("image", {})
    image.setdefault("alt", gallery if "gallery" in tags else alternative_text(source, text))


def _downloads_cell(name: str) -> dict:
    """The cell with the links to both forms of a notebook."""
    downloads = (
        f"{{download}}`Notebook to solve <downloads/to_solve/{name}>` "
        f"{{download}}`Notebook with solutions <downloads/solved/{name}>`"
    )
    source = f":::{{container}} downloads\n{downloads}\n:::"
    return {"cell_type": "markdown", "id": "downloads", "metadata": {}, "source": source}


def alternative_text(source: str, before: str = "") -> str:
    """What the code of a picture writes into it: titles, axes, lines. Where that is nothing, the
    last paragraph before the picture, at most 250 characters of it."""
    tree = ast.parse(re.sub(r"^[%!].*", "", source, flags=re.M))
    texts = list(dict.fromkeys(_strings(tree)))
    if not texts:
        paragraph = before.strip().rpartition("\n\n")[2]
        plain = re.sub(r"\]\([^)]*\)|[*`$\[\]]|<[^>]*>", "", paragraph)
        texts = [shorten(plain, 250, placeholder=" …")]
    return f"Picture: {'; '.join(texts)}"


def _strings(tree: ast.AST) -> Iterator[str]:
    """The strings that the calls of a cell show."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        arguments = [*node.args] if name in TEXTS else []
        arguments += [keyword.value for keyword in node.keywords if keyword.arg in TEXTS]
        for argument in arguments:
            text = _constant_parts(argument)
            if text.strip():
                yield " ".join(text.replace("$", "").split())


def _constant_parts(argument: ast.expr) -> str:
    """A string, or of an f-string the parts that are written out; "" of anything else."""
    texts = []
    for part in getattr(argument, "values", [argument]):
        if isinstance(part, ast.Constant) and isinstance(part.value, str):
            texts.append(part.value)
    return "".join(texts)


def _code_as_html(text: str) -> str:
    """Text of Markdown with its names in code, as HTML."""
    return re.sub(r"`([^`]*)`", lambda match: f"<code>{escape(match[1])}</code>", text)
