"""The experiments that `numpy-cae report` runs, by name, in the order of the report."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy_cae.experiments.material import Material
    from numpy_cae.experiments.result import Result
    from numpy_cae.manifold import MotionManifold

EXPERIMENTS = {
    "repair_sweep": "repair.repair_sweep",
    "kinect": "repair.kinect",
    "missing_marker": "repair.missing_marker",
    "stepped_keyframes": "repair.stepped_keyframes",
    "interpolation": "interpolation.interpolation",
    "nearest": "comparison.nearest",
    "comparison": "comparison.comparison",
    "shift": "comparison.shift",
    "sampling": "interpolation.sampling",
    "filters": "filters.filters",
    "top_activations": "filters.top_activations",
    "two_unpoolings": "repair.two_unpoolings",
    "lengths": "repair.lengths",
    "known_holes": "repair.known_holes",
    "constrained_projection": "repair.constrained_projection",
    "times": "times",
}
"""Name of each experiment to its module in `numpy_cae.experiments`."""

ALONE = ("times",)
"""Experiments that measure time, which nothing else may run beside."""


def experiment(name: str) -> Callable[[MotionManifold, Material, int], Result]:
    """The function `run(manifold, material, seed)` of an experiment.

    It raises ValueError where the material lacks what the experiment needs.
    """
    return import_module(f"numpy_cae.experiments.{EXPERIMENTS[name]}").run
