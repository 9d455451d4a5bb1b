"""A motion to be drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from numpy_cae.viz.colours import PLAIN


@dataclass(frozen=True)
class Actor:
    """A motion to be drawn.

    Parameters
    ----------
    positions : (F, J, 3) array of float
        World positions in metres.
    parents : tuple of J int
    label : str
    colour : str
    """

    positions: np.ndarray
    parents: tuple[int, ...]
    label: str = ""
    colour: str = PLAIN
