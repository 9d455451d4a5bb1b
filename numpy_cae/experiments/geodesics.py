"""Geodesics: holden2015's abstract promises "computing similarity between motions using geodesic
distance along the manifold" and no section comes back to it.

Three questions, each with its claim written down before it was measured:

flat       how much longer is the way along the manifold than the line through the space of motions?
halfway    between a motion and the same k frames later, is the geodesic's middle what comes k/2
           frames later? A straight line leaves a walk there; a good path would walk.
alike      does its length find what is alike, beside equation 4 and Euclidean distance?

In the last stands also the distance that goes from motion to motion that was seen, the shortest
path in a graph of nearest windows (Tenenbaum, de Silva and Langford 2000).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import shortest_path
from scipy.spatial.distance import cdist

from numpy_cae.experiments.comparison import retrieved
from numpy_cae.experiments.distances import (
    EQUATION_4,
    EUCLIDEAN,
    equation_4,
    euclidean,
    raw_windows,
)
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import LabelledTake, Material, evenly
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold, geodesic_matrix
from numpy_cae.manifold.interpolate import GEODESIC, LINE, way_between
from numpy_cae.measures import position_error
from numpy_cae.measures.retrieval import bootstrapped_difference
from numpy_cae.motion import PARENTS, POSITIONS
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, TRUTH, Actor, save_figure, strip_figure

LATER = (4, 8, 16, 32)
"""k, frames; half a stride of walking is about 16."""
CLIPS, FRAMES = 6, 96
QUERIES = 14
"""Held-out takes that look through one training take of each content and style."""
NEIGHBOURS = 6
CURVED = 1.05
"""A way that is so much longer than the line counts as curved."""
FREE, LATENT, SHORTEST = "linear", "line of hidden units", "geodesic"
METHODS = (FREE, LATENT, SHORTEST)
SEEN = "from seen window to seen window"


@dataclass(frozen=True)
class Geodesics:
    """The lengths, the errors of the middles, and what each distance found.

    Parameters
    ----------
    lengths : way to (P,) array
        Of each pair of windows, over the length of the line through the space of motions.
    halfway : k to method to error, cm
    average, precision : label to distance to (Q,) array
    shown : method to (F, 63) array
        Middles of one clip.
    """

    lengths: dict[str, np.ndarray]
    halfway: dict[int, dict[str, float]]
    average: dict[str, dict[str, np.ndarray]]
    precision: dict[str, dict[str, np.ndarray]]
    shown: dict[str, np.ndarray]
    rate: float
    title: str = "Geodesics: the shortest way along the manifold"

    def text(self) -> str:
        """Three tables."""
        ways = [
            [way, *(f"{np.quantile(ratio, q):.4f}" for q in (0.5, 0.95))]
            for way, ratio in self.lengths.items()
        ]
        pairs = len(self.lengths[SHORTEST])
        middles = [
            [str(k), *(f"{errors[method]:.2f}" for method in METHODS)]
            for k, errors in self.halfway.items()
        ]
        names = list(next(iter(self.average.values())))
        scores = [
            [name, *(f"{self.precision[label][name].mean():.2f}, {each[name].mean():.2f}"
                     for label, each in self.average.items())]
            for name in names
        ]  # fmt: skip
        return (
            f"Length of the way between the projections of two windows, over that of the line "
            f"between them, {pairs} pairs:\n\n"
            f"{text_table(['way', 'median', '95th of 100'], ways)}\n\n"
            "Halfway between a clip and the same k frames later: error against the clip k/2 frames "
            f"later, projected, cm:\n\n{text_table(['k', *METHODS], middles)}\n\n"
            f"{QUERIES} held-out takes at most look through one training take of each content and "
            "style, each way on the same takes; precision at 1 and mean average precision:\n\n"
            f"{text_table(['distance', *self.average], scores)}"
        )

    def findings(self) -> list[Finding]:
        """What was claimed beforehand."""
        ratio = np.median(self.lengths[SHORTEST])
        better = [k for k, e in self.halfway.items() if e[SHORTEST] < min(e[FREE], e[LATENT])]
        stride = self.halfway[16]
        return [
            Finding(
                "The manifold is curved: between two motions the shortest way along it is longer "
                f"than the line through the space of motions by {CURVED - 1:.0%} or more (what a "
                "geodesic distance of its own presumes, holden2015, abstract).",
                bool(ratio >= CURVED),
                f"{ratio:.4f} of the line in the median; the straight way through the hidden units "
                f"{np.median(self.lengths[LATENT]):.4f}.",
            ),
            Finding(
                "The middle of a geodesic is a motion between, better than the middles of straight "
                "lines (not in the paper).",
                len(better) == len(self.halfway),
                f"nearest to the truth at {len(better)} of {len(self.halfway)} distances; at 16 "
                "frames " + ", ".join(f"{method} {stride[method]:.2f}" for method in METHODS)
                + " cm.",
            ),
            self._finds(SHORTEST, EQUATION_4, "Geodesic distance computes similarity between "
                        "motions (holden2015, abstract): it finds more than equation 4."),
            self._finds(SHORTEST, EUCLIDEAN, "Geodesic distance finds more than Euclidean "
                        "distance."),
            self._finds(SEEN, EUCLIDEAN, "A way that goes from motion to motion that was seen "
                        "finds more than Euclidean distance (not in the paper)."),
        ]  # fmt: skip

    def _finds(self, one: str, other: str, claim: str) -> Finding:
        gaps = {
            label: bootstrapped_difference(each[one], each[other])
            for label, each in self.average.items()
        }
        said = "; ".join(f"{label} {gap.text()}" for label, gap in gaps.items())
        return Finding(
            claim,
            all(gap.low > 0 for gap in gaps.values()),
            f"mean average precision of {one} less that of {other}: {said}.",
        )

    def save_picture(self, path: str | Path) -> None:
        """Strips of what each way has halfway between a clip and the same half a stride later."""
        colours = {FREE: CORRUPTED, LATENT: PLAIN, SHORTEST: PROJECTED}
        actors = [
            Actor(x[:, POSITIONS].reshape(len(x), -1, 3), PARENTS, name, colours.get(name, TRUTH))
            for name, x in self.shown.items()
        ]
        save_figure(strip_figure(actors, self.rate, azimuth=75.0), path)


def geodesics(manifold: MotionManifold, material: Material, seed: int = 0) -> Geodesics:
    """Measure lengths, middles and what they find.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        Of labelled takes, Bandai Namco's where there are any, else the synthetic ones.
    seed : int
        Unused: nothing is drawn.

    Raises
    ------
    ValueError
        If no labelled take is held out, or none is there to be found.
    """
    used = material.labelled("geodesics need")
    halfway, shown = _halfway(manifold, material)
    queries = evenly(used.testing, QUERIES)
    gallery = list({(t.content, t.style): t for t in reversed(used.training)}.values())
    between, lengths = _distances(manifold, queries, gallery, used.training)
    precision, average = retrieved(between, queries, gallery)
    return Geodesics(lengths, halfway, average, precision, shown, manifold.rate)


def _halfway(manifold: MotionManifold, material: Material):
    """Errors of middles by k and method, and the middles of the first clip, half a stride apart."""
    long = FRAMES + max(LATER)
    takes = [take for take in material.testing if len(take.positions) >= long]
    walks = [take for take in takes if "walk" in take.content]
    clips = [manifold.features(t.positions[:long])[0] for t in evenly(walks or takes, CLIPS)]
    if not clips:
        raise ValueError(f"no test take is as long as {long} frames")
    errors, shown = {}, {}
    for k in LATER:
        squares: dict[str, list[float]] = {method: [] for method in METHODS}
        for clip in clips:
            one, other = clip[:FRAMES], clip[k : k + FRAMES]
            truth = manifold.project(clip[k // 2 : k // 2 + FRAMES])
            ends = manifold.project(one), manifold.project(other)
            middles = {
                FREE: (ends[0] + ends[1]) / 2,
                LATENT: way_between(manifold, one, other, LINE)(0.5),
                SHORTEST: way_between(manifold, one, other, GEODESIC)(0.5),
            }
            for method, middle in middles.items():
                squares[method].append(position_error(middle, truth) ** 2)
            if k == 16 and not shown:
                shown = {"truth": truth, **middles}
        errors[k] = {method: float(np.sqrt(np.mean(each))) for method, each in squares.items()}
    return errors, shown


def _distances(
    manifold: MotionManifold,
    queries: list[LabelledTake],
    gallery: list[LabelledTake],
    seen: list[LabelledTake],
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Every distance (Q, N), and the lengths of ways over those of lines, (Q · N,)."""
    features = [[manifold.features(t.positions)[0] for t in takes] for takes in (queries, gallery)]
    chord = geodesic_matrix(manifold, *features, points=2)
    shortest = geodesic_matrix(manifold, *features)
    latent = geodesic_matrix(manifold, *features, points=9, steps=0)
    known = [manifold.features(take.positions)[0] for take in seen]
    return {
        SHORTEST: shortest,
        EQUATION_4: equation_4(manifold).between(*features),
        EUCLIDEAN: euclidean(manifold).between(*features),
        "the same of their projections": chord,
        SEEN: _over_seen(manifold, *features, known),
    }, {LATENT: (latent / chord).ravel(), SHORTEST: (shortest / chord).ravel()}


