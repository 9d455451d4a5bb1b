"""The motions nearest to a confident walk with a turn: holden2015, section 7, "Motion Comparison".

    python -m studies confident_walk -m model.npz

By Euclidean distance the paper finds a sidestep and an old man's walk, by G "only motions with
confident walks and turns". Queries and the motions that they search are synthetic (`data_synth`),
each of another person, whatever the model has learned from.
"""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from data_synth import make_take
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import body_of
from studies.comparison import EQUATION_4, EUCLIDEAN, RAW_EXTREMES, distances, rows_of_distances
from studies.shared.result import Claim, Result, Table

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
NAMES = (EQUATION_4, EUCLIDEAN, RAW_EXTREMES)


def run(manifold: MotionManifold, seed: int = 0) -> Result:
    """Search for the motions nearest to each query by each distance."""
    scenes = [scene for scene in SCENES for _ in range(TAKES)]
    made = [
        manifold.features(_body(scene, seed, number))[0]
        for number, scene in enumerate([QUERY] * QUERIES + scenes)
    ]
    found = {}
    for name in NAMES:
        between = distances(rows_of_distances(manifold)[name], made[:QUERIES], made[QUERIES:])
        nearest = np.argsort(between, axis=1, kind="stable")[:, :NEAREST]
        found[name] = [scenes[place] for place in nearest.ravel()]
    counts = {name: Counter(each) for name, each in found.items()}
    rows = [[s, *(counts[name][s] / (QUERIES * NEAREST) for name in NAMES)] for s in SCENES]
    alike = {name: _share(counts[name], ALIKE) for name in NAMES}
    odd = _share(counts[EUCLIDEAN], ODD)
    caption = f"Shares of the nearest {NEAREST} of {QUERIES} queries, {QUERY}:"
    return Result(
        "Motions nearest to a confident walk with a turn",
        [Table(caption, ["motion", *NAMES], rows, ".0%")],
        [
            Claim(
                "G_finds_only",
                alike[EQUATION_4] == 1,
                f"{alike[EQUATION_4]:.0%} of the nearest are confident walks or have turns;",
                opponent=f"min and max of the features {alike[RAW_EXTREMES]:.0%}, "
                f"Euclidean {alike[EUCLIDEAN]:.0%}.",
            ),
            Claim("euclidean_odd", odd > 0, f"{odd:.0%} of its nearest are such motions."),
        ],
    )


def _body(scene: str, seed: int, number: int) -> np.ndarray:
    kind, style = SCENES[scene]
    rng = np.random.default_rng([seed, number])
    return body_of(make_take(kind, rng, SECONDS, 30.0, style).motion)


def _share(counts: Counter, scenes: Sequence[str]) -> float:
    return sum(counts[scene] for scene in scenes) / (QUERIES * NEAREST)
