"""The takes of a study with their labels, for training and for testing.

They are split by take, never by window: two windows of one take overlap.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from numpy_cae.cli.shared.files import named_files, usable
from numpy_cae.evaluation.tables import Clips, clips_of
from numpy_cae.mocap.bodies import read_body
from numpy_cae.mocap.load import is_test, load_motion
from numpy_cae.motion import Motion

if TYPE_CHECKING:
    from numpy_cae.manifold import MotionManifold

Take = TypeVar("Take")
_BANDAI = re.compile(r"dataset-\d_(?P<content>.+)_(?P<style>[^_]+)_\d+")
TESTING_WINDOWS = 120
"""TESTING_WINDOWS: at most this many windows, evenly spaced; more would take minutes and hardly
change the results."""
_SYNTHETIC = "synthetic"
_BANDAI_NAMCO = "bandai"
_UNLABELLED = "other"


@dataclass(frozen=True, eq=False)
class LabelledTake:
    """One take and its labels, such as "walk" and "tired", which are empty where unknown."""

    path: Path
    positions: np.ndarray  # (F, 20, 3), world positions in metres at 30 frames a second
    source: str = _UNLABELLED  # of the labels: labels.csv of data_synth, a name of Bandai Namco
    content: str = ""
    style: str = ""


@dataclass(frozen=True, eq=False)
class Material:
    """Takes to train on (or to fit a baseline to) and takes to measure on.

    `reading` are the arguments of `load_motion` with which their files were read.
    """

    training: list[LabelledTake]
    testing: list[LabelledTake]
    reading: Mapping[str, Any] = field(default_factory=dict)

    def counted(self) -> str:
        """How many takes there are of both kinds, in words."""
        return f"{len(self.training)} takes to fit baselines to, {len(self.testing)} to test"

    def of(self, source: str) -> Material:
        """The takes of one source, for training and for testing."""
        halves = (self.training, self.testing)
        chosen = [[take for take in half if take.source == source] for half in halves]
        return Material(*chosen, self.reading)

    def motion(self, take: LabelledTake) -> Motion:
        """A take in the rig of its file, at the rate of its file."""
        return load_motion(take.path, **self.reading)

    def labelled(self, what: str) -> Material:
        """Bandai Namco's takes if some of them are for testing, else the synthetic takes.

        ValueError, which begins with `what`, if none are for training or none for testing.
        """
        used = self.of(_BANDAI_NAMCO)
        if not used.testing:
            used = self.of(_SYNTHETIC)
        if not used.testing or not used.training:
            raise ValueError(f"{what} labelled takes, for training and for testing")
        return used


def features_of(manifold: MotionManifold, takes: Sequence[LabelledTake]) -> list[np.ndarray]:
    """The features (F, 63) of each take."""
    return [manifold.features(take.positions)[0] for take in takes]


def evenly(takes: Sequence[Take], count: int) -> list[Take]:
    """At most `count` takes, spread evenly over all."""
    chosen = np.linspace(0, len(takes) - 1, min(count, len(takes))).round().astype(int)
    return [takes[index] for index in chosen]


def testing_of(manifold: MotionManifold, material: Material) -> tuple[Clips, str]:
    """The windows to measure on, and a sentence that describes them."""
    testing = clips_of(manifold, [take.positions for take in material.testing])
    testing = testing.evenly(TESTING_WINDOWS)
    takes = len(np.unique(testing.take))
    return testing, f"Measured on {len(testing)} windows of {takes} takes not used in training."


def read_material(
    folders: Sequence[str | Path], patterns: Sequence[str], **reading: Any
) -> Material:
    """Read and label every motion file below the folders.

    Files whose name matches one of the patterns are for testing, the others for training;
    `reading` are arguments of `numpy_cae.mocap.load_motion`.
    """
    halves: tuple[list[LabelledTake], list[LabelledTake]] = ([], [])
    bodies = usable(list(named_files(folders)), partial(read_body, **reading))
    for path, (positions, _) in bodies:
        halves[is_test(path, patterns)].append(LabelledTake(path, positions, *labels_of(path)))
    return Material(*halves, reading)


def labels_of(path: Path) -> tuple[str, str, str]:
    """Source, content and style of a motion file."""
    named = _BANDAI.fullmatch(path.stem)
    if named:
        return _BANDAI_NAMCO, named["content"], named["style"]
    for folder in list(path.parents)[:2]:
        table = folder / "labels.csv"
        rows = _read_labels(table) if table.is_file() else {}
        if row := rows.get(path.relative_to(folder).as_posix()):
            return _SYNTHETIC, row["kind"], row["style"]
    return _UNLABELLED, "", ""


@lru_cache(maxsize=16)
def _read_labels(table: Path) -> dict[str, dict[str, str]]:
    """The rows of a labels.csv of data_synth by file."""
    with open(table, newline="", encoding="utf-8") as file:
        return {row.get("file", ""): row for row in csv.DictReader(file)}
