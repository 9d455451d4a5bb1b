"""Retrieval of similar motions by several distances: holden2015, section 7, "Motion Comparison".

Each test take searches the training takes. The files of Bandai Namco have several takes of one
person doing one thing in one style, which almost any distance finds; so two columns are harder: the
same content in another style, and the same style in another content, with the takes that agree in
both removed.

Each distance makes rows of numbers of a clip, one row or one for each of its windows; the distance
of two clips is the Euclidean distance of their nearest rows. For equation 4 that is √G, which ranks
as G does. For PCA a row has the coordinates of a window on `AXES` axes of the training takes.

The mean over all queries of the average precision is in the table. A query searches a gallery,
nearest first; with rel(r) = 1 where the motion at rank r is relevant, and R of them in the gallery,

    average precision   1/R · Σ_r rel(r) · (rel(1) + … + rel(r)) / r

Delays: is G "temporally invariant" (equation 4)? Each test take is delayed: its first pose is held
for 1 to 24 frames, so that its content is the same. The take that changes most counts. A window
that is moved inside a take has another content, which says nothing of invariance.

The nearest of a confident walk with a turn: by Euclidean distance the paper finds a sidestep and an
old man's walk, by G "only motions with confident walks and turns". Queries and the motions that
they search are synthetic (`data_synth`), each of another person, whatever the model has learned
from.

    python -m studies comparison --data bandai --test '*_005.bvh' -m best.npz
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.distance import cdist

from data_synth import make_take
from numpy_cae.evaluation import PCA
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold, hidden_units, signature
from numpy_cae.mocap import body_of
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.features import TURN, VELOCITY
from numpy_cae.motion.windows import cut_windows
from studies.shared.judging import all_of, mean_of
from studies.shared.material import LabelledTake, Material, evenly, features_of
from studies.shared.result import Claim, Result, Table, combined

CONTENT = "content"
STYLE = "style"
EQUATION_4 = "G, min and max of the hidden units"
UNTRAINED = "the same of an untrained network"
EUCLIDEAN = "Euclidean distance of windows"
RAW_EXTREMES = "min and max of the features"
PRINCIPAL = "PCA on windows"
AXES = 30
RANDOM = "drawn at random"
DELAYS = (1, 2, 4, 8, 12, 16, 24)
"""In frames."""
TAKES = 60
"""The most test takes that are delayed."""
MOST = 0.05
"""G is invariant if no delay changes it by more than this share of the median distance of two
takes."""
QUERY = "confident walk with a turn"
SCENES = {
    QUERY: ("walk_with_turn", "confident"),
    "confident walk": ("confident_walk", "confident"),
    "walk with a turn": ("walk_with_turn", "neutral"),
    "walk": ("walk", "neutral"),
    "tired walk": ("walk", "tired"),
    "old man's walk": ("old_mans_walk", "old"),
    "sidestep": ("sidestep", "neutral"),
    "run": ("run", "run"),
    "wave": ("wave", "neutral"),
}
"""Name of a motion to kind and style of `data_synth`."""
SIMILAR = (QUERY, "confident walk", "walk with a turn")
ODD = ("old man's walk", "sidestep")
QUERIES = 8
OF_SCENE = 6
"""Each query searches so many motions of each of `SCENES`."""
SECONDS = 8.0
NEAREST = 5
Rows = Callable[[np.ndarray], np.ndarray]
"""From the features (F, 63) of a clip to its rows, (n, d) numbers."""
Scores = dict[str, dict[str, float]]
"""Label to distance to the mean average precision over the queries that have something to find."""
Precisions = dict[str, dict[str, np.ndarray]]
"""Label to distance to the average precision of each query that has something to find, (Q,)."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Search for each test take, delay the test takes, and search for confident walks.

    The seed is for the untrained network, the random order and the synthetic motions.
    """
    rows = rows_of_distances(manifold, seed)
    takes = features_of(manifold, evenly(material.testing, TAKES))
    few = {name: rows[name] for name in (EQUATION_4, EUCLIDEAN, RAW_EXTREMES)}
    labelled = material.labelled("comparison")
    principal = {
        PRINCIPAL: principal_scores(rows[EUCLIDEAN], features_of(manifold, labelled.training))
    }
    parts = [
        retrieval(manifold, labelled, rows | principal, seed),
        delays(few, takes),
        nearest(manifold, few | principal, seed),
    ]
    return combined("Motion comparison: what the distance of equation 4 finds", parts)


def retrieval(manifold: MotionManifold, used: Material, rows: dict[str, Rows], seed: int) -> Result:
    """Search the training takes for each test take, with every distance."""
    training = features_of(manifold, used.training)
    testing = features_of(manifold, used.testing)
    between = {name: distances(of_clip, testing, training) for name, of_clip in rows.items()}
    between[RANDOM] = np.random.default_rng(seed).random((len(testing), len(training)))
    precisions = precisions_of_queries(between, used.testing, used.training)
    average = mean_precisions(precisions)
    by_distance = {name: [scores[name] for scores in average.values()] for name in between}
    caption = (
        f"{len(testing)} test takes, each searching {len(training)} training takes. Mean average "
        "precision for takes with the same label; in the last two columns takes that agree in both "
        "were removed:"
    )
    table = Table(
        caption,
        ["distance", *average],
        [[name, *by_distance[name]] for name in between],
    )
    return Result("", [table], _claims(precisions))


def principal_scores(windows: Rows, training: list[np.ndarray]) -> Rows:
    """The coordinates of the windows of a clip on `AXES` axes of the windows of training takes."""
    pca = PCA.fit(np.concatenate([windows(features) for features in training]))
    return lambda clip: (windows(clip) - pca.mean) @ pca.axes[:AXES].T


def _claims(precisions: Precisions) -> list[Claim]:
    """Against Euclidean distance for each label; against the others for all labels together."""
    average = mean_precisions(precisions)
    claims = []
    for label, of_distances in precisions.items():
        gap = mean_of(of_distances[EQUATION_4] - of_distances[EUCLIDEAN])
        figures = f"{average[label][EQUATION_4]:.2f}, {gap:+.2f} to {EUCLIDEAN};"
        simple = {name: average[label][name] for name in (EUCLIDEAN, RAW_EXTREMES, UNTRAINED)}
        opponent = ", ".join(f"{name} {value:.2f}" for name, value in simple.items())
        also = []
        for name in (RAW_EXTREMES, UNTRAINED):
            if mean_of(of_distances[name] - of_distances[EUCLIDEAN]).above(0):
                also.append(name)
        claims.append(
            Claim(
                "G_against_euclidean",
                gap.above(0),
                figures,
                label,
                f"{opponent}.",
                " and ".join(also),
            )
        )
    keys = {RAW_EXTREMES: "G_is_learned", UNTRAINED: "G_is_learned", PRINCIPAL: "G_against_pca"}
    for opponent, key in keys.items():
        gaps = {}
        for label, of_distances in precisions.items():
            gaps[label] = mean_of(of_distances[EQUATION_4] - of_distances[opponent])
        listed = "; ".join(f"{label} {gap:+.2f}" for label, gap in gaps.items())
        is_higher = all_of(*(gap.above(0) for gap in gaps.values()))
        claims.append(Claim(key, is_higher, f"gaps {listed}.", f"against {opponent}"))
    return claims


def mean_precisions(precisions: Precisions) -> Scores:
    """The mean over the queries."""
    average: Scores = {}
    for label, of_distances in precisions.items():
        average[label] = {name: float(values.mean()) for name, values in of_distances.items()}
    return average


def precisions_of_queries(
    between: dict[str, np.ndarray], queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> Precisions:
    """The average precision of every distance, each a (Q, N) array, for each query that has
    something to find."""
    precisions: Precisions = {}
    for label, (relevant, hidden) in labels_of_pairs(queries, gallery).items():
        has_answer = np.any(relevant & ~hidden, axis=1)
        if not has_answer.any():
            continue
        precisions[label] = {}
        for name, distances in between.items():
            visible = np.where(hidden, np.inf, distances)[has_answer]
            precisions[label][name] = average_precision(visible, relevant[has_answer])
    return precisions


def average_precision(distances: np.ndarray, relevant: np.ndarray) -> np.ndarray:
    """The precision at the rank of each relevant motion, averaged over those.

    Parameters
    ----------
    distances : (Q, N) array of float
        From each query to each motion of the gallery; infinite for those that are left out.
    relevant : (Q, N) array of bool
        The motions that are relevant to each query.

    Returns
    -------
    (Q,) array of float64

    Raises
    ------
    ValueError
        If nothing in the gallery is relevant to one of the queries.
    """
    relevant = relevant & np.isfinite(distances)
    order = np.argsort(distances, axis=1, kind="stable")
    ranked = np.take_along_axis(relevant, order, axis=1)
    count = ranked.sum(axis=1)
    if np.any(count == 0):
        query = int(np.argmin(count))
        raise ValueError(f"nothing in the gallery is like query {query}: it has no precision")
    precision = np.cumsum(ranked, axis=1) / np.arange(1, ranked.shape[1] + 1)
    return np.sum(precision * ranked, axis=1) / count


def labels_of_pairs(
    queries: Sequence[LabelledTake], gallery: Sequence[LabelledTake]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """For each label which takes are relevant, and which are hidden from the query, both (Q, N)."""
    content = _equal([take.content for take in queries], [take.content for take in gallery])
    style = _equal([take.style for take in queries], [take.style for take in gallery])
    both = content & style
    nothing = np.zeros_like(content)
    return {
        CONTENT: (content, nothing),
        STYLE: (style, nothing),
        "both": (both, nothing),
        "content, other style": (content, both),
        "style, other content": (style, both),
    }


def _equal(labels: list[str], gallery_labels: list[str]) -> np.ndarray:
    """Whether each label equals each of the gallery, (Q, N)."""
    return np.array(labels)[:, None] == np.array(gallery_labels)


def distances(rows: Rows, clips: Sequence[np.ndarray], gallery: Sequence[np.ndarray]) -> np.ndarray:
    """From each of M clips to each of N of the gallery, features (F, 63), as (M, N) float64."""
    parts = [rows(clip) for clip in clips]
    gallery_parts = [rows(clip) for clip in gallery]
    between = cdist(
        np.concatenate(parts).astype(float), np.concatenate(gallery_parts).astype(float)
    )
    nearest = np.minimum.reduceat(between, _first_rows(parts), axis=0)
    return np.minimum.reduceat(nearest, _first_rows(gallery_parts), axis=1)


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


def delays(rows: dict[str, Rows], takes: list[np.ndarray]) -> Result:
    """The squared distance of each take, features (F, 63), to its delayed copies."""
    shares = {name: _of_delays(of_clip, takes) for name, of_clip in rows.items()}
    header = ["squared distance", *(f"{delay} frames" for delay in DELAYS)]
    caption = (
        "Of a take and its delayed copy, as a share of the median of two takes: the median take"
    )
    medians = [[name, *np.median(of_takes, axis=1)] for name, of_takes in shares.items()]
    worst = [[name, *of_takes.max(axis=1)] for name, of_takes in shares.items()]
    tables = [
        Table(f"{caption}:", header, medians, ".1%"),
        Table("The same, the take that changes most:", header, worst, ".1%"),
    ]
    largest = {name: float(of_takes.max()) for name, of_takes in shares.items()}
    typical = {name: float(np.median(of_takes, axis=1).max()) for name, of_takes in shares.items()}
    simple = min((RAW_EXTREMES, EUCLIDEAN), key=lambda name: largest[name])
    claim = Claim(
        "G_invariant",
        largest[EQUATION_4] <= MOST,
        f"at most {largest[EQUATION_4]:.1%} of the median distance of two takes, "
        f"{typical[EQUATION_4]:.1%} for the median take;",
        opponent=f"min and max of the features {largest[RAW_EXTREMES]:.1%}, "
        f"{typical[RAW_EXTREMES]:.1%}; Euclidean distance {largest[EUCLIDEAN]:.1%}.",
        fulfilled_by=simple if largest[simple] <= MOST else "",
    )
    return Result("", tables, [claim])


def _of_delays(rows: Rows, takes: list[np.ndarray]) -> np.ndarray:
    """For each delay and take the squared distance to the delayed take, as a share of the median
    of two takes: (delays, takes)."""
    between = distances(rows, takes, takes) ** 2
    median = np.median(between[~np.eye(len(takes), dtype=bool)])
    shares = []
    for delay in DELAYS:
        of_takes = []
        for take in takes:
            of_takes.append(distances(rows, [take], [_delayed(take, delay)])[0, 0] ** 2)
        shares.append(np.array(of_takes) / median)
    return np.array(shares)


def _delayed(features: np.ndarray, frames: int) -> np.ndarray:
    """The same motion after its first pose was held, standing still."""
    held = np.repeat(features[:1], frames, axis=0)
    held[:, VELOCITY] = 0
    held[:, TURN] = 0
    return np.concatenate([held, features])


def nearest(manifold: MotionManifold, rows: dict[str, Rows], seed: int) -> Result:
    """Search for the motions nearest to each confident walk with a turn."""
    scenes: list[str] = []
    for scene in SCENES:
        scenes += [scene] * OF_SCENE
    clips = []
    for number, scene in enumerate([QUERY] * QUERIES + scenes):
        clips.append(manifold.features(_body(scene, seed, number))[0])
    counts = {}
    places_found = {}
    for name, of_clip in rows.items():
        between = distances(of_clip, clips[:QUERIES], clips[QUERIES:])
        places_found[name] = np.argsort(between, axis=1, kind="stable")[:, :NEAREST]
        counts[name] = Counter(scenes[place] for place in places_found[name].ravel())
    table = Table(
        f"Shares of the nearest {NEAREST} of {QUERIES} queries, {QUERY}:",
        ["motion", *rows],
        [[scene, *(_share(counts[name], [scene]) for name in rows)] for scene in SCENES],
        ".0%",
    )
    return Result("", [table], _claims_of_example(places_found, scenes))


def _claims_of_example(places_found: dict[str, np.ndarray], scenes: list[str]) -> list[Claim]:
    """What each distance finds for the paper's own example: the places of the nearest motions of
    each query, (Q, `NEAREST`)."""
    similar = {name: _shares(places, scenes, SIMILAR) for name, places in places_found.items()}
    odd = {name: _shares(places, scenes, ODD) for name, places in places_found.items()}
    ours = mean_of(similar[EQUATION_4])
    of_all = {name: float(of_queries.mean()) for name, of_queries in similar.items()}
    perfect = [name for name in (RAW_EXTREMES, PRINCIPAL, EUCLIDEAN) if of_all[name] == 1]
    opponents = ", ".join(f"{name} {of_all[name]:.0%}" for name in similar if name != EQUATION_4)
    gap = mean_of(similar[EQUATION_4] - similar[PRINCIPAL])
    gap_of_features = mean_of(similar[RAW_EXTREMES] - similar[PRINCIPAL])
    euclidean = mean_of(odd[EUCLIDEAN])
    return [
        Claim(
            "G_finds_only",
            of_all[EQUATION_4] == 1,
            f"{ours:.0%} of the nearest are confident walks or have turns;",
            opponent=f"{opponents}.",
            fulfilled_by=" and ".join(perfect),
        ),
        Claim(
            "euclidean_odd",
            euclidean.value > 0,
            f"{euclidean:.0%} of its nearest are such motions;",
            opponent=f"G {odd[EQUATION_4].mean():.0%}.",
            fulfilled_by=EQUATION_4 if odd[EQUATION_4].any() else "",
        ),
        Claim(
            "G_finds_more_than_pca",
            gap.above(0),
            f"{of_all[EQUATION_4]:.0%} of G's nearest are confident walks or have turns, "
            f"{gap:+.0%} to the opponent's;",
            opponent=f"{PRINCIPAL} {of_all[PRINCIPAL]:.0%}, "
            f"{RAW_EXTREMES} {of_all[RAW_EXTREMES]:.0%}.",
            fulfilled_by=RAW_EXTREMES if gap_of_features.above(0) else "",
        ),
    ]


def _shares(places: np.ndarray, scenes: list[str], similar: Sequence[str]) -> np.ndarray:
    """For each query the share of its nearest motions that are of certain scenes, (Q,)."""
    is_similar = np.array([scene in similar for scene in scenes])
    return is_similar[places].mean(axis=1)


def _body(scene: str, seed: int, number: int) -> np.ndarray:
    kind, style = SCENES[scene]
    rng = np.random.default_rng([seed, number])
    return body_of(make_take(kind, rng, SECONDS, 30.0, style).motion)


def _share(counts: Counter, scenes: Sequence[str]) -> float:
    return sum(counts[scene] for scene in scenes) / (QUERIES * NEAREST)
