"""A marker that is missing for a whole clip: holden2015, section 7, "Filling in Missing Data", and
figure 1, right (the wrist); then every joint in turn.

A missing joint is placed where it is in the mean pose, which is zero for the network. The network
does not know which joint is missing; the joint is read from the projection.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.experiments.clips import NETWORK, Clips
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.repair.repair_baselines import pca_on_frames, pca_on_windows
from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.experiments.split import split_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import FEATURES, JOINTS, joint_slice
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, TRUTH, bars_figure, world_actors

MEAN_POSE = "the mean pose"
LINEAR = "linear, 15 frames, joint known"
WRISTS = ("left_wrist", "right_wrist")
TARGET = 0.85
"""The wrist's error is to be below this share of the mean pose's."""
CAPTION = (
    "Error at the missing joint, cm (root mean square of a coordinate). The linear method knows "
    "which joint is missing and is solved for it; PCA and the network do not. Of the hips only the "
    "height can be missing: the other joints are measured from them."
)
Errors = dict[str, dict[str, float]]
"""Joint to method to error in cm."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Remove each joint for whole test windows and measure where each method places it."""
    split = split_of(manifold, material)
    testing = split.testing
    pcas = [pca_on_frames(split), pca_on_windows(split)]
    errors: Errors = {}
    motions = {}
    for joint in JOINTS:
        lost = _without(testing, joint)
        filled = {MEAN_POSE: lost}
        for pca in pcas:
            size = pca.best(_without(split.choosing, joint), split.choosing, joint)
            filled[pca.name] = pca.repair(lost, size)
        filled[NETWORK] = testing.each(lambda x, joint=joint: _projected(manifold, x, joint))
        filled[LINEAR] = split.moments.solve(_kept(joint)).repair(lost)
        errors[joint] = {name: testing.error(x, joint) for name, x in filled.items()}
        if joint == WRISTS[0]:
            window = testing.typical()
            motions = {
                "wrist as in the mean pose": (testing.features(lost, window), CORRUPTED),
                "wrist inferred": (testing.features(filled[NETWORK], window), PROJECTED),
                "truth": (testing.features(testing.x, window), TRUTH),
            }
    return Result(
        "Filling in: a missing marker",
        [_table(errors)],
        _claims(errors),
        lambda: _figure(errors),
        Animation(world_actors(motions), manifold.rate),
        split.text(),
    )


def _kept(joint: str) -> np.ndarray:
    """1 for each feature that is there, 0 for the joint's three."""
    kept = np.ones(FEATURES)
    kept[joint_slice(joint)] = 0
    return kept


def _projected(manifold: MotionManifold, features: np.ndarray, joint: str) -> np.ndarray:
    """Features (F, 63) with the joint as it is projected from the mean pose."""
    place, filled = joint_slice(joint), features.copy()
    filled[:, place] = manifold.mean_pose[place]
    filled[:, place] = manifold.project(filled)[:, place]
    return filled


def _without(clips: Clips, joint: str) -> np.ndarray:
    return clips.x * _kept(joint).astype(clips.x.dtype)


def over(errors: Errors, joints: tuple[str, ...], method: str) -> float:
    """Root mean square over several joints, each missing in its turn, cm."""
    return float(np.sqrt(np.mean([errors[joint][method] ** 2 for joint in joints])))


def _table(errors: Errors) -> Table:
    methods = list(errors[WRISTS[0]])
    rows = [[joint, *errors[joint].values()] for joint in JOINTS]
    rows.append(["all", *(over(errors, JOINTS, method) for method in methods)])
    mean, network = methods.index(MEAN_POSE) + 1, methods.index(NETWORK) + 1
    rows = [[*row, row[network] / row[mean]] for row in rows]
    return Table(CAPTION, ["missing joint", *methods, "network / mean pose"], rows)


def _claims(errors: Errors) -> list[Claim]:
    mean, network, linear = (over(errors, WRISTS, m) for m in (MEAN_POSE, NETWORK, LINEAR))
    pca = min(over(errors, WRISTS, m) for m in errors["hips"] if m.startswith("PCA"))
    better = [joint for joint, row in errors.items() if row[NETWORK] < row[MEAN_POSE]]
    return [
        Claim(
            "Projection infers the position of a wrist whose marker is missing (holden2015, "
            f"section 7; held if the error is below {TARGET} of the mean pose's).",
            network < TARGET * mean,
            f"{network:.2f} cm, the mean pose {mean:.2f} cm, {network / mean:.2f} of it.",
        ),
        Claim(
            "Projection infers every joint better than the mean pose does (not in the paper).",
            len(better) == len(JOINTS),
            f"{len(better)} of {len(JOINTS)} joints; over all {over(errors, JOINTS, NETWORK):.2f} "
            f"cm against {over(errors, JOINTS, MEAN_POSE):.2f}.",
        ),
        Claim(
            "The network infers a wrist better than linear methods do (not in the paper).",
            network < min(pca, linear),
            f"the network {network:.2f} cm, PCA {pca:.2f} cm, a linear map of 15 frames that "
            f"knows which joint is missing {linear:.2f} cm.",
        ),
    ]


def _figure(errors: Errors):
    colours = dict(zip(errors["hips"], (CORRUPTED, "#c0504d", "#4aa6a6"), strict=False))
    colours |= {NETWORK: PROJECTED, LINEAR: PLAIN}
    groups = [
        (method, [errors[joint][method] for joint in JOINTS], colour)
        for method, colour in colours.items()
    ]
    names = [joint.replace("_", " ") for joint in JOINTS]
    return bars_figure(names, groups, "error at the missing joint, cm")
