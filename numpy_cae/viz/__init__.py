"""Pictures of motions and of numbers. Matplotlib is imported when something is drawn."""

from numpy_cae.viz.actor import CORRUPTED, OTHERS, PLAIN, PROJECTED, TRUTH, Actor, motion_actor
from numpy_cae.viz.curves import Curve, bars_figure, curves_figure, matrix_figure
from numpy_cae.viz.live_curve import LiveCurve
from numpy_cae.viz.sliders import Chart, slider_figure
from numpy_cae.viz.strip import save_figure, strip_figure
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
    "bars_figure",
    "curves_figure",
    "in_notebook",
    "matrix_figure",
    "motion_actor",
    "save_figure",
    "save_viewer",
    "slider_figure",
    "strip_figure",
]
