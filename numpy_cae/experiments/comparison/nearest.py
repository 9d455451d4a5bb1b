"""The story that holden2015, section 7, "Motion Comparison", tells: which motions are nearest to a
confident walk with a turn, by G and by the Euclidean distance?

Told with people of data_synth, who do exactly what their name says and whom no network has seen.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from data_synth import make_take
from numpy_cae.experiments.comparison.distances import equation_4, euclidean
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import PARENTS, body_of
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, save_figure, save_gif, strip_figure

QUERY = "confident walk with a turn"
# What is done: kind and style of data_synth.
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
ALIKE = (QUERY, "confident walk", "walk with a turn")
ODD = ("old man's walk", "sidestep")
QUERIES, TAKES, SECONDS, NEAREST = 8, 6, 8.0, 5
_G, _EUCLIDEAN = "G", "Euclidean"


@dataclass(frozen=True)
class Nearest:
    """The ranked lists of every query.

    Parameters
    ----------
    queries, gallery : lists of (F, 20, 3) array
        World positions, metres.
    scenes : list of str
        What each motion of the gallery is.
    ranked : distance to (Q, N) array of int
        The gallery by rising distance.
    far : distance to (Q, N) array of float
        The distance of each motion of the gallery: √G, or the Euclidean one.
    rate : float
    """

    queries: list[np.ndarray]
    gallery: list[np.ndarray]
    scenes: list[str]
    ranked: dict[str, np.ndarray]
    far: dict[str, np.ndarray]
    rate: float
    title: str = "Nearest motions of a confident walk with a turn"

    def found(self, distance: str, query: int) -> list[str]:
        """What the nearest motions of one query are, nearest first."""
        return [self.scenes[place] for place in self.ranked[distance][query, :NEAREST]]

    def text(self) -> str:
        """The first query's lists side by side, and what is found by all of them."""
        lists = [self.found(name, 0) for name in (_G, _EUCLIDEAN)]
        ranks = [[str(rank), *pair] for rank, pair in enumerate(zip(*lists, strict=True), 1)]
        counts = {name: self._counts(name) for name in (_G, _EUCLIDEAN)}
        shares = [
            [scene, *[f"{count[scene] / sum(count.values()):.0%}" for count in counts.values()]]
            for scene in SCENES
        ]
        return (
            f"The nearest of {len(self.gallery)} motions to the first of {len(self.queries)} "
            f"confident walks with a turn:\n\n{text_table(['rank', 'by G', 'Euclidean'], ranks)}"
            f"\n\nWhat the nearest {NEAREST} of all {len(self.queries)} are:\n\n"
            f"{text_table(['motion', 'by G', 'Euclidean'], shares)}"
        )

    def findings(self) -> list[Finding]:
        """The paper's two sentences."""
        counts = self._counts(_G)
        alike = sum(counts[scene] for scene in ALIKE) / sum(counts.values())
        odd = {
            name: sum(bool(set(ODD) & set(self.found(name, q))) for q in range(len(self.queries)))
            for name in (_G, _EUCLIDEAN)
        }
        of = len(self.queries)
        return [
            Finding(
                "By G a confident walk with a turn only finds motions with confident walks and "
                "turns to be similar (holden2015, section 7).",
                alike == 1.0,
                f"{alike:.0%} of the nearest {NEAREST} of {of} queries are a confident walk, a "
                f"walk with a turn or both; {odd[_G]} queries find an old man's walk or a "
                "sidestep among them.",
            ),
            Finding(
                "By Euclidean distance it is found to be similar to odd motions, such as a "
                "sidestepping motion and an old man's walk (holden2015, section 7).",
                2 * odd[_EUCLIDEAN] > of,
                f"{odd[_EUCLIDEAN]} of {of} queries find one among their nearest {NEAREST}; the "
                f"first stands at rank {self._first_odd(_EUCLIDEAN):g} of {len(self.gallery)} by "
                f"Euclidean distance, at rank {self._first_odd(_G):g} by G (median).",
            ),
        ]

    def save_picture(self, path: str | Path) -> None:
        """Strips: the first query (green), its nearest by G (blue) and by Euclid (orange), PNG."""
        save_figure(strip_figure(self._actors(4, ": "), self.rate), path)

    def save_gif(self, path: str | Path) -> None:
        """The query and the nearest two of each list, moving for five seconds."""
        save_gif(self._actors(2, ":\n"), path, self.rate, seconds=5.0)

    def _counts(self, distance: str) -> Counter:
        return Counter(
            scene for query in range(len(self.queries)) for scene in self.found(distance, query)
        )

    def _first_odd(self, distance: str) -> float:
        odd = np.isin(self.scenes, ODD)[self.ranked[distance]]
        return float(np.median(np.argmax(odd, axis=1) + 1))

    def _actors(self, each: int, colon: str) -> list[Actor]:
        actors = [Actor(self.queries[0], PARENTS, "query", TRUTH)]
        for name, colour in ((_G, PROJECTED), (_EUCLIDEAN, CORRUPTED)):
            for rank, place in enumerate(self.ranked[name][0, :each], start=1):
                label = f"{name} {rank}{colon}{self.scenes[place]}"
                actors.append(Actor(self.gallery[place], PARENTS, label, colour))
        return actors


def nearest(manifold: MotionManifold, material: Material, seed: int = 0) -> Nearest:
    """Look for the nearest of confident walks with a turn.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        Not looked at: the people of this story are made for it.
    seed : int
        Of the people.
    """
    scenes = [scene for scene in SCENES for _ in range(TAKES)]
    queries = [_made(QUERY, seed, number) for number in range(QUERIES)]
    gallery = [_made(scene, seed, QUERIES + n) for n, scene in enumerate(scenes)]
    ours, theirs = ([manifold.features(take)[0] for take in takes] for takes in (queries, gallery))
    ways = {_G: equation_4(manifold), _EUCLIDEAN: euclidean(manifold)}
    far = {name: way.between(ours, theirs) for name, way in ways.items()}
    ranked = {name: np.argsort(each, axis=1, kind="stable") for name, each in far.items()}
    return Nearest(queries, gallery, scenes, ranked, far, manifold.rate)


def _made(scene: str, seed: int, number: int) -> np.ndarray:
    """A person of one's own for every take."""
    kind, style = SCENES[scene]
    rng = np.random.default_rng([seed, number])
    return body_of(make_take(kind, rng, SECONDS, 30.0, style).motion)
