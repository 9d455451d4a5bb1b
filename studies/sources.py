"""A source of motion left out of training, each of several in turn, and later takes of the same
source: values removed with p = 0.5, 0.8 and 0.9, by the network and by its opponents.

A source is a folder: one capture system, one rig, one set of people. Every method learns from the
same takes: those of the other sources, or four fifths of those of the source itself. Errors are
root mean squares of a joint coordinate in at most 24 windows of the takes that are left, evenly
spaced: the mean over two draws of the values removed and, after ±, half of their difference.
Networks are those of recipe fast, trained once. Methods are grouped by what they are given, as in
`numpy_cae.evaluation.tables`: the zeros as they are or, from "mask:" on, which values are missing.
PCA has the number of axes that is best on the windows it is tested on, which favours PCA; the
linear map is fitted for each p. The ridge of the Gaussian is chosen on takes left out where later
takes of its own source are repaired; for another source it is
`numpy_cae.evaluation.baselines.RIDGE`, chosen on sources left out.

    python -m studies sources --data bandai cmu/asfamc motions
"""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from numpy_cae.evaluation.baselines import RIDGE
from numpy_cae.evaluation.tables import COMPLETED, GAUSSIAN, PCHIP, Repairs, clips_of
from numpy_cae.manifold import learn_manifold
from numpy_cae.mocap import find_motion_files
from numpy_cae.mocap.bodies import read_body
from numpy_cae.training import recipe
from studies.repair_sweep import Errors, sweep
from studies.shared.charts import draw_errors_by_share
from studies.shared.material import read_takes
from studies.shared.result import Claim, Picture, Result, Table

PS = (0.5, 0.8, 0.9)
WINDOWS = 24
SEEDS = 2
FIFTH = 5
MOST = 0.65
"""Completion should leave at most this share of the error of PCHIP."""


def run(folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Leave each folder out in turn, then a fifth of its takes; the seed is that of the training
    and the first of the values that are removed."""
    if len(folders) < 2:
        raise ValueError("--data is one folder, expected two or more sources, a folder each")
    takes = {Path(folder).resolve().name: _takes_of(folder) for folder in folders}
    tables = []
    claims = []
    for name, takes_of_source in takes.items():
        takes_of_other_sources: list[np.ndarray] = []
        for source in takes:
            if source != name:
                takes_of_other_sources += takes[source]
        errors = _errors(takes_of_other_sources, takes_of_source, seed, RIDGE)
        claims.append(_claim(name, errors))
        tables.append(_table(f"{name}, left out", errors))
        earlier = [take for number, take in enumerate(takes_of_source) if number % FIFTH]
        later = _errors(earlier, takes_of_source[::FIFTH], seed)
        tables.append(_table(f"{name}, later takes of the same source", later))
    chart = Picture(partial(draw_errors_by_share, tables))
    return Result("A source that was not in training", tables, claims, {"sources": chart})


def _takes_of(folder: str | Path) -> list[np.ndarray]:
    return [positions for _, (positions, _) in read_takes(find_motion_files(folder), read_body)]


def _errors(
    training: Sequence[np.ndarray],
    testing: Sequence[np.ndarray],
    seed: int,
    ridge: float | None = None,
) -> Errors:
    """The errors in windows of takes (F, 20, 3) of the methods, fitted to other takes; the ridge is
    that of the Gaussian."""
    manifold = learn_manifold(training, recipe("fast"), seed)
    repairs = Repairs(manifold, clips_of(manifold, training), ridge)
    test = clips_of(manifold, testing).pick_evenly(WINDOWS)
    return sweep(repairs, test, PS, range(seed, seed + SEEDS))


def _table(caption: str, errors: Errors) -> Table:
    rows = [[method, *map(_spread, of_p)] for method, of_p in errors.items()]
    return Table(f"{caption}:", ["method", *(f"p = {p}, cm" for p in PS)], rows)


def _spread(errors: Sequence[float]) -> str:
    return f"{np.mean(errors):.2f} ± {np.ptp(errors) / 2:.2f}"


def _claim(name: str, errors: Errors) -> Claim:
    """Whether completion is better than a curve and than the Gaussian on a source left out."""
    completed = errors[COMPLETED].mean(axis=1)
    curve = errors[PCHIP].mean(axis=1)
    gaussian = errors[GAUSSIAN].mean(axis=1)
    better = bool(np.all(completed <= MOST * curve) and np.all(completed < gaussian))
    ratios = ", ".join(f"{ratio:.2f}" for ratio in completed / curve)
    of_gaussian = ", ".join(f"{ratio:.2f}" for ratio in completed / gaussian)
    figures = f"{ratios} of PCHIP; {of_gaussian} of the Gaussian."
    return Claim("carries_over", better, figures, name)
