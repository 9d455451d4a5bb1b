"""Retrieval of similar motions by several distances: holden2015, section 7, "Motion Comparison".

Each test take searches the training takes. The files of Bandai Namco have several takes of one
person doing one thing in one style, which almost any distance finds; so two columns are harder: the
same content in another style, and the same style in another content, with the takes that agree in
both removed.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation.retrieval import (
    Difference,
    average_precision,
    bootstrapped_difference,
    precision_at_1,
)
from numpy_cae.experiments.comparison.distances import (
    EQUATION_4,
    EUCLIDEAN,
    RAW_EXTREMES,
    UNTRAINED,
    WHITENED,
    all_distances,
)
from numpy_cae.experiments.material import LabelledTake, Material, features_of
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.viz import bars_figure

CONTENT, STYLE, BOTH = "content", "style", "both"
OTHER_STYLE, OTHER_CONTENT = "content, other style", "style, other content"
RANDOM = "drawn at random"
Scores = dict[str, dict[str, np.ndarray]]
"""Label to distance to one score for every query that has something similar to find."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Search the training takes for each test take, with every distance.

    The seed is for the untrained network, the random order and the resampling.
    """
    used = material.labelled("comparison needs")
    training, testing = features_of(manifold, used.training), features_of(manifold, used.testing)
    distances = all_distances(manifold, training, seed)
    between = {distance.name: distance.between(testing, training) for distance in distances}
    between[RANDOM] = np.random.default_rng(seed).random((len(testing), len(training)))
    precision, average = retrieved(between, used.testing, used.training)
    gaps = {
        name: {
            label: bootstrapped_difference(each[EQUATION_4], each[name], seed)
            for label, each in average.items()
        }
        for name in between
        if name not in (EQUATION_4, RANDOM)
    }
    scores = [
        [name, *(f"{precision[label][name].mean():.2f}, {average[label][name].mean():.2f}"
                 for label in average)]
        for name in between
    ]  # fmt: skip
    differences = [[name, *(gap.text() for gap in by.values())] for name, by in gaps.items()]
    caption = (
        f"{len(testing)} test takes, each searching {len(training)} training takes. Precision at 1 "
        "and mean average precision for takes with the same label; in the last two columns takes "
        "that agree in both were removed:"
    )
    gap_caption = (
        "Mean average precision of G minus that of each other distance, with the interval of 95 of "
        "100 resamplings of the test takes:"
    )
    return Result(
        "Motion comparison: what the distance of equation 4 finds",
        [
            Table(caption, ["distance", *average], scores),
            Table(gap_caption, ["G minus", *average], differences),
        ],
        _claims(precision, average, gaps),
        lambda: bars_figure(
            list(between),
            [
                (label, [each[name].mean() for name in between], None)
                for label, each in average.items()
            ],
            "mean average precision",
        ),
    )


def _claims(
    precision: Scores, average: Scores, gaps: dict[str, dict[str, Difference]]
) -> list[Claim]:
    claims = []
    for label, gap in gaps[EUCLIDEAN].items():
        ours, theirs = (average[label][name].mean() for name in (EQUATION_4, EUCLIDEAN))
        first, their_first = (precision[label][name].mean() for name in (EQUATION_4, EUCLIDEAN))
        claims.append(
            Claim(
                "G correctly matches high-level features where Euclidean distance does not "
                f"(holden2015, section 7): {label}.",
                gap.low > 0,
                f"mean average precision {ours:.2f} against {theirs:.2f}, difference "
                f"{gap.text()}; precision at 1 {first:.2f} against {their_first:.2f}.",
            )
        )
    for other in (RAW_EXTREMES, UNTRAINED, WHITENED):
        listed = "; ".join(f"{label} {gap.text()}" for label, gap in gaps[other].items())
        claims.append(
            Claim(
                "The learned manifold, not its pooling alone, matches high-level features "
                f"(implied by holden2015, section 7): G finds more than {other}.",
                all(gap.low > 0 for gap in gaps[other].values()),
                f"mean average precision of G minus that of {other}: {listed}.",
            )
        )
    return claims


def retrieved(
    between: dict[str, np.ndarray], queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> tuple[Scores, Scores]:
    """Precision at 1 and average precision of every distance, each a (Q, N) array."""
    precision, average = {}, {}
    for label, (alike, hidden) in labels_of_pairs(queries, gallery).items():
        found = np.any(alike & ~hidden, axis=1)
        if not found.any():
            continue
        visible = {name: np.where(hidden, np.inf, each)[found] for name, each in between.items()}
        precision[label] = {name: precision_at_1(d, alike[found]) for name, d in visible.items()}
        average[label] = {name: average_precision(d, alike[found]) for name, d in visible.items()}
    return precision, average


def labels_of_pairs(
    queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """For each label which takes are alike, and which are hidden from the query, both (Q, N)."""

    content, style = (
        np.array([[getattr(a, label) == getattr(b, label) for b in gallery] for a in queries])
        for label in (CONTENT, STYLE)
    )
    both, nothing = content & style, np.zeros_like(content)
    return {
        CONTENT: (content, nothing),
        STYLE: (style, nothing),
        BOTH: (both, nothing),
        OTHER_STYLE: (content, both),
        OTHER_CONTENT: (style, both),
    }
