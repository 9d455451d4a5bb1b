"""One source of motion left out of training and measured on, each of several in turn.

A source is a folder: one capture system, one rig, one set of people. The network, the linear map
and PCA learn from the same takes of the other sources. Each value of the left-out windows is set to
zero with probability 1/2, as in `numpy_cae.evaluation.half_removed`.

Manifolds are those of recipe fast, averaged over all shifts of the pooling grid, and given the
zeros as they are, but for the rows that begin with "mask:", which are given what is missing. For
PCA the number of axes with the smallest error of repair on the test takes is shown, which favours
PCA. The linear map is fitted for p = 0.5; its reconstruction is that of the undamaged windows times
1 - p, the mean of what it is given.

    python -m studies sources --data bandai cmu/asfamc motions
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared.takes import each_usable
from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.clips import clips_of
from numpy_cae.evaluation.half_removed import PCA_WINDOWS, P, mask_given
from numpy_cae.manifold import learn_manifold
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.mocap import load_body
from numpy_cae.training import recipe, zero_values
from studies.shared.linear_denoiser import Moments
from studies.shared.result import Claim, Result, Table

RECIPE = "fast"
NETWORK, LINEAR = "network", "linear map of 15 frames"
PRINCIPAL = "PCA on windows, divided by 1 - p"
HEADER = ("left out", "method", "reconstruction, cm", "half of the values removed, cm")
Errors = dict[str, tuple[float, float]]
"""Method to its errors of reconstruction and of repair, cm."""


def run(folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Leave each folder out in turn: learn from the takes of the others, measure on its own."""
    if len(folders) < 2:
        raise ValueError("--data is one folder, expected two or more sources, a folder each")
    takes = {Path(folder).resolve().name: _takes_of(folder) for folder in folders}
    errors = {}
    for left_out, testing in takes.items():
        training = [take for name, each in takes.items() if name != left_out for take in each]
        errors[left_out] = errors_on(training, testing, seed)
    rows = [[name, method, *both] for name, each in errors.items() for method, both in each.items()]
    claims = [_claim(name, each) for name, each in errors.items()]
    table = Table("", HEADER, rows, best="low")
    return Result("A source that was not in training", [table], claims)


def _takes_of(folder: str | Path) -> list[np.ndarray]:
    return [positions for _, positions in each_usable([folder], lambda path: load_body(path)[0])]


def errors_on(
    training: Sequence[np.ndarray], testing: Sequence[np.ndarray], seed: int = 0
) -> Errors:
    """The errors of every method, fitted to takes (F, 20, 3), on the windows of other takes."""
    manifold = learn_manifold(training, recipe(RECIPE), seed)
    fitted, test = (clips_of(manifold, takes) for takes in (training, testing))
    damaged = zero_values(test.x, P, np.random.default_rng(seed))
    fitted = fitted.evenly(PCA_WINDOWS)
    linear = Moments.of(fitted.x, fitted.real).solve(1 - P)
    pca = PCA.fit(fitted.x.reshape(len(fitted), -1))
    divided = damaged / (1 - zeroed_fraction(damaged))
    size = min(pca.sizes, key=lambda size: test.error(pca.project(divided, size)))
    repaired = {
        NETWORK: [manifold.project_windows(x, True) for x in (test.x, damaged)],
        LINEAR: (linear.repair((1 - P) * test.x), linear.repair(damaged)),
        PRINCIPAL: (pca.project(test.x, size), pca.project(divided, size)),
    }
    repaired |= {name: (test.x, x) for name, x in mask_given(manifold, damaged)}
    return {name: (test.error(x), test.error(y)) for name, (x, y) in repaired.items()}


def _claim(name: str, errors: Errors) -> Claim:
    """Whether the manifold is better than both linear methods on one source."""
    (reconstruction, repair), (_, linear) = errors[NETWORK], errors[LINEAR]
    pca = errors[PRINCIPAL]
    better = repair < min(linear, pca[1]) and reconstruction < pca[0]
    figures = f"repair {repair:.2f} cm, linear map {linear:.2f}, PCA {pca[1]:.2f}; reconstruction "
    return Claim("carries_over", better, f"{figures}{reconstruction:.2f}, PCA {pca[0]:.2f}.", name)
