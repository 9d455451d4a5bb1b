"""The course: exercises and their checks, and the lessons as notebooks.

The source of a lesson is the instructor's notebook, stored with its outputs; the student's notebook
is made from it. `load_mine`, `report`, `solved`, `progress` and `example` are for the cells of a
notebook.
"""

from numpy_cae.course.cells import example, progress, report, solved
from numpy_cae.course.mine_file import load_mine

__all__ = ["example", "load_mine", "progress", "report", "solved"]


def __dir__() -> list[str]:
    """What tab completion offers: the modules with the solutions are not among it."""
    return __all__
