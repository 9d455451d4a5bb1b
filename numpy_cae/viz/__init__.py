"""Pictures of motions and of numbers. Matplotlib is imported when something is drawn."""

from numpy_cae.viz.actor import (
    Actor,
    before_and_after,
    measure_distances,
    motion_actor,
    side_by_side,
)
from numpy_cae.viz.colours import CORRUPTED, OTHERS, PLAIN, PROJECTED, TRUTH, curve_styles
from numpy_cae.viz.figures import LiveCurve, losses_figure, matrix_figure, save_figure, strip_figure
from numpy_cae.viz.sliders import Chart, Curve, slider_figure
from numpy_cae.viz.viewer import in_notebook, save_viewer

__all__ = [
    "CORRUPTED",
    "OTHERS",
    "PLAIN",
    "PROJECTED",
    "TRUTH",
    "Actor",
    "Chart",
    "Curve",
    "LiveCurve",
    "before_and_after",
    "curve_styles",
    "in_notebook",
    "losses_figure",
    "matrix_figure",
    "measure_distances",
    "motion_actor",
    "save_figure",
    "save_viewer",
    "side_by_side",
    "slider_figure",
    "strip_figure",
]
