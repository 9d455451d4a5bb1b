"""Write a deck of slides for each lesson from its text in `lessons/slides`.

    python -m tools.slides slides/ 03 05        (without numbers: every lesson)

The text of a deck is Markdown: slides stand between lines of `---`, and each begins with a heading.
`![what is seen](cell-id)` shows the picture, the animation or the figure with sliders of the
lesson's cell with this id, as it is stored in the executed notebook. Formulas are TeX. A deck needs
no network, since MathJax is copied beside it from `sphinx-mathjax-offline`
(`pip install '.[docs]'`).

A line `--` within a slide ends a step: what follows is shown at the next key. After a line `Note:`
stands what the speaker says. Arrow keys and the space bar show the next step or slide, `n` shows
the notes. Printed, each slide is a landscape page with all its steps, and an animation is a row of
poses.
"""

import base64
import io
import json
import re
import shutil
import sys
import zlib
from html import escape, unescape
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.copies import choose_lessons
from numpy_cae.course.notebooks import number_of, read_notebook
from numpy_cae.viz import Actor, strip_figure

if TYPE_CHECKING:
    from markdown_it import MarkdownIt

LESSONS = Path(__file__).parents[1] / "lessons"
PAGE = Path(__file__).with_name("slides.html")
MATHJAX = "tex-svg-full.js"
PICTURE = re.compile(r"!\[([^]]*)\]\(([\w-]+)\)")
STEP = re.compile(r"^--$", re.MULTILINE)
NOTE = re.compile(r"^Note:$", re.MULTILINE)
MOTIONS = re.compile(
    r'<script type="application/json" class="viewer-data[^>]*>(.*?)</script>', re.DOTALL
)
"""The motions of an animation, in the page within its frame."""
POSES_IN_PRINT = 8


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
                    return with_still("".join(data["text/html"]), alternative)
    raise ValueError(f"no cell {cell_id!r} shows a picture")


def with_still(animation: str, alternative: str) -> str:
    """An animation, and the row of poses that is printed in its place.

    What is no animation, such as a figure with sliders, is returned as it is.
    """
    motions = MOTIONS.search(unescape(animation))
    if motions is None:
        return animation
    data = json.loads(motions[1])
    actors = unpack_motions(data["motions"], data["frames"])
    picture = io.BytesIO()
    strip_figure(actors, data["rate"], POSES_IN_PRINT).savefig(picture, format="png", dpi=90)
    png = base64.b64encode(picture.getvalue()).decode()
    still = f'<img class="still" alt="{escape(alternative)}" src="data:image/png;base64,{png}">'
    return f'<div class="moving">{animation}</div>{still}'


def unpack_motions(motions: list[dict], frames: int) -> list[Actor]:
    """The motions of a viewer, which `numpy_cae.viz.viewer` packs."""
    actors: list[Actor] = []
    first_steps = np.zeros(0)
    for motion in motions:
        planes = np.frombuffer(zlib.decompress(base64.b64decode(motion["steps"])), np.uint8)
        signed = planes.reshape(4, -1).T.copy().view("<u4").reshape(-1, frames).astype(np.int64)
        differences = (signed >> 1) ^ -(signed & 1)
        steps = np.cumsum(differences, axis=1)
        if motion["from_first"]:
            steps += first_steps
        elif not actors:
            first_steps = steps
        local = (motion["step"] * steps).T.reshape(frames, -1, 3)
        positions = np.concatenate([local[:, :1], local[:, 1:] + local[:, :1]], axis=1)
        parents = tuple(motion["parents"])
        actors.append(Actor(positions, parents, motion["label"], motion["colour"]))
    return actors


def deck(lesson: Path) -> str:
    """The page of a lesson's slides."""
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    notebook = read_notebook(lesson)
    markdown = MarkdownIt("commonmark", {"html": True}).enable("table")
    markdown.use(dollarmath_plugin, renderer=_formula)
    pages = [slide_html(slide, notebook, markdown) for slide in slides_of(lesson)]
    page = PAGE.read_text(encoding="utf-8").replace("@title@", escape(lesson.stem))
    return page.replace("@mathjax@", MATHJAX).replace("@slides@", "\n".join(pages))


def slide_html(slide: str, notebook: dict, markdown: "MarkdownIt") -> str:
    """The section of a slide: its steps, and the notes for the speaker."""
    shown, *notes = NOTE.split(slide)
    steps = []
    for number, step in enumerate(STEP.split(shown)):
        html = markdown.render(PICTURE.sub(lambda match: f"PICTURE-{match[2]}", step))
        for alternative, cell_id in PICTURE.findall(step):
            picture = picture_html(notebook, cell_id, alternative)
            html = html.replace(f"<p>PICTURE-{cell_id}</p>", picture)
        steps.append(f'<div class="step">{html}</div>' if number else html)
    for note in notes:
        steps.append(f"<aside>{markdown.render(note)}</aside>")
    return f"<section>{''.join(steps)}</section>"


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
