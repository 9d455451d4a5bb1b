"""Motions and repaired motions show themselves in a notebook."""

from html import escape

from numpy_cae import ipython


def register() -> None:
    """Tell IPython, if it runs this, how to display a Motion and a Repaired; import neither."""
    if ipython.shell():
        html = ipython.shell().display_formatter.formatters["text/html"]
        html.for_type_by_name("numpy_cae.motion.motion", "Motion", motion_html)
        html.for_type_by_name("numpy_cae.repair.repaired", "Repaired", repaired_html)


def motion_html(motion) -> str:
    """The viewer with one motion."""
    from numpy_cae import viz

    actor = viz.motion_actor(motion, "motion 1", viz.PROJECTED, motion.rate)
    return viz.in_notebook([actor], motion.rate)._repr_html_()


def repaired_html(repaired) -> str:
    """What was changed, and the viewer with the repaired motion."""
    return f"<pre>{escape(repr(repaired))}</pre>\n{motion_html(repaired.motion)}"
