"""Values removed from takes, and completed by every method that is given the mask."""

from collections.abc import Mapping, Sequence

import numpy as np

from numpy_cae.evaluation.tables import interpolate_columns, interpolate_pchip
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.completion import complete, interpolate_gaps
from numpy_cae.manifold.weighted_completion import candidates_of, complete_weighted
from numpy_cae.motion import POSITIONS
from studies.shared.result import Table

PS = (0.5, 0.8, 0.9)
"""The shares of the values that are removed."""
FRAMES = 160
"""Of each take so many frames in its middle are measured, or all; nothing is padded."""
LINES = "linear interpolation"
PCHIP = "PCHIP"
SPLINE = "limited cubic spline"
CURVE = "Gaussian process of each column"
NETWORK = "the network, from the Gaussian process"
FRAMES_GIVEN_CURVE = "Gaussian process, refined by the frames"
FRAMES_GIVEN_NETWORK = "the network, refined by the frames"
COMPONENTS_AND_CURVE = "principal components of 15 frames, and the curve of what they miss"
WITH_RIDGE_AND_CURVE = "the same with the ridge"
REFINED_COMPONENTS = "principal components of 15 frames with the ridge, refined by the frames"
WITHOUT_NETWORK = "weighed without the network"
WEIGHED = "weighed: `complete`"
OF_BEST = "`complete`, divided by the best of the others"
GAIN = "of the gain on PCHIP, by the network, %"
Squares = dict[str, dict[float, list[float]]]
"""Method to p to the mean square error (cm²) of each take and seed."""


def middle_of(features: np.ndarray) -> np.ndarray:
    """`FRAMES` frames in the middle of a take, or all."""
    start = max((len(features) - FRAMES) // 2, 0)
    return features[start : start + FRAMES]


def complete_by_every_method(
    manifold: MotionManifold, features: np.ndarray, known: np.ndarray
) -> dict[str, np.ndarray]:
    """Features (F, 63) by method; unknown values of `features` are not looked at."""
    x = manifold.normalise(np.where(known, features, manifold.mean_pose)).astype(np.float64)

    def project(x: np.ndarray, averaged: bool) -> np.ndarray:
        projected = manifold.project(manifold.denormalise(x[0]), average_shifts=averaged)
        return manifold.normalise(projected)[None].astype(np.float64)

    candidates = candidates_of(x, known, project, manifold.context)
    curve, of_frames, by_network = candidates[0], candidates[1], candidates[-1]
    columns = x[None], known[None]
    completed = {
        LINES: interpolate_columns(*columns, np.interp)[0],
        PCHIP: interpolate_columns(*columns, interpolate_pchip)[0],
        SPLINE: interpolate_gaps(*columns)[0],
        CURVE: curve,
        NETWORK: complete(*columns, project, start=curve[None])[0],
        FRAMES_GIVEN_CURVE: of_frames,
        FRAMES_GIVEN_NETWORK: by_network,
        WITHOUT_NETWORK: complete_weighted(x, known, None, manifold.context),
    }
    if manifold.context is not None:
        names = (COMPONENTS_AND_CURVE, WITH_RIDGE_AND_CURVE, REFINED_COMPONENTS)
        completed |= dict(zip(names, candidates[2:5], strict=True))
    in_features = {name: manifold.denormalise(values) for name, values in completed.items()}
    return in_features | {WEIGHED: manifold.complete(features, known)}


def squares_by_method(
    manifold: MotionManifold, takes: Sequence[np.ndarray], seeds: Sequence[int]
) -> Squares:
    """The squared errors in takes of features (F, 63), of which values are removed by each seed."""
    squares: Squares = {}
    for number, features in enumerate(takes):
        truth = middle_of(features)
        at_rest = np.ptp(truth, axis=0) == 0
        for p in PS:
            for seed in seeds:
                rng = np.random.default_rng([seed, number, round(100 * p)])
                known = (rng.random(truth.shape) >= p) | at_rest
                unknown = ~known[:, POSITIONS]
                completed = complete_by_every_method(manifold, truth, known)
                for method, values in completed.items():
                    off = 100 * (values - truth)[:, POSITIONS][unknown]
                    of_method = squares.setdefault(method, {p: [] for p in PS})
                    of_method[p].append(float(np.mean(off**2)))
    return squares


def table_of_removed_values(
    manifold: MotionManifold, takes: Sequence[np.ndarray], seeds: Sequence[int], source: str
) -> Table:
    """Errors (cm) of the missing values and, in brackets, divided by that of PCHIP."""
    squares = squares_by_method(manifold, takes, seeds)
    errors: dict[str, list[float]] = {}
    for method, by_share in squares.items():
        errors[method] = [float(np.sqrt(np.mean(by_share[p]))) for p in PS]
    rows: list[list[object]] = []
    for method, of_method in errors.items():
        pairs = zip(of_method, errors[PCHIP], strict=True)
        rows.append([method, *(f"{error:.2f} ({error / pchip:.2f})" for error, pchip in pairs)])
    rows.append([GAIN, *shares_by_network(errors)])
    others = [of_method for method, of_method in errors.items() if method != WEIGHED]
    best = np.min(others, axis=0)
    rows.append([OF_BEST, *(f"{ratio:.2f}" for ratio in errors[WEIGHED] / best)])
    counted = f"{source}, {len(takes)} takes, {len(seeds)} seeds"
    caption = f"{counted}: error of missing values, cm (and divided by that of PCHIP):"
    return Table(caption, ["method", *(f"p = {p}" for p in PS)], rows)


def shares_by_network(errors: Mapping[str, Sequence[float]]) -> list[str]:
    """100 (e₀ - e) / (PCHIP's error - e): e is the error of `complete`, e₀ without the network."""
    shares = []
    methods = (errors[name] for name in (PCHIP, WITHOUT_NETWORK, WEIGHED))
    for pchip, without, error in zip(*methods, strict=True):
        shares.append(f"{100 * (without - error) / (pchip - error):.0f}")
    return shares