def _over_seen(
    manifold: MotionManifold,
    queries: list[np.ndarray],
    gallery: list[np.ndarray],
    seen: list[np.ndarray],
) -> np.ndarray:
    """From each query to each clip of the gallery, the shortest path from window to window: each
    is joined to its nearest `NEIGHBOURS`. What is asked about joins no others."""
    cut = [raw_windows(manifold, clip) for clip in (*queries, *gallery, *seen)]
    whose = np.repeat(np.arange(len(cut)), [len(each) for each in cut])
    x = np.concatenate([manifold.project_windows(each) for each in cut])
    points = x.reshape(len(x), -1)
    apart = cdist(points, points)
    np.fill_diagonal(apart, np.inf)
    asked = int(np.count_nonzero(whose < len(queries)))
    apart[:, :asked] = np.inf
    near = np.argsort(apart, axis=1)[:, :NEIGHBOURS]
    rows = np.repeat(np.arange(len(points)), NEIGHBOURS)
    # Of length 0 an edge would be none: the gallery's takes are among the seen ones.
    edges = np.maximum(apart[rows, near.ravel()], 1e-9)
    graph = coo_array((edges, (rows, near.ravel())), shape=apart.shape).tocsr()
    found = shortest_path(graph, directed=False, indices=np.arange(asked))
    # Where no way leads: farther than all that was reached, in the order of the line.
    reached = np.isfinite(found)
    found = np.where(reached, found, found[reached].max() + apart[:asked])
    begin = np.flatnonzero(np.diff(whose, prepend=-1))
    of_takes = np.minimum.reduceat(np.minimum.reduceat(found, begin[: len(queries)]), begin, axis=1)
    return of_takes[:, len(queries) : len(queries) + len(gallery)]
