"""What `numpy-cae report` runs, in the order in which it tells of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from numpy_cae.experiments.comparison.comparison import comparison
from numpy_cae.experiments.comparison.nearest import nearest
from numpy_cae.experiments.filters.filters import filters
from numpy_cae.experiments.filters.top_activations import excited
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.interpolation.interpolation import interpolation
from numpy_cae.experiments.interpolation.sampling import sampling
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.repair.constrained_projection import constrained_projection
from numpy_cae.experiments.repair.kinect import kinect
from numpy_cae.experiments.repair.known_holes import known_holes
from numpy_cae.experiments.repair.lengths import lengths
from numpy_cae.experiments.repair.missing_marker import missing_marker
from numpy_cae.experiments.repair.repair_sweep import repair_sweep
from numpy_cae.experiments.repair.shift import shift
from numpy_cae.experiments.repair.stepped_keyframes import stepped_keyframes
from numpy_cae.experiments.repair.two_unpoolings import two_unpoolings
from numpy_cae.experiments.times import times
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
