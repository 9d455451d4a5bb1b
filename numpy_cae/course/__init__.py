"""The course: exercises and their checks, and the lessons as notebooks.

One source gives the instructor's copy, executed, and the student's, and a picture of each for the
gallery. `report`, `solved` and `example` are for the cells of a notebook.
"""

from numpy_cae.course.catalogue import example, report, solved

__all__ = ["example", "report", "solved"]
