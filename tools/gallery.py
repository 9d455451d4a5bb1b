"""Write one small picture for each lesson, made from the outputs that the lesson stores.

The picture is that of the cell tagged "gallery", or else the last one of the lesson. It is stored
with a hash of the original picture; a test compares the hash with the lesson's present outputs.
The lesson itself begins with it, in its cell `at-the-end`.

example: python -m tools.gallery 03        (without numbers: every lesson)
"""

import base64
import hashlib
import io
import sys
from pathlib import Path

from PIL import Image, PngImagePlugin

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.copies import choose_lessons, write_notebook
from numpy_cae.course.notebooks import number_of, read_notebook

TAG = "gallery"
MADE_OF = "made of"
FIRST_PICTURE = "at-the-end"
"""The cell with the picture with which a lesson begins: what one has at its end."""
WIDTH = 480
"""A picture has so many pixels across at most."""
HEIGHT = 320
"""A picture has so many pixels from top to bottom at most."""
COLOURS = 64


def picture_of(notebook: dict) -> bytes:
    """The PNG of an executed lesson; ValueError if it shows none, or none in the tagged cell."""
    cells = notebook["cells"]
    tagged = [cell for cell in cells if TAG in cell["metadata"].get("tags", ())]
    outputs = [output for cell in tagged or cells for output in cell.get("outputs", ())]
    data_of_outputs = [output.get("data", {}) for output in outputs]
    pictures = [data["image/png"] for data in data_of_outputs if "image/png" in data]
    if not pictures:
        where = f"the cell tagged {TAG!r}" if tagged else "the lesson"
        raise ValueError(f"{where} shows no picture: was it executed?")
    return base64.b64decode("".join(pictures[-1]))


def write_picture(notebook: dict, lesson: str | Path) -> Path:
    """Write the picture of an executed lesson, whose file is `lesson`; returns the path."""
    drawn = picture_of(notebook)
    path = picture_path(lesson)
    path.parent.mkdir(exist_ok=True)
    with Image.open(io.BytesIO(drawn)) as picture:
        small = Image.new("RGB", picture.size, "white")
        small.paste(picture, mask=picture.getchannel("A") if picture.mode == "RGBA" else None)
    small.thumbnail((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
    information = PngImagePlugin.PngInfo()
    information.add_text(MADE_OF, hashlib.sha256(drawn).hexdigest())
    with atomic_write(path) as temporary:
        small.quantize(COLOURS).save(temporary, "PNG", optimize=True, pnginfo=information)
    return path


def attach_picture(notebook: dict, lesson: str | Path) -> None:
    """Put a lesson's picture into its cell `at-the-end`, and write the lesson."""
    picture = picture_path(lesson)
    png = base64.b64encode(picture.read_bytes()).decode()
    (cell,) = [cell for cell in notebook["cells"] if cell["id"] == FIRST_PICTURE]
    cell["attachments"] = {picture.name: {"image/png": png}}
    write_notebook(notebook, lesson)


def picture_path(lesson: str | Path) -> Path:
    """lessons/pictures/03.png for lessons/03_convolution_by_hand.ipynb."""
    lesson = Path(lesson)
    return lesson.parent / "pictures" / f"{number_of(lesson)}.png"


if __name__ == "__main__":
    for path in choose_lessons(Path(__file__).parents[1] / "lessons", sys.argv[1:]):
        lesson_notebook = read_notebook(path)
        print(write_picture(lesson_notebook, path))
        attach_picture(lesson_notebook, path)
