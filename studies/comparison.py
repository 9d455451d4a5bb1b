"""Retrieval of similar motions by several distances: holden2015, section 7, "Motion Comparison".

Each test take searches the training takes. The files of Bandai Namco have several takes of one
person doing one thing in one style, which almost any distance finds; so two columns are harder: the
same content in another style, and the same style in another content, with the takes that agree in
both removed.

Each distance makes rows of numbers of a clip, one row or one for each of its windows; the distance
of two clips is the Euclidean distance of their nearest rows. For equation 4 that is √G, which ranks
as G does. For PCA a row has the coordinates of a window on `AXES` axes of the training takes.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.distance import cdist

from numpy_cae.evaluation import PCA
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold, hidden_units, signature
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.windows import cut_windows
from studies.shared.material import LabelledTake, Material, features_of
from studies.shared.result import Claim, Result, Table
from studies.shared.retrieval import average_precision

CONTENT, STYLE, BOTH = "content", "style", "both"
OTHER_STYLE, OTHER_CONTENT = "content, other style", "style, other content"
EQUATION_4 = "G, min and max of the hidden units"
UNTRAINED = "the same of an untrained network"
EUCLIDEAN = "Euclidean distance of windows"
RAW_EXTREMES = "min and max of the features"
PRINCIPAL = "PCA on windows"
AXES = 30
RANDOM = "drawn at random"
Rows = Callable[[np.ndarray], np.ndarray]
"""From the features (F, 63) of a clip to its rows, (n, d) numbers."""
Scores = dict[str, dict[str, float]]
"""Label to distance to the mean average precision over the queries that have something to find."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Search the training takes for each test take, with every distance.

    The seed is for the untrained network and the random order.
    """
    used = material.labelled("comparison needs")
    training = features_of(manifold, used.training)
    testing = features_of(manifold, used.testing)
    rows = rows_of_distances(manifold, seed)
    windows = np.concatenate([rows[EUCLIDEAN](features) for features in training])
    pca = PCA.fit(windows)
    rows[PRINCIPAL] = lambda features: (rows[EUCLIDEAN](features) - pca.mean) @ pca.axes[:AXES].T
    between = {name: distances(of_clip, testing, training) for name, of_clip in rows.items()}
    between[RANDOM] = np.random.default_rng(seed).random((len(testing), len(training)))
    average = retrieved(between, used.testing, used.training)
    by_distance = {name: [scores[name] for scores in average.values()] for name in between}
    caption = (
        f"{len(testing)} test takes, each searching {len(training)} training takes. Mean average "
        "precision for takes with the same label; in the last two columns takes that agree in both "
        "were removed:"
    )
    rows = [[name, *by_distance[name]] for name in between]
    return Result(
        "Motion comparison: what the distance of equation 4 finds",
        [Table(caption, ["distance", *average], rows, best="high")],
        _claims(average),
    )


def _claims(average: Scores) -> list[Claim]:
    """Against Euclidean distance for each label; against the others for all labels together."""
    claims = [
        Claim(
            "G_against_euclidean",
            scores[EQUATION_4] > scores[EUCLIDEAN],
            f"{scores[EQUATION_4]:.2f} against {scores[EUCLIDEAN]:.2f}.",
            label,
        )
        for label, scores in average.items()
    ]
    keys = {RAW_EXTREMES: "G_is_learned", UNTRAINED: "G_is_learned", PRINCIPAL: "G_against_pca"}
    for other, key in keys.items():
        gaps = {label: x[EQUATION_4] - x[other] for label, x in average.items()}
        listed = "; ".join(f"{label} {gap:+.2f}" for label, gap in gaps.items())
        higher = all(gap > 0 for gap in gaps.values())
        claims.append(Claim(key, higher, f"gaps {listed}.", f"against {other}"))
    return claims


def retrieved(
    between: dict[str, np.ndarray], queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> Scores:
    """The mean average precision of every distance, each a (Q, N) array."""
    average = {}
    for label, (alike, hidden) in labels_of_pairs(queries, gallery).items():
        answered = np.any(alike & ~hidden, axis=1)
        if not answered.any():
            continue
        visible = {name: np.where(hidden, np.inf, d)[answered] for name, d in between.items()}
        average[label] = {
            name: float(average_precision(d, alike[answered]).mean()) for name, d in visible.items()
        }
    return average


def labels_of_pairs(
    queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """For each label which takes are alike, and which are hidden from the query, both (Q, N)."""
    content, style = (
        np.array([[getattr(a, label) == getattr(b, label) for b in gallery] for a in queries])
        for label in (CONTENT, STYLE)
    )
    both = content & style
    nothing = np.zeros_like(content)
    labels = {CONTENT: content, STYLE: style, BOTH: both}
    alike = {label: (same, nothing) for label, same in labels.items()}
    return alike | {OTHER_STYLE: (content, both), OTHER_CONTENT: (style, both)}


def distances(rows: Rows, clips: Sequence[np.ndarray], others: Sequence[np.ndarray]) -> np.ndarray:
    """From each of M clips to each of N others, features (F, 63), as (M, N) float64."""
    parts, other_parts = ([rows(clip) for clip in each] for each in (clips, others))
    between = cdist(*(np.concatenate(each).astype(float) for each in (parts, other_parts)))
    nearest = np.minimum.reduceat(between, _first_rows(parts), axis=0)
    return np.minimum.reduceat(nearest, _first_rows(other_parts), axis=1)


def _first_rows(parts: Sequence[np.ndarray]) -> np.ndarray:
    return np.cumsum([0, *(len(part) for part in parts[:-1])])


def rows_of_distances(manifold: MotionManifold, seed: int = 0) -> dict[str, Rows]:
    """The rows of every distance, by name."""
    initial = untrained(manifold, seed)

    def windows(features: np.ndarray) -> np.ndarray:
        overlap = manifold.settings["overlap"]
        x = manifold.normalise(cut_windows(features, manifold.window, overlap)[0])
        return x.reshape(len(x), -1)

    return {
        EQUATION_4: lambda features: signature(hidden_units(manifold, features))[None],
        UNTRAINED: lambda features: signature(hidden_units(initial, features))[None],
        EUCLIDEAN: windows,
        RAW_EXTREMES: lambda features: signature(manifold.normalise(features))[None],
    }


def untrained(manifold: MotionManifold, seed: int) -> MotionManifold:
    """The same manifold with the initial weights of a seed."""
    layers = manifold.network.layers
    taps, features, _ = layers[0].w.shape
    filters = [layer.b.size for layer in layers]
    rng = np.random.default_rng(seed)
    network = ConvAutoencoder(features, filters, taps, layers[0].bound, rng)
    return replace(manifold, network=accelerate(network), rescales=False)
