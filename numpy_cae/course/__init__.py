"""The lessons as notebooks: one source gives the instructor's copy, executed, and the student's."""

from numpy_cae.course.executed import execute, source_hash
from numpy_cae.course.notebook import find_lessons, read_notebook, write_notebook
from numpy_cae.course.student_copy import student_copy

__all__ = [
    "execute",
    "find_lessons",
    "read_notebook",
    "source_hash",
    "student_copy",
    "write_notebook",
]
