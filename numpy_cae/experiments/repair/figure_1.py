"""Figure 1, left, of holden2015: a motion of which half of the values are lost (orange), its
projection onto the manifold (blue), and the truth (green)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.repair.half_zeroed import P
from numpy_cae.experiments.result import Animation, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.measures import position_error
from numpy_cae.motion import features_to_positions
from numpy_cae.training import zero_values
from numpy_cae.viz import (
    CORRUPTED,
    PROJECTED,
    TRUTH,
    Motions,
    local_actors,
    strip_figure,
    world_actors,
)

CORRUPTED_NAME, PROJECTED_NAME, TRUE = "corrupted", "projected", "truth"


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Zero half of the values of the typical test take and project it."""
    features, _ = manifold.features(typical(manifold, material.testing).positions)
    motions = _half_lost(manifold, features, seed)
    errors = {name: position_error(x, features) for name, x in motions.items()}
    colours = (CORRUPTED, PROJECTED, TRUTH)
    drawn: Motions = {
        name if name == TRUE else f"{name}, {errors[name]:.1f} cm off": (x, colour)
        for (name, x), colour in zip(motions.items(), colours, strict=True)
    }
    return Result(
        "Figure 1: half of the values lost",
        [Table("", ["motion", "error, cm"], [[name, error] for name, error in errors.items()])],
        figure=lambda: strip_figure(local_actors(drawn), manifold.rate, azimuth=55.0),
        animation=Animation(world_actors(drawn), manifold.rate),
    )


def _half_lost(manifold: MotionManifold, features: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    lost = zero_values(manifold.normalise(features), P, np.random.default_rng(seed))
    corrupted = manifold.denormalise(lost)
    projected = manifold.project(corrupted)
    return {CORRUPTED_NAME: corrupted, PROJECTED_NAME: projected, TRUE: features}


def half_lost_positions(
    manifold: MotionManifold, take: np.ndarray, seed: int = 0
) -> dict[str, np.ndarray]:
    """World positions (F, 20, 3) in metres of a take: "corrupted", "projected" and "truth"."""
    features, start = manifold.features(take)
    motions = _half_lost(manifold, features, seed)
    return {name: features_to_positions(x, start) for name, x in motions.items()}


def typical(manifold: MotionManifold, takes: Sequence[LabelledTake]) -> LabelledTake:
    """The take whose distance from the mean pose is the median of all."""

    def distance(take: LabelledTake) -> float:
        features, _ = manifold.features(take.positions)
        return position_error(np.broadcast_to(manifold.mean_pose, features.shape), features)

    return sorted(takes, key=distance)[len(takes) // 2]
