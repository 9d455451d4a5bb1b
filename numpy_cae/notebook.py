"""Motions and repaired motions show themselves in a notebook."""

from html import escape

from numpy_cae import ipython


def register() -> None:
    """Tell IPython, if it runs this, how to display a Motion and a Repaired; import neither."""
    if ipython.shell():
        html = ipython.shell().display_formatter.formatters["text/html"]
        html.for_type_by_name("numpy_cae.motion.motion", "Motion", motion_html)
        html.for_type_by_name("numpy_cae.cleanup.repaired", "Repaired", repaired_html)


def motion_html(motion) -> str:
    """What the motion is, and the viewer with it."""
    from numpy_cae import viz

    actors = viz.side_by_side([motion], [repr(motion)])
    return viz.in_notebook(actors, motion.rate)._repr_html_()


def repaired_html(repaired) -> str:
    """What was changed, and the viewer with the motion before and after and the findings."""
    from numpy_cae import viz
    from numpy_cae.mocap import rig_of

    motion = repaired.motion
    before = repaired.original or motion
    actors = viz.before_and_after(before, motion, rig_of(before).joints)
    findings = [finding.to_json() for finding in repaired.listed()]
    player = viz.in_notebook(actors, motion.rate, findings)
    return f"<pre>{escape(repr(repaired))}</pre>\n{player._repr_html_()}"
