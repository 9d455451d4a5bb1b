"""One experiment, run and drawn: a section of a report, which can be sent between processes."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from numpy_cae.experiments.catalogue import experiment
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result
from numpy_cae.manifold import MotionManifold


@dataclass(frozen=True)
class Section:
    """A result whose figure and animation are drawn, or the reason why there is none.

    Parameters
    ----------
    name : str
        Of the experiment.
    result : Result, optional
        Without figure and animation.
    picture, gif : bytes
        PNG and GIF; empty where there is none.
    seconds : float
        Taken to run and draw.
    failure : str
        Why the experiment could not be run; empty where it was.
    """

    name: str
    result: Result | None = None
    picture: bytes = b""
    gif: bytes = b""
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
        """What `Result.data` gives, with the name, the seconds and the failure, for JSON."""
        empty = {"title": self.title, "tables": [], "claims": [], "note": ""}
        measured = self.result.data() if self.result else empty
        return {
            "name": self.name,
            "failure": self.failure or None,
            "seconds": self.seconds,
            **measured,
        }

    def summary(self) -> str:
        """One line for a terminal."""
        if self.failure:
            return f"{self.name}: could not be run: {self.failure}"
        return f"{self.name}: {self.held} of {len(self.claims)} claims held, {self.seconds:.0f} s"


def drawn(name: str, result: Result, seconds: float = 0.0) -> Section:
    """The section of a result, with its figure and its animation drawn."""
    plain = replace(result, figure=None, animation=None)
    return Section(name, plain, result.png(), result.gif(), seconds)


def run_section(name: str, manifold: MotionManifold, material: Material, seed: int = 0) -> Section:
    """Run one of `EXPERIMENTS` and draw its result.

    Where the material lacks something (no press-ups, no labels) the section says so, so that the
    other experiments are not lost.
    """
    started = time.monotonic()
    try:
        section = drawn(name, experiment(name)(manifold, material, seed))
    except (ValueError, ArithmeticError) as error:
        section = Section(name, failure=str(error))
    return replace(section, seconds=time.monotonic() - started)
