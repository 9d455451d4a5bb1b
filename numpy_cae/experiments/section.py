"""One experiment, run and kept as bytes and text: a section of the report."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.reported import REPORTED
from numpy_cae.manifold import MotionManifold


@dataclass(frozen=True)
class Section:
    """What an experiment gave.

    Parameters
    ----------
    name, title : str
    text : str
        Its tables.
    findings : list of Finding
    picture : bytes
        PNG.
    gif : bytes
        Empty where there is none.
    seconds : float
        What it took, pictures included.
    failure : str
        Why it could not be run; empty where it was.
    """

    name: str
    title: str
    text: str = ""
    findings: list[Finding] | None = None
    picture: bytes = b""
    gif: bytes = b""
    seconds: float = 0.0
    failure: str = ""

    @property
    def held(self) -> int:
        """How many of its claims held."""
        return sum(finding.held for finding in self.findings or [])

    def summary(self) -> str:
        """One line: what came of it, and how long it took."""
        if self.failure:
            return f"{self.name}: could not be run: {self.failure}"
        count = len(self.findings or [])
        return f"{self.name}: {self.held} of {count} claims held, {self.seconds:.0f} s"


def run_section(name: str, manifold: MotionManifold, material: Material, seed: int = 0) -> Section:
    """Run an experiment of `REPORTED` and draw it.

    What material lacks (no press-ups, nothing labelled) makes a section that says so: the other
    experiments are not to be lost with it.
    """
    started = time.monotonic()
    try:
        result = REPORTED[name](manifold, material, seed)
        with tempfile.TemporaryDirectory() as folder:
            picture, gif = Path(folder, "picture.png"), Path(folder, "moving.gif")
            result.save_picture(picture)
            if hasattr(result, "save_gif"):
                result.save_gif(gif)
            drawn = picture.read_bytes()
            moving = gif.read_bytes() if gif.exists() else b""
    except (ValueError, ArithmeticError) as error:
        seconds = time.monotonic() - started
        return Section(name, name.replace("_", " "), seconds=seconds, failure=str(error))
    seconds = time.monotonic() - started
    return Section(name, result.title, result.text(), result.findings(), drawn, moving, seconds)
