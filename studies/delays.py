"""Is G "temporally invariant"? holden2015, section 7, equation 4.

    python -m studies delays --data bandai --test '*_005.bvh' -m best.npz

Each test take is delayed: its first pose is held for 1 to 24 frames, so that its content is the
same. A window that is moved inside a take has another content, which says nothing of invariance.
"""

import numpy as np

from numpy_cae.manifold import MotionManifold
from numpy_cae.motion.features import TURN, VELOCITY
from numpy_cae.viz import OTHERS, PROJECTED, Curve, curves_figure
from studies.comparison import (
    EQUATION_4,
    EUCLIDEAN,
    RAW_EXTREMES,
    Rows,
    distances,
    rows_of_distances,
)
from studies.shared.material import Material, evenly, features_of
from studies.shared.result import Claim, Picture, Result, Table

DELAYS = (1, 2, 4, 8, 12, 16, 24)
TAKES = 60
"""TAKES: the most test takes that are delayed."""
MOST = 0.05
"""MOST: G is invariant if no delay changes it by more than this share of the median distance of two
takes."""
NAMES = (EQUATION_4, RAW_EXTREMES, EUCLIDEAN)


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure each distance between test takes and their delayed copies. The seed is not used."""
    takes = features_of(manifold, evenly(material.testing, TAKES))
    of_distances = rows_of_distances(manifold)
    measured = {name: _measured(of_distances[name], takes) for name in NAMES}
    shares = {name: of_take for name, (of_take, _) in measured.items()}
    farther = {name: each for name, (_, each) in measured.items()}
    header = ["squared distance", *(f"{delay} frames" for delay in DELAYS)]
    captions = {
        "Of a take and its delayed copy, as a share of the median of two takes:": shares,
        "Takes whose delayed copy is farther than another take:": farther,
    }
    tables = [
        Table(caption, header, [[name, *row] for name, row in each.items()], ".1%")
        for caption, each in captions.items()
    ]
    largest = {name: max(row) for name, row in shares.items()}
    claim = Claim(
        "G_invariant",
        largest[EQUATION_4] < MOST,
        f"at most {largest[EQUATION_4]:.1%} of the median distance of two takes, and "
        f"{max(farther[EQUATION_4]):.0%} of the takes are farther than another take;",
        opponent=f"min and max of the features {largest[RAW_EXTREMES]:.1%}, "
        f"Euclidean distance {largest[EUCLIDEAN]:.1%}.",
    )
    return Result("G and a delay", tables, [claim], {"delays": Picture(lambda: _figure(shares))})


def _measured(rows: Rows, takes: list[np.ndarray]) -> tuple[list[float], list[float]]:
    """For each delay the squared distance as a share of the median of two takes, and the share of
    takes whose delayed copy is farther than another take."""
    between = distances(rows, takes, takes) ** 2
    others = np.where(np.eye(len(takes), dtype=bool), np.inf, between)
    median = np.median(others[np.isfinite(others)])
    delayed = [
        np.diag(distances(rows, takes, [_delayed(take, delay) for take in takes]) ** 2)
        for delay in DELAYS
    ]
    shares = [float(np.median(each) / median) for each in delayed]
    return shares, [float(np.mean(each > others.min(axis=1))) for each in delayed]


def _figure(shares: dict[str, list[float]]):
    drawn = zip(shares.items(), (PROJECTED, *OTHERS), strict=False)
    curves = [Curve(DELAYS, row, name, colour) for (name, row), colour in drawn]
    return curves_figure(curves, "delay, frames", "share of the median")


def _delayed(features: np.ndarray, frames: int) -> np.ndarray:
    """The same motion after its first pose was held, standing still."""
    held = np.repeat(features[:1], frames, axis=0)
    held[:, VELOCITY] = 0
    held[:, TURN] = 0
    return np.concatenate([held, features])
