"""The result of a study: what it measured, without a word on how that is shown (`render`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from numpy_cae.evaluation.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from numpy_cae.viz.actor import Actor, Motions


@dataclass(frozen=True)
class Claim:
    """A sentence about a method, and whether the measurement confirms the sentence.

    Parameters
    ----------
    sentence : str
        With its source, such as "(holden2015, section 7)".
    confirmed : bool
    figures : str
        The measured figures that decide, in a sentence.
    """

    sentence: str
    confirmed: bool
    figures: str


@dataclass(frozen=True)
class Picture:
    """A figure of a result, which is drawn when it is requested, and motions for the viewer."""

    draw: Callable[[], Figure]
    actors: Sequence[Actor] = ()
    rate: float = 0.0


def moving(motions: Motions, rate: float, azimuth: float = 40.0) -> Picture:
    """Motions as strips, seen from `azimuth`, in degrees, and moving, `rate` frames a second."""
    from numpy_cae.viz import strip_figure
    from numpy_cae.viz.actor import local_actors, world_actors

    def draw() -> Figure:
        return strip_figure(local_actors(motions), rate, azimuth=azimuth)

    return Picture(draw, world_actors(motions), rate)


@dataclass(frozen=True)
class Result:
    """What a study measured.

    Parameters
    ----------
    title : str
    tables : sequence of Table
    claims : sequence of Claim
    figures : mapping of str to Picture
        Name of each figure's file to the figure.
    note : str
        What was measured on which data.
    provenance : mapping of str to str
        What must be known to repeat the measurements: data, minutes, seed, settings, versions.
    """

    title: str
    tables: Sequence[Table]
    claims: Sequence[Claim] = ()
    figures: Mapping[str, Picture] = field(default_factory=dict)
    note: str = ""
    provenance: Mapping[str, str] = field(default_factory=dict)

    @property
    def confirmed(self) -> int:
        """The number of claims that are confirmed."""
        return sum(bool(claim.confirmed) for claim in self.claims)
