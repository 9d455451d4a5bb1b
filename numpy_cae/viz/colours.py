"""The colours of motions and curves; orange, blue and green as in figure 1 of holden2015."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cycler import Cycler

CORRUPTED = "#e8833a"
"""Orange, of damaged motions."""
PROJECTED = "#2f6db5"
"""Blue, of projected and repaired motions."""
TRUTH = "#3f9a4b"
"""Green, of true motions."""
PLAIN = "#444444"
"""Grey, of all others."""
OTHERS = ("#7a4ca0", "#c2378f", "#8c564b", "#6b6b6b", "#9a8a00", "#14908a")
"""Colours of curves that are no projection, no damage and no truth, in their order."""
LINE_STYLES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)))
"""A line style of its own for each of `OTHERS`: the second and the last colour look alike to
readers who do not see red and green apart."""


def curve_styles() -> Cycler:
    """The colours of `OTHERS` with their line styles, for Matplotlib's setting axes.prop_cycle."""
    from cycler import cycler

    return cycler(color=OTHERS) + cycler(linestyle=LINE_STYLES)
