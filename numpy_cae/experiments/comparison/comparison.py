"""Motion comparison, holden2015, section 7: which distance finds what is alike?

Each held-out take looks through the training takes, so that no take finds itself. The files of
Bandai Namco have several takes of one person doing one thing in one manner, and those are found by
almost anything; so two columns ask for more: the same content in another style, and the same style
in another content, with the takes of both the same taken out of the gallery.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from numpy_cae.experiments.comparison.distances import (
    EQUATION_4,
    EUCLIDEAN,
    RAW_EXTREMES,
    UNTRAINED,
    WHITENED,
    all_distances,
)
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.measures.retrieval import (
    Difference,
    average_precision,
    bootstrapped_difference,
    precision_at_1,
)
from numpy_cae.viz import save_figure
from numpy_cae.viz.matrix import draw_matrix

CONTENT, STYLE, BOTH = "content", "style", "both"
OTHER_STYLE, OTHER_CONTENT = "content, other style", "style, other content"
_DRAWN = "drawn at random"


@dataclass(frozen=True)
class Comparison:
    """What each distance found.

    Parameters
    ----------
    precision, average : label to distance to (Q,) array
        Precision at 1 and average precision of every query that has something alike to find.
    own : (Q, Q) array
        √G of the held-out takes among themselves.
    names : list of Q str
        What the held-out takes are.
    gallery : int
        How many takes were looked through.
    seed : int
        Of the resampling.
    """

    precision: dict[str, dict[str, np.ndarray]]
    average: dict[str, dict[str, np.ndarray]]
    own: np.ndarray
    names: list[str]
    gallery: int
    seed: int
    title: str = "Motion comparison: what the distance of equation 4 finds"

    def difference(self, other: str, label: str) -> Difference:
        """Mean average precision of G less that of another distance, over the same takes."""
        average = self.average[label]
        return bootstrapped_difference(average[EQUATION_4], average[other], self.seed)

    def text(self) -> str:
        """Two tables: what each distance scores, and how sure its difference from G is."""
        labels = list(self.average)
        methods = list(self.average[labels[0]])
        scores = [
            [name, *[f"{self.precision[label][name].mean():.2f}, "
                     f"{self.average[label][name].mean():.2f}" for label in labels]]
            for name in methods
        ]  # fmt: skip
        gaps = [
            [name, *[self.difference(name, label).text() for label in labels]]
            for name in methods if name not in (EQUATION_4, _DRAWN)
        ]  # fmt: skip
        return (
            f"{len(self.names)} held-out takes, each looking through {self.gallery} training "
            "takes. Precision at 1 and mean average precision for what is alike by label; in the "
            "last two columns takes alike in both were taken out of the gallery:\n\n"
            f"{text_table(['distance', *labels], scores)}\n\n"
            "Mean average precision of G less that of each other distance, and the interval of 95 "
            "of 100 resamplings of the held-out takes:\n\n"
            f"{text_table(['G less', *labels], gaps)}"
        )

    def findings(self) -> list[Finding]:
        """The paper's claim for each label, and whether it is the network that earns it."""
        found = [self._matches(label) for label in self.average]
        for other in (RAW_EXTREMES, UNTRAINED, WHITENED):
            gaps = {label: self.difference(other, label) for label in self.average}
            said = "; ".join(f"{label} {gap.text()}" for label, gap in gaps.items())
            found.append(
                Finding(
                    "It is the learned manifold, not its pooling alone, that matches high level "
                    f"features (implied by holden2015, section 7): G finds more than {other}.",
                    all(gap.low > 0 for gap in gaps.values()),
                    f"mean average precision of G less that of {other}: {said}.",
                )
            )
        return found

    def _matches(self, label: str) -> Finding:
        gap = self.difference(EUCLIDEAN, label)
        ours, theirs = (self.average[label][name].mean() for name in (EQUATION_4, EUCLIDEAN))
        first, their_first = (
            self.precision[label][name].mean() for name in (EQUATION_4, EUCLIDEAN)
        )
        return Finding(
            "G correctly matches high level features where Euclidean distance does not "
            f"(holden2015, section 7): {label}.",
            gap.low > 0,
            f"mean average precision {ours:.2f} against {theirs:.2f}, difference {gap.text()}; "
            f"precision at 1 {first:.2f} against {their_first:.2f}.",
        )

    def save_picture(self, path: str | Path) -> None:
        """Bars of the mean average precision, and the clustered matrix of √G, PNG."""
        figure = Figure(figsize=(16, 10))
        bars, matrix = figure.subfigures(1, 2, width_ratios=[0.38, 0.62])
        labels = list(self.average)
        all_axes = bars.subplots(len(labels), 1, sharex=True)
        bars.subplots_adjust(0.44, 0.05, 0.97, 0.96, hspace=0.22)
        for axes, label in zip(np.atleast_1d(all_axes), labels, strict=True):
            average = {name: each.mean() for name, each in self.average[label].items()}
            names = list(average)
            colours = ["#2f6db5" if name == EQUATION_4 else "#b9b9b9" for name in names]
            axes.barh(names, average.values(), color=colours)
            axes.invert_yaxis()
            axes.set_xlim(0, 1)
            axes.set_title(f"{label}: mean average precision", fontsize=9, loc="left")
            axes.tick_params(labelsize=7)
            axes.spines[["top", "right"]].set_visible(False)
        draw_matrix(matrix, self.own, self.names, "√G of held-out takes")
        save_figure(figure, path)


