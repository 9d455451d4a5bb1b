"""A marker that is missing for a whole clip: holden2015, section 7, "Filling in Missing Data", and
figure 1, right (the wrist), then every joint in turn.

Missing is zero in the network's terms: the joint is put where it is in the mean pose. Nobody tells
the network which joint that is; it is projected and looked up in what comes out (`fill_joint`).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.baselines import Moments
from numpy_cae.experiments.clips import NETWORK, Clips
from numpy_cae.experiments.example import Example
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.repair.repair_baselines import pca_on_frames, pca_on_windows
from numpy_cae.experiments.split import split_of
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold, fill_joint
from numpy_cae.motion import FEATURES, JOINTS, joint_slice
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, TRUTH, bars_figure, save_figure

MEAN_POSE = "the mean pose"
TOLD = "linear, 15 frames, told which"
WRISTS = ("left_wrist", "right_wrist")
TARGET = 0.85
"""Of the mean pose's error: what the wrist's should stay below."""


@dataclass(frozen=True)
class MissingMarker:
    """Error at the missing joint in cm, by joint, then by method."""

    errors: dict[str, dict[str, float]]
    example: Example
    sample: str
    title: str = "Filling in: a missing marker"

    def over(self, joints: tuple[str, ...], method: str) -> float:
        """Root mean square over several joints, each missing in its turn, cm."""
        return float(np.sqrt(np.mean([self.errors[joint][method] ** 2 for joint in joints])))

    def text(self) -> str:
        """A row for each joint and one for all."""
        methods = list(self.errors[WRISTS[0]])
        rows = [(joint, [self.errors[joint][method] for method in methods]) for joint in JOINTS]
        rows.append(("all", [self.over(JOINTS, method) for method in methods]))
        mean, network = methods.index(MEAN_POSE), methods.index(NETWORK)
        lines = [
            [name, *(f"{error:.2f}" for error in row), f"{row[network] / row[mean]:.2f}"]
            for name, row in rows
        ]
        table = text_table(["missing joint", *methods, "network / mean pose"], lines)
        return (
            "Error at the missing joint, cm (root mean square a coordinate). The last method is "
            "told which joint is missing and solved for it; PCA and the network are not. Of the "
            "hips only the height can be missing: the others are measured from them.\n\n"
            f"{table}\n\n{self.sample}"
        )

    def findings(self) -> list[Finding]:
        """The paper's wrist, then every joint, then the least that one could do."""
        mean, network, told = (self.over(WRISTS, m) for m in (MEAN_POSE, NETWORK, TOLD))
        pca = min(self.over(WRISTS, m) for m in self.errors["hips"] if m.startswith("PCA"))
        better = [joint for joint, row in self.errors.items() if row[NETWORK] < row[MEAN_POSE]]
        return [
            Finding(
                "Projection infers where a wrist is whose marker is missing (holden2015, "
                f"section 7; held if it is below {TARGET} of filling in the mean pose).",
                network < TARGET * mean,
                f"{network:.2f} cm, the mean pose {mean:.2f} cm, {network / mean:.2f} of it.",
            ),
            Finding(
                "Projection infers any joint better than the mean pose does (not in the paper).",
                len(better) == len(JOINTS),
                f"{len(better)} of {len(JOINTS)} joints; over all "
                f"{self.over(JOINTS, NETWORK):.2f} cm against "
                f"{self.over(JOINTS, MEAN_POSE):.2f}.",
            ),
            Finding(
                "The network infers a wrist better than linear methods do (not in the paper).",
                network < min(pca, told),
                f"the network {network:.2f} cm, PCA {pca:.2f} cm, a linear map of 15 frames that "
                f"is told which joint is missing {told:.2f} cm.",
            ),
        ]

    def save_picture(self, path: str | Path) -> None:
        """Bars for each joint, PNG."""
        colours = dict(zip(self.errors["hips"], (CORRUPTED, "#c0504d", "#4aa6a6"), strict=False))
        colours |= {NETWORK: PROJECTED, TOLD: PLAIN}
        groups = [
            (method, [self.errors[joint][method] for joint in JOINTS], colour)
            for method, colour in colours.items()
        ]
        names = [joint.replace("_", " ") for joint in JOINTS]
        save_figure(bars_figure(names, groups, "error at the missing joint, cm"), path)

    def save_gif(self, path: str | Path) -> None:
        """The left wrist in the mean pose's place, inferred, and where it was."""
        self.example.save_gif(path)


def missing_marker(manifold: MotionManifold, material: Material, seed: int = 0) -> MissingMarker:
    """Take each joint away for whole windows and look where each method puts it.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
    seed : int
        Nothing is drawn; every experiment takes one.
    """
    split = split_of(manifold, material)
    testing = split.testing
    pcas = [pca_on_frames(split), pca_on_windows(split)]
    moments = Moments.of(split.training.x, split.training.real)
    errors, example = {}, None
    for joint in JOINTS:
        lost = _without(testing, joint)
        filled = {MEAN_POSE: lost}
        for pca in pcas:
            size = pca.best(_without(split.choosing, joint), split.choosing, joint)
            filled[pca.name] = pca.repair(lost, size)
        filled[NETWORK] = testing.each(lambda x, joint=joint: fill_joint(manifold, x, joint))
        filled[TOLD] = moments.solve(_kept(joint)).repair(lost)
        errors[joint] = {name: testing.error(x, joint) for name, x in filled.items()}
        if joint == WRISTS[0]:
            example = _example(testing, lost, filled[NETWORK])
    return MissingMarker(errors, example, split.text())


def _without(clips: Clips, joint: str) -> np.ndarray:
    return clips.x * _kept(joint).astype(clips.x.dtype)


def _kept(joint: str) -> np.ndarray:
    """1 for each feature that is there, 0 for the joint's three."""
    kept = np.ones(FEATURES)
    kept[joint_slice(joint)] = 0
    return kept


def _example(testing: Clips, lost: np.ndarray, inferred: np.ndarray) -> Example:
    return Example.of(
        testing,
        testing.typical(),
        {
            "wrist as in the mean pose": (lost, CORRUPTED),
            "wrist inferred": (inferred, PROJECTED),
            "truth": (testing.x, TRUTH),
        },
    )
