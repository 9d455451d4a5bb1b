"""Students' copies: those of the package, a folder of them, and a release for nbgrader."""

import re
import zipfile
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.mine import EMPTY, FILE
from numpy_cae.course.notebook import as_text, find_lessons, read_notebook, write_notebook
from numpy_cae.course.student_copy import BEGIN, END, STUB, student_copy

PACKAGED = Path(str(files(__package__) / "notebooks"))
"""The folder of the students' copies that are part of the package."""
STUBBED = re.compile(f"( *){STUB[0]}\n *({re.escape(STUB[1])})")
IN_REGION = rf"\1{BEGIN}\n\1\2\n\1{END}"
"""As `nbgrader generate_assignment` wants a stub."""


def choose_lessons(folder: Path, numbers: list[str]) -> list[Path]:
    """The lessons in a folder with these numbers, or all; ValueError if one is not there."""
    lessons = find_lessons(folder)
    if missing := set(numbers) - {path.name[:2] for path in lessons}:
        there = ", ".join(path.name[:2] for path in lessons)
        raise ValueError(f"no lesson {', '.join(sorted(missing))} in {folder}; there are {there}")
    return [path for path in lessons if not numbers or path.name[:2] in numbers]


def write_copies(lessons: list[Path], folder: Path) -> Iterator[tuple[Path, bool]]:
    """Write the students' copies and mine.py; yields each file, and whether it was written.

    A file that exists is kept as it is.
    """
    if any(folder.resolve() == path.parent.resolve() for path in lessons):
        raise ValueError(f"{folder} holds the instructor's copies: name another folder")
    copies = {path.name: student_copy(read_notebook(path)) for path in lessons}
    folder.mkdir(parents=True, exist_ok=True)
    for name, copy in copies.items():
        if new := not (folder / name).exists():
            write_notebook(copy, folder / name)
        yield folder / name, new
    if new := not (folder / FILE).exists():
        (folder / FILE).write_text(EMPTY, encoding="utf-8")
    yield folder / FILE, new


def write_package_copy(lesson: Path) -> None:
    """Write the student's copy of a lesson in a clone's `lessons` folder into its package."""
    folder = lesson.parent.resolve().parent / "numpy_cae" / "course" / PACKAGED.name
    if folder.is_dir():
        write_notebook(student_copy(read_notebook(lesson)), folder / lesson.name)


def write_release(lessons: list[Path], path: Path) -> None:
    """Write a zip file to be unpacked in the folder of an nbgrader course.

    `release/NAME` has the students' copies and mine.py, `source/NAME` what `nbgrader
    generate_assignment NAME` makes them of, with the points and without solutions; NAME is that of
    the file. nbgrader_config.py lets nbgrader give the marks of `numpy-cae verify`.
    """
    config = files(__package__).joinpath("nbgrader_config.txt").read_text(encoding="utf-8")
    with atomic_write(path) as beside, zipfile.ZipFile(beside, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("nbgrader_config.py", config)
        for folder in ("release", "source"):
            packed.writestr(f"{folder}/{path.stem}/{FILE}", EMPTY)
        for lesson in lessons:
            copy = student_copy(read_notebook(lesson))
            packed.writestr(f"release/{path.stem}/{lesson.name}", as_text(copy))
            for cell in copy["cells"]:
                cell["source"] = STUBBED.sub(IN_REGION, cell["source"])
            packed.writestr(f"source/{path.stem}/{lesson.name}", as_text(copy))
