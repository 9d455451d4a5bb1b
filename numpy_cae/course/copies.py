"""Copies of the lessons for students, written into a folder or into a release for nbgrader."""

import re
import zipfile
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path

from numpy_cae.atomic_write import atomic_write, make_folder
from numpy_cae.course.mine_file import EMPTY, FILE
from numpy_cae.course.notebooks import (
    BEGIN,
    END,
    STUB,
    as_text,
    find_lessons,
    find_milestones,
    number_of,
    read_notebook,
    student_copy,
)

PACKAGED = Path(str(files(__package__) / "notebooks"))
"""The folder of an installed package with the students' copies, which `setup.py` makes."""
OF_CLONE = Path(__file__).parents[2] / "lessons"
"""The folder of a clone with the instructor's copies."""
STUBBED = re.compile(f"( *){STUB[0]}\n *({re.escape(STUB[1])})")
IN_REGION = rf"\1{BEGIN}\n\1\2\n\1{END}"
"""As `nbgrader generate_assignment` wants a stub."""


def lessons_folder() -> Path:
    """The folder of the lessons: in an installed package the students' copies, else the clone's."""
    return PACKAGED if PACKAGED.is_dir() else OF_CLONE


@cache
def lesson_names() -> frozenset[str]:
    """The names of the lessons' files without their suffix."""
    return frozenset(path.stem for path in lessons_folder().glob("*.ipynb"))


def choose_lessons(folder: Path, numbers: list[str]) -> list[Path]:
    """The lessons in a folder with these numbers, or all; ValueError if one is missing."""
    lessons = find_lessons(folder)
    if missing := set(numbers) - {number_of(path) for path in lessons}:
        there = ", ".join(number_of(path) for path in lessons)
        raise ValueError(f"no lesson {', '.join(sorted(missing))} in {folder}; there are {there}")
    return [path for path in lessons if not numbers or number_of(path) in numbers]


def write_notebook(notebook: dict, path: str | Path) -> None:
    """Write a notebook."""
    with atomic_write(path) as temporary:
        temporary.write_text(as_text(notebook), encoding="utf-8")


def write_copies(lessons: list[Path], folder: Path) -> Iterator[tuple[Path, bool]]:
    """Write students' copies, the milestones that follow one of the lessons, and mine.py.

    An existing file is not changed.

    Yields
    ------
    path : Path
        Each file.
    is_new : bool
        Whether it was written.
    """
    if any(folder.resolve() == path.parent.resolve() for path in lessons):
        raise ValueError(f"{folder} holds the instructor's copies: name another folder")
    numbers = [number_of(lesson) for lesson in lessons]
    sources = list(lessons)
    for milestone in find_milestones(lessons[0].parent):
        if milestone.stem.removeprefix("milestone_") in numbers:
            sources.append(milestone)
    texts = {path.name: as_text(student_copy(read_notebook(path))) for path in sources}
    make_folder(folder)
    for name, text in {**texts, FILE: EMPTY}.items():
        path = folder / name
        is_new = not path.exists()
        if is_new:
            with atomic_write(path) as temporary:
                temporary.write_text(text, encoding="utf-8")
        yield path, is_new


def write_release(lessons: list[Path], path: Path) -> None:
    """Write a zip file to be unpacked in the folder of an nbgrader course.

    NAME is the name of the file. `release/NAME` has the students' copies and mine.py. From
    `source/NAME`, `nbgrader generate_assignment NAME` makes the same copies; it has the points and
    no solutions. With nbgrader_config.py, nbgrader gives the marks of `numpy-cae verify`.
    """
    config = files(__package__).joinpath("nbgrader_config.txt").read_text(encoding="utf-8")
    with (
        atomic_write(path) as temporary,
        zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as packed,
    ):
        packed.writestr("nbgrader_config.py", config)
        for folder in ("release", "source"):
            packed.writestr(f"{folder}/{path.stem}/{FILE}", EMPTY)
        for lesson in lessons:
            copy = student_copy(read_notebook(lesson))
            packed.writestr(f"release/{path.stem}/{lesson.name}", as_text(copy))
            for cell in copy["cells"]:
                cell["source"] = STUBBED.sub(IN_REGION, cell["source"])
            packed.writestr(f"source/{path.stem}/{lesson.name}", as_text(copy))
