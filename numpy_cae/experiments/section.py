"""The experiments of `numpy-cae report`, each run and drawn as a section of the page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy_cae.experiments.result import Claim, Result

EXPERIMENTS = {
    "repair_sweep": "repair.repair_sweep",
    "kinect": "repair.kinect",
    "damage": "repair.damage",
    "filling_in": "repair.filling_in",
    "interpolation": "interpolation",
    "nearest": "comparison.nearest",
    "comparison": "comparison.comparison",
    "shift": "comparison.shift",
    "sampling": "sampling",
    "filters": "filters",
    "two_unpoolings": "repair.two_unpoolings",
    "lengths": "repair.lengths",
    "constrained_projection": "repair.constrained_projection",
}
"""Name of each experiment to its module here, in the order of the report. A module has a function
`run(manifold, material, seed) -> Result`, which raises ValueError where the material lacks what the
experiment needs."""


PUBLISHED = {"cmu35": "published.cmu35"}
"""Experiments that train their own networks: `run(folders, seed) -> Result`. They are run only if
they are named."""


@dataclass(frozen=True)
class Section:
    """The result of an experiment with its figure as PNG and its animation as the HTML of a viewer
    (empty where there is none) and the seconds that it took, or `failure`, why it could not be run.
    """

    name: str
    result: Result | None = None
    picture: bytes = b""
    viewer: str = ""
    seconds: float = 0.0
    failure: str = ""

    @property
    def title(self) -> str:
        """Of the result, or the experiment's name."""
        return self.result.title if self.result else self.name.replace("_", " ")

    @property
    def claims(self) -> Sequence[Claim]:
        """Those of the result."""
        return self.result.claims if self.result else ()

    @property
    def held(self) -> int:
        """How many of the claims held."""
        return sum(bool(claim.held) for claim in self.claims)

    def data(self) -> dict:
        """For JSON: what `Result.data` gives, with the name, the seconds and the failure."""
        measured = self.result.data() if self.result else {"title": self.title, "claims": []}
        own = {"name": self.name, "failure": self.failure or None, "seconds": self.seconds}
        return own | measured

    def summary(self) -> str:
        """One line for a terminal."""
        if self.failure:
            return f"{self.name}: could not be run: {self.failure}"
        return f"{self.name}: {self.held} of {len(self.claims)} claims held, {self.seconds:.0f} s"


def drawn(name: str, result: Result, seconds: float = 0.0) -> Section:
    """The section of a result, with its figure and its animation drawn."""
    return Section(name, result, result.png(), result.viewer(), seconds)


def run_section(name: str, *given: object, seed: int = 0) -> Section:
    """Run one of `EXPERIMENTS` (`given` a manifold and material) or of `PUBLISHED` (given folders)
    and draw its result; where it cannot be run the section says why."""
    started = time.monotonic()
    run = import_module(f"numpy_cae.experiments.{(EXPERIMENTS | PUBLISHED)[name]}").run
    try:
        section = drawn(name, run(*given, seed))
    except (ValueError, ArithmeticError) as error:
        section = Section(name, failure=str(error))
    return replace(section, seconds=time.monotonic() - started)
