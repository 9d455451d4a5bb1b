"""The manifold as a picture: the codes of takes in two dimensions, and filters that move.

    python -m studies codes -o codes

The code of a take is the mean and the standard deviation over time of each hidden unit, Y = Φ(X).
The map places the codes in two dimensions by classical multidimensional scaling of the square roots
of their distances (Torgerson 1952; without the root, a few takes that are unlike all others would
take up the map). On its page a click plays the take. Of one take of each kind half of the values
are set to zero, and this copy is projected, Φ†(Φ(X)) (holden2015, section 3): a path leads from the
code of the damaged copy to that of its projection, and to the true one.

The filters of the first layer move as skeletons: the mean pose, and what raising one unit of the
layer from its mean to its 99th percentile adds to it (section 6).

Without --data the takes are synthetic.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from data_synth import KINDS, make_take
from numpy_cae.evaluation import position_error
from numpy_cae.evaluation.tables import Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import body_of
from numpy_cae.motion import POSITIONS, RATE
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from numpy_cae.viz.actor import world_actors
from studies.representation import responses
from studies.shared.code_map import MapPoint, code_map_page
from studies.shared.material import Material, evenly
from studies.shared.result import Picture, Result, moving

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SECONDS = 2.5
"""Length of a take on the map."""
TAKES_OF_A_KIND = 3
MOST_TAKES = 48
"""More takes would make the page larger than 1 MB."""
REMOVED = 0.5
"""The share of values that is set to zero in the damaged copy."""
FILTERS = 6
LARGEST_STEP = 0.15
"""The joint that a filter moves furthest goes this far from its place in the mean pose (m)."""
FILTER_RATE = 8.0
"""Frames a second at which the filters are played, about a quarter of their speed."""


@dataclass(frozen=True, eq=False)
class CodedTake:
    """A take, (F, 63) features and the code (2k,); the same of its damaged copy and of the
    projection of the copy, or of neither."""

    name: str
    kind: str
    features: dict[str, np.ndarray]
    codes: dict[str, np.ndarray]


def run(manifold: MotionManifold, material: Material | None, seed: int = 0) -> Result:
    """Encode the takes, their damaged copies and the projections of these."""
    takes = _encode_takes(manifold, material, seed)
    if len(takes) < 2:
        raise ValueError("a map needs two takes or more: give more to test on, by --test")
    places, share = scale(np.array([code for take in takes for code in take.codes.values()]))
    points = []
    for take in takes:
        own, places = np.split(places, [len(take.codes)])
        points.append(_point(take, own))
    returned = _share_of_distance(points)
    note = (
        f"The map has {share:.0%} of the scaled distances. On it the projection of a damaged copy "
        f"is at {returned:.2f} of the copy's distance from the true code (median)."
    )
    numbers = takes[0].codes["true"].size
    text = (
        f"A point is a take of {SECONDS} s: the means and deviations of its hidden units, "
        f"{numbers} numbers, in two dimensions, which have {share:.0%} of the scaled "
        "distances. Click on a point, or choose a take, to play it. Of one take of each kind half "
        "of the values are also set to zero, and this copy is projected."
    )
    title = "The codes of takes in two dimensions"
    page = partial(code_map_page, points, manifold.rate, title, text)
    figures = {
        "codes": Picture(partial(_draw_map, points), page=page),
        "filters": moving(_moving_filters(manifold, takes), FILTER_RATE),
    }
    return Result(title, [_table(takes, points)], figures=figures, note=note)


def _encode_takes(
    manifold: MotionManifold, material: Material | None, seed: int
) -> list[CodedTake]:
    """The takes with their codes; the first one of each kind with a damaged copy."""
    rng = np.random.default_rng(seed)
    frames = round(SECONDS * manifold.rate)
    takes: list[CodedTake] = []
    for name, kind, positions in _takes(material, seed):
        true, _ = manifold.features(positions[:frames])
        clips = {"true": true}
        if kind not in [take.kind for take in takes]:
            clips = _damage_and_project(manifold, true, rng) | clips
        codes = {key: _code(manifold, clip) for key, clip in clips.items()}
        takes.append(CodedTake(name, kind, clips, codes))
    return takes


def _table(takes: list[CodedTake], points: list[MapPoint]) -> Table:
    """How often the nearest take is of the same kind, by codes and on the map."""
    kinds = [take.kind for take in takes]
    codes = np.array([take.codes["true"] for take in takes])
    places = np.array([point.place for point in points])
    rows = [
        ["all dimensions", _share_of_same_kind(codes, kinds)],
        ["the two of the map", _share_of_same_kind(places, kinds)],
        ["two at random, expected", _expected_share(kinds)],
    ]
    return Table("", ["codes", "nearest take is of the same kind"], rows, ("", ".2f"))


def _takes(material: Material | None, seed: int) -> list[tuple[str, str, np.ndarray]]:
    """Name, kind and positions (F, 20, 3) of the takes: those for testing, or synthetic ones."""
    takes = []
    if material is None:
        for kind in KINDS:
            for number in range(TAKES_OF_A_KIND):
                motion = make_take(kind, seed + number, SECONDS + 1 / RATE, RATE).motion
                name = kind.replace("_", " ")
                takes.append((f"{name} {number + 1}", name, body_of(motion)))
        return takes
    for take in evenly(material.testing, MOST_TAKES):
        takes.append((take.path.stem, take.content or take.source, take.positions))
    return takes


def _damage_and_project(
    manifold: MotionManifold, true: np.ndarray, rng: np.random.Generator
) -> dict[str, np.ndarray]:
    """A copy of the features (F, 63) with values set to zero, and its projection."""
    is_removed = rng.random(true.shape) < REMOVED
    damaged = np.where(is_removed, manifold.mean_pose, true)  # normalised, the mean pose is zero
    return {"damaged": damaged, "projected": manifold.project(damaged)}


def _code(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    """The mean and the standard deviation over time of each hidden unit, (2k,)."""
    units = manifold.encode(features)
    return np.concatenate([units.mean(axis=0), units.std(axis=0)])


def scale(codes: np.ndarray) -> tuple[np.ndarray, float]:
    """Classical multidimensional scaling of the square roots of the distances between codes (N, k).

        B = -½ J D J,    J = I - 1/N,    B = V Λ Vᵀ,    places = V √Λ

    D are the Euclidean distances, the squares of their square roots.

    Returns
    -------
    (N, 2) array
        The places of the two largest eigenvalues.
    float
        The share of these in the sum of all eigenvalues.
    """
    distances = np.linalg.norm(codes[:, None] - codes[None], axis=-1)
    centring = np.eye(len(codes)) - 1 / len(codes)
    values, vectors = np.linalg.eigh(-0.5 * centring @ distances @ centring)
    places = vectors[:, :-3:-1] * np.sqrt(values[:-3:-1])
    return places, float(values[-2:].sum() / values.sum())


def _point(take: CodedTake, places: np.ndarray) -> MapPoint:
    """A take on the map, with its motions and its path; `places` (N, 2) are those of its codes."""
    colours = {"damaged": CORRUPTED, "projected": PROJECTED, "true": TRUTH}
    motions = {key: (clip, colours[key]) for key, clip in take.features.items()}
    text = ""
    if "damaged" in take.features:
        true = take.features["true"]
        before = position_error(take.features["damaged"], true)
        after = position_error(take.features["projected"], true)
        text = f"Error of a position: {before:.1f} cm damaged, {after:.1f} cm projected."
    return MapPoint(take.name, take.kind, places[-1], places[:-1], world_actors(motions), text)


def _share_of_same_kind(codes: np.ndarray, kinds: list[str]) -> float:
    """The share of takes whose nearest other take, by Euclidean distance, is of their kind."""
    distances = np.linalg.norm(codes[:, None] - codes[None], axis=-1)
    np.fill_diagonal(distances, np.inf)
    nearest = distances.argmin(axis=1)
    return float(np.mean([kinds[take] == kinds[other] for take, other in enumerate(nearest)]))


def _share_of_distance(points: list[MapPoint]) -> float:
    """The distance of a projection from the true code by that of the damaged copy, median."""
    shares = []
    for point in points:
        if len(point.path):
            damaged, projected = np.linalg.norm(point.path - point.place, axis=1)
            shares.append(projected / damaged)
    return float(np.median(shares))


def _expected_share(kinds: list[str]) -> float:
    """The same share where the nearest take is drawn at random."""
    same = sum(kinds.count(kind) - 1 for kind in kinds)
    return same / (len(kinds) * (len(kinds) - 1))


def _draw_map(points: list[MapPoint]) -> Figure:
    """The points with the names of their kinds, and the paths of the damaged copies."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 6), layout="constrained")
    axes = figure.subplots()
    kinds = list(dict.fromkeys(point.kind for point in points))
    for number, kind in enumerate(kinds):
        own = [point for point in points if point.kind == kind]
        places = np.array([point.place for point in own])
        marker = "os^D"[number // 4 % 4]
        axes.scatter(*places.T, marker=marker, color=f"C{number % 4}", zorder=3)
        axes.annotate(kind, places.mean(axis=0), (0, 8), textcoords="offset points", ha="center")
        corners = np.vstack([own[0].path, own[0].place[None]])
        axes.plot(*corners.T, color="0.6", linewidth=1, marker=".", zorder=1)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    return figure


def _moving_filters(
    manifold: MotionManifold, takes: list[CodedTake]
) -> dict[str, tuple[np.ndarray, str]]:
    """Filters of the first layer with the most energy, as motions (F, 63) around the mean pose."""
    walks = [take.features["true"] for take in takes]
    x = np.concatenate([manifold.normalise(walk) for walk in walks])[None]
    x = x[:, : x.shape[1] // manifold.stride * manifold.stride]
    units = manifold.network.encode(x, layers=1)[0]
    response = responses(manifold, units, 1).astype(np.float64) / manifold.scale
    energy = np.square(response[..., POSITIONS]).sum(axis=(1, 2))
    motions = {}
    for unit in np.argsort(energy)[::-1][:FILTERS]:
        steps = response[unit, :, POSITIONS]
        largest = np.linalg.norm(steps.reshape(-1, 20, 3), axis=-1).max()
        motion = np.tile(manifold.mean_pose, (len(steps), 1))
        motion[:, POSITIONS] += LARGEST_STEP / largest * steps
        motions[f"unit {unit}"] = motion, PROJECTED
    return motions
