"""The course: exercises and their checks, and the lessons as notebooks.

One source gives the instructor's copy, executed, and the student's, and a picture of each for the
gallery. `report` and `solved` are what the check cells call.
"""

from numpy_cae.course.catalogue import (
    CATALOGUE,
    example,
    properties,
    report,
    solved,
    with_points,
)
from numpy_cae.course.copies import (
    PACKAGED,
    choose_lessons,
    student_copy,
    write_copies,
    write_package_copy,
    write_release,
)
from numpy_cae.course.executed import execute, source_hash
from numpy_cae.course.gallery import is_current, picture_of, picture_path, write_picture
from numpy_cae.course.mine import mine_before
from numpy_cae.course.notebook import find_lessons, read_notebook, write_notebook

__all__ = [
    "CATALOGUE",
    "PACKAGED",
    "choose_lessons",
    "example",
    "execute",
    "find_lessons",
    "is_current",
    "mine_before",
    "picture_of",
    "picture_path",
    "properties",
    "read_notebook",
    "report",
    "solved",
    "source_hash",
    "student_copy",
    "with_points",
    "write_copies",
    "write_notebook",
    "write_package_copy",
    "write_picture",
    "write_release",
]
