"""The motions nearest to a confident walk with a turn, by G and by Euclidean distance: the example
of holden2015, section 7, "Motion Comparison".

The motions are synthetic (`data_synth`), so that their content is known exactly.
"""

from collections import Counter
from itertools import chain

import numpy as np

from data_synth import make_take
from numpy_cae.experiments.comparison.distances import equation_4, euclidean
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import PARENTS, body_of
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, strip_figure

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
ALIKE = (QUERY, "confident walk", "walk with a turn")
ODD = ("old man's walk", "sidestep")
QUERIES, TAKES, SECONDS, NEAREST = 8, 6, 8.0, 5
G, EUCLIDEAN = "G", "Euclidean"


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Search for the nearest of synthetic motions, made from the seed; the material is not used."""
    scenes = [scene for scene in SCENES for _ in range(TAKES)]
    queries = [_made(QUERY, seed, number) for number in range(QUERIES)]
    gallery = [_made(scene, seed, QUERIES + n) for n, scene in enumerate(scenes)]
    ours, theirs = ([manifold.features(take)[0] for take in takes] for takes in (queries, gallery))
    ranked = {
        name: np.argsort(distance.between(ours, theirs), axis=1, kind="stable")
        for name, distance in ((G, equation_4(manifold)), (EUCLIDEAN, euclidean(manifold)))
    }
    found = {
        name: [[scenes[place] for place in row[:NEAREST]] for row in each]
        for name, each in ranked.items()
    }
    counts = {name: Counter(chain.from_iterable(lists)) for name, lists in found.items()}
    first_lists = zip(found[G][0], found[EUCLIDEAN][0], strict=True)
    ranks = [[str(rank), *pair] for rank, pair in enumerate(first_lists, 1)]
    shares = [
        [scene, *(count[scene] / (QUERIES * NEAREST) for count in counts.values())]
        for scene in SCENES
    ]
    first = f"The nearest of {len(gallery)} motions to the first of {QUERIES} queries, {QUERY}:"

    def actors(each: int, colon: str) -> list[Actor]:
        drawn = [Actor(queries[0], PARENTS, "query", TRUTH)]
        for name, colour in ((G, PROJECTED), (EUCLIDEAN, CORRUPTED)):
            for rank, place in enumerate(ranked[name][0, :each], start=1):
                label = f"{name} {rank}{colon}{scenes[place]}"
                drawn.append(Actor(gallery[place], PARENTS, label, colour))
        return drawn

    return Result(
        f"Motions nearest to a {QUERY}",
        [
            Table(first, ["rank", "by G", EUCLIDEAN], ranks),
            Table(
                f"Shares of the nearest {NEAREST} of all {QUERIES} queries:",
                ["motion", "by G", EUCLIDEAN],
                shares,
                ".0%",
            ),
        ],
        _claims(found),
        lambda: strip_figure(actors(4, ": "), manifold.rate),
        Animation(actors(2, ":\n"), manifold.rate, seconds=5.0),
    )


def _made(scene: str, seed: int, number: int) -> np.ndarray:
    """A take (F, 20, 3) of a person of its own."""
    kind, style = SCENES[scene]
    rng = np.random.default_rng([seed, number])
    return body_of(make_take(kind, rng, SECONDS, 30.0, style).motion)


def _claims(found: dict[str, list[list[str]]]) -> list[Claim]:
    alike = np.mean([scene in ALIKE for each in found[G] for scene in each])
    odd = {name: sum(bool(set(ODD) & set(each)) for each in lists) for name, lists in found.items()}
    return [
        Claim(
            "By G only motions with confident walks and turns are similar to a confident walk with "
            "a turn (holden2015, section 7).",
            alike == 1.0,
            f"{alike:.0%} of the nearest {NEAREST} of {QUERIES} queries are a confident walk, a "
            f"walk with a turn or both; {odd[G]} queries find an old man's walk or a sidestep.",
        ),
        Claim(
            "By Euclidean distance odd motions are similar to it, such as a sidestep and an old "
            "man's walk (holden2015, section 7).",
            2 * odd[EUCLIDEAN] > QUERIES,
            f"{odd[EUCLIDEAN]} of {QUERIES} queries find one among their nearest {NEAREST}.",
        ),
    ]
