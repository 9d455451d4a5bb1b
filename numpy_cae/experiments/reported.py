"""What `numpy-cae report` runs, in the order in which it tells of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from numpy_cae.experiments.comparison import comparison
from numpy_cae.experiments.constrained_projection import constrained_projection
from numpy_cae.experiments.excited import excited
from numpy_cae.experiments.filters import filters
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.geodesics import geodesics
from numpy_cae.experiments.interpolation import interpolation
from numpy_cae.experiments.kinect import kinect
from numpy_cae.experiments.known_holes import known_holes
from numpy_cae.experiments.lengths import lengths
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.missing_marker import missing_marker
from numpy_cae.experiments.nearest import nearest
from numpy_cae.experiments.repair_sweep import repair_sweep
from numpy_cae.experiments.sampling import sampling
from numpy_cae.experiments.shift import shift
from numpy_cae.experiments.stepped_keyframes import stepped_keyframes
from numpy_cae.experiments.times import times
from numpy_cae.experiments.two_unpoolings import two_unpoolings
from numpy_cae.manifold import MotionManifold


class Result(Protocol):
    """What an experiment returns. Where it helps it has `save_gif(path)` too."""

    title: str

    def text(self) -> str:
        """Its tables, in Markdown's form."""
        ...

    def findings(self) -> list[Finding]:
        """The claims that it weighs."""
        ...

    def save_picture(self, path: str | Path) -> None:
        """Draw it as PNG."""
        ...


Experiment = Callable[[MotionManifold, Material, int], Result]

REPORTED: dict[str, Experiment] = {
    experiment.__name__: experiment
    for experiment in (
        repair_sweep,
        kinect,
        missing_marker,
        stepped_keyframes,
        interpolation,
        nearest,
        comparison,
        geodesics,
        shift,
        sampling,
        filters,
        excited,
        two_unpoolings,
        lengths,
        known_holes,
        constrained_projection,
        times,
    )
}
"""Each experiment by its name."""

ALONE = (times.__name__,)
"""Those that measure time, and must have the machine to themselves."""
