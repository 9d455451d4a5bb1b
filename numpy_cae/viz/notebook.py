"""The viewer inside a notebook."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from numpy_cae.viz.actor import Actor
from numpy_cae.viz.viewer import page_html


@dataclass(frozen=True, repr=False)
class Player:
    """A page with a viewer that is displayed as the result of a cell, in a frame of its own."""

    page: str
    label: str
    height: int

    def __repr__(self) -> str:
        return f"an animation: {self.label}"

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.page)}" title="{escape(self.label)}" '
            f'style="width: 100%; height: {self.height}px; border: 0"></iframe>\n'
            f"<p>Animation: {escape(self.label)}. It plays in Jupyter and in any browser.</p>"
        )


def in_notebook(actors: Sequence[Actor], rate: float, height: int = 420) -> Player:
    """Motions side by side with play, pause and a slider, for the last line of a cell.

    The viewer takes 260 kB of the notebook, ten seconds of three motions about 150 kB more; its
    frame has `height` pixels.
    """
    return Player(page_html(actors, rate), ", ".join(actor.label for actor in actors), height)
