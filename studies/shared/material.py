"""The takes of a study with their labels, for training and for testing.

They are split by take, never by window: two windows of one take overlap.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from numpy_cae.evaluation.tables import Clips, clips_of
from numpy_cae.mocap import find_motion_files
from numpy_cae.mocap.bodies import Problem, read_body, read_files
from numpy_cae.mocap.load import load_motion, matches_any
from numpy_cae.motion import Motion
from studies.shared.messages import note

if TYPE_CHECKING:
    from numpy_cae.manifold import MotionManifold

Take = TypeVar("Take")
_BANDAI = re.compile(r"dataset-\d_(?P<content>.+)_(?P<style>[^_]+)_\d+")
TESTING_WINDOWS = 120
"""Studies measure on at most this many windows, evenly spaced; more would take minutes and hardly
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
        training = [take for take in self.training if take.source == source]
        testing = [take for take in self.testing if take.source == source]
        return Material(training, testing, self.reading)

    def motion(self, take: LabelledTake) -> Motion:
        """A take in the rig of its file, at the rate of its file."""
        return load_motion(take.path, **self.reading)

    def labelled(self, study: str) -> Material:
        """Bandai Namco's takes if some of them are for testing, else the synthetic takes.

        ValueError, which names the study, if none are for training or none for testing.
        """
        takes = self.of(_BANDAI_NAMCO)
        if not takes.testing:
            takes = self.of(_SYNTHETIC)
        if not takes.testing or not takes.training:
            raise ValueError(f"{study} needs labelled takes, for training and for testing")
        return takes


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
    testing = testing.pick_evenly(TESTING_WINDOWS)
    takes = len(np.unique(testing.take))
    return testing, f"Measured on {len(testing)} windows of {takes} takes not used in training."


def read_takes(paths: Sequence[Path], read: Callable[[Path], Take]) -> Iterator[tuple[Path, Take]]:
    """Each file that `read` can read, with what it returns; the others are noted and left out.

    Raises ValueError if no file can be read.
    """
    unreadable = 0
    for path, take in zip(paths, read_files(paths, read), strict=True):
        if isinstance(take, Problem):
            unreadable += 1
            note(f"left out: {take}")
        else:
            yield path, take
    if unreadable == len(paths):
        raise ValueError(f"none of {unreadable} files can be read, see above")


def read_material(
    folders: Sequence[str | Path], patterns: Sequence[str], **reading: Any
) -> Material:
    """Read and label every motion file below the folders.

    Files whose name matches one of the patterns are for testing, the others for training;
    `reading` are arguments of `numpy_cae.mocap.load_motion`.
    """
    paths = []
    for folder in folders:
        paths += find_motion_files(folder)
    training = []
    testing = []
    paths = list(dict.fromkeys(paths))
    for path, (positions, _) in read_takes(paths, partial(read_body, **reading)):
        take = LabelledTake(path, positions, *labels_of(path))
        if matches_any(path, patterns):
            testing.append(take)
        else:
            training.append(take)
    return Material(training, testing, reading)


def labels_of(path: Path) -> tuple[str, str, str]:
    """Source, content and style of a motion file."""
    match = _BANDAI.fullmatch(path.stem)
    if match:
        return _BANDAI_NAMCO, match["content"], match["style"]
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
