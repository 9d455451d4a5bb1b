"""Motions and repaired motions show themselves in a notebook."""

import sys
from html import escape


def shell():
    """The running IPython; None in plain Python."""
    ipython = sys.modules.get("IPython")
    return ipython and ipython.get_ipython()


def register() -> None:
    """Tell IPython, if it runs this, how to display a Motion and a Repaired; import neither."""
    if shell():
        html = shell().display_formatter.formatters["text/html"]
        html.for_type_by_name("numpy_cae.motion.motion", "Motion", motion_html)
        html.for_type_by_name("numpy_cae.manifold.repaired", "Repaired", repaired_html)


def motion_html(motion) -> str:
    """The viewer with one motion."""
    from numpy_cae.public import show

    return show(motion)._repr_html_()


def repaired_html(repaired) -> str:
    """What was changed, and the viewer with the repaired motion."""
    return f"<pre>{escape(repr(repaired))}</pre>\n{motion_html(repaired.motion)}"
