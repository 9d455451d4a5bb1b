"""Two right answers to each exercise, written in other ways than the key in `course.solutions`.

The tests grade them, and `tools.wrong_answers` makes wrong ones of them.
"""

from collections.abc import Callable
from inspect import getsource

import numpy as np

from numpy_cae.course.catalogue import CATALOGUE
from tools.right_answers import first_answers, second_answers

RIGHT_ANSWERS = (first_answers, second_answers)
"""The modules; each has a function for each exercise."""


def answer(name: str, number: int, old: str = "", new: str = "") -> Callable:
    """A right answer to an exercise as it is graded: what it calls is the package's own.

    Parameters
    ----------
    name : str
        The exercise.
    number : int
        The number of the module in `RIGHT_ANSWERS`.
    old, new : str, optional
        A piece of the text, and the text in its place, which makes the answer wrong.

    Raises
    ------
    ValueError
        If the answer does not have the piece of text.
    """
    source = getsource(getattr(RIGHT_ANSWERS[number], name))
    if old not in source:
        raise ValueError(f"{name}: no {old!r}")
    space = {"np": np, **{name: exercise.solution for name, exercise in CATALOGUE.items()}}
    exec(source.replace(old, new) if old else source, space)
    return space[name]
