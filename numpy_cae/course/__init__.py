"""The course: exercises and their checks, and the lessons as notebooks.

The source of a lesson is the instructor's notebook, stored with its outputs; the student's notebook
is made from it. `load_mine`, `report`, `solved`, `progress` and `example` are for the cells of a
notebook. They are imported when they are first used: the process that runs a student's file imports
solutions from this package, and needs no more of it.
"""

from importlib import import_module as _import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # editors and type checkers learn here what __getattr__ imports
    from numpy_cae.course.cells import example, progress, report, solved
    from numpy_cae.course.mine_file import load_mine

__all__ = ["example", "load_mine", "progress", "report", "solved"]


def __dir__() -> list[str]:
    """What tab completion offers: the modules with the solutions are not among it."""
    return __all__


if not TYPE_CHECKING:  # a type checker would accept any name

    def __getattr__(name: str) -> object:
        if name == "load_mine":
            return _import_module("numpy_cae.course.mine_file").load_mine
        if name in __all__:
            return getattr(_import_module("numpy_cae.course.cells"), name)
        raise AttributeError(f"numpy_cae.course has no {name!r}")
