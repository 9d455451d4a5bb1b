"""Pictures of motions and of numbers. Matplotlib is imported when something is drawn."""

from numpy_cae.viz.actor import CORRUPTED as CORRUPTED
from numpy_cae.viz.actor import OTHERS as OTHERS
from numpy_cae.viz.actor import PLAIN as PLAIN
from numpy_cae.viz.actor import PROJECTED as PROJECTED
from numpy_cae.viz.actor import TRUTH as TRUTH
from numpy_cae.viz.actor import Actor as Actor
from numpy_cae.viz.actor import before_and_after as before_and_after
from numpy_cae.viz.actor import compared as compared
from numpy_cae.viz.actor import motion_actor as motion_actor
from numpy_cae.viz.curves import Curve as Curve
from numpy_cae.viz.curves import bars_figure as bars_figure
from numpy_cae.viz.curves import curves_figure as curves_figure
from numpy_cae.viz.curves import matrix_figure as matrix_figure
from numpy_cae.viz.live_curve import LiveCurve as LiveCurve
from numpy_cae.viz.sliders import Chart as Chart
from numpy_cae.viz.sliders import slider_figure as slider_figure
from numpy_cae.viz.strip import save_figure as save_figure
from numpy_cae.viz.strip import strip_figure as strip_figure
from numpy_cae.viz.viewer import in_notebook as in_notebook
from numpy_cae.viz.viewer import save_viewer as save_viewer

__all__ = [name for name in dir() if not name.startswith("_")]