def comparison(manifold: MotionManifold, material: Material, seed: int = 0) -> Comparison:
    """Let every held-out take look for what is like it, by every distance.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        Bandai Namco's takes are used where there are any, else the synthetic ones.
    seed : int
        Of the untrained network, the random order and the resampling.

    Raises
    ------
    ValueError
        If no labelled take is held out, or none is there to be found.
    """
    used = material.labelled("comparison needs")
    training, testing = (
        [manifold.features(take.positions)[0] for take in takes]
        for takes in (used.training, used.testing)
    )
    ways = all_distances(manifold, training, seed)
    between = {way.name: way.between(testing, training) for way in ways}
    shape = (len(testing), len(training))
    between[_DRAWN] = np.random.default_rng(seed).random(shape)
    precision, average = retrieved(between, used.testing, used.training)
    names = [f"{take.content}, {take.style}" for take in used.testing]
    return Comparison(precision, average, ways[0].between(testing), names, len(training), seed)


Scores = dict[str, dict[str, np.ndarray]]
"""Label to distance to one score for every query that has something alike to find."""


def retrieved(
    between: dict[str, np.ndarray], queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> tuple[Scores, Scores]:
    """Precision at 1 and average precision of every distance, each a (Q, N) array."""
    precision, average = {}, {}
    for label, (alike, hidden) in labels_of_pairs(queries, gallery).items():
        asked = np.any(alike & ~hidden, axis=1)
        if not asked.any():
            continue
        shown = {name: np.where(hidden, np.inf, each)[asked] for name, each in between.items()}
        precision[label] = {name: precision_at_1(d, alike[asked]) for name, d in shown.items()}
        average[label] = {name: average_precision(d, alike[asked]) for name, d in shown.items()}
    return precision, average


def labels_of_pairs(
    queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """For each label which takes are alike, and which are hidden from the query, both (Q, N)."""

    def same(label: str) -> np.ndarray:
        one, other = (
            np.array([getattr(take, label) for take in takes]) for takes in (queries, gallery)
        )
        return one[:, None] == other

    content, style = same(CONTENT), same(STYLE)
    both, nothing = content & style, np.zeros_like(content)
    return {
        CONTENT: (content, nothing),
        STYLE: (style, nothing),
        BOTH: (both, nothing),
        OTHER_STYLE: (content, both),
        OTHER_CONTENT: (style, both),
    }
