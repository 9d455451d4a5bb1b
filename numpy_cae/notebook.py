"""Motions and repaired motions show themselves in a notebook."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy_cae.cleanup import Repaired
    from numpy_cae.motion import Motion


def register() -> None:
    """Tell the running IPython how to display a Motion and a Repaired."""
    from numpy_cae.viz.viewer import running_shell

    shell = running_shell()
    if shell:
        html = shell.display_formatter.formatters["text/html"]
        html.for_type_by_name("numpy_cae.motion.motion", "Motion", motion_html)
        html.for_type_by_name("numpy_cae.cleanup.result", "Repaired", repaired_html)


def motion_html(motion: Motion) -> str:
    """The viewer with a motion."""
    from numpy_cae import viz

    actors = viz.side_by_side([motion], [repr(motion)])
    return viz.in_notebook(actors, motion.rate)._repr_html_()


def repaired_html(repaired: Repaired) -> str:
    """What was changed, and the viewer with the motion before and after and the findings."""
    from numpy_cae import viz
    from numpy_cae.cleanup.events import rows_of_events
    from numpy_cae.mocap import rig_of

    motion = repaired.motion
    before = repaired.original or motion
    actors = viz.before_and_after(before, motion, rig_of(before).joints)
    player = viz.in_notebook(actors, motion.rate, rows_of_events(repaired.events()))
    return f"<pre>{escape(repr(repaired))}</pre>\n{player._repr_html_()}"
