"""The lessons as notebooks: one source gives the instructor's copy, executed, and the student's,
and a picture of each for the gallery."""

from numpy_cae.course.executed import execute, source_hash
from numpy_cae.course.gallery import is_current, picture_of, picture_path, write_picture
from numpy_cae.course.notebook import find_lessons, read_notebook, write_notebook
from numpy_cae.course.student_copy import student_copy

__all__ = [
    "execute",
    "find_lessons",
    "is_current",
    "picture_of",
    "picture_path",
    "read_notebook",
    "source_hash",
    "student_copy",
    "write_notebook",
    "write_picture",
]
