"""A published protocol: missing data in walks of CMU subject 35, both networks beside others' rows.

The networks and the baselines learn from the 31 training takes alone. Settings were chosen by
leaving training takes out, whose errors are printed too; the test take chose nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.experiments.published import baselines, networks
from numpy_cae.experiments.published.protocol import (
    FIRST_HIDDEN,
    GROUPS,
    Method,
    Protocol,
    read_protocol,
)
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH

SEEDS = 5
LEG, BODY = GROUPS.values()
ROW, WINDOW = "the row", "15 rows around it"
SEVEN, BEFORE = "7 rows around it", "{}; the take's rows before"
ALL = BEFORE.format("the take's visible columns")
PUBLISHED = [
    ["GP-LVM, q = 3", 11.4, 3.40, 16.9, 2.49],
    ["GP-LVM, q = 4", 9.7, 3.38, 20.7, 2.72],
    ["GP-LVM, q = 5", 13.4, 4.25, 23.4, 2.78],
    ["nearest neighbour, standardised", 13.5, 4.44, 20.8, 2.62],
    ["nearest neighbour, radians", 14.0, 4.11, 30.9, 3.20],
    ["binary latent model", 11.7, None, 8.8, None],
]
"""SC and degrees of leg and body: Lawrence 2007, the last row Taylor et al. 2006."""
BEST = (9.7, 3.38, 8.8, 2.49)
"""The best published value of each column."""
HEADER = ("method", "sees", "leg SC", "leg °", "body SC", "body °")
JOINT = (10, "right knee")


def methods(deviation: np.ndarray) -> list[tuple[str, str, dict[str, Method]]]:
    """Name, what it sees, and the method for each group of columns; the settings are those that
    leave the smallest error on training takes left out."""
    centred, ridge = baselines.centred, baselines.ridge

    def both(method: Method) -> dict[str, Method]:
        return dict.fromkeys(GROUPS, method)

    gp = {name: baselines.kernel_ridge(*own) for name, own in networks.START.items()}
    return [
        ("nearest neighbour, standardised", ROW, both(baselines.nearest(np.ones(59)))),
        ("nearest neighbour, radians", ROW, both(baselines.nearest(deviation))),
        ("last value held", "the row before the hole", both(baselines.held)),
        ("PCA, rows", ROW, both(baselines.pca(1, 10))),
        ("PCA, windows", BEFORE.format(WINDOW), both(baselines.pca(15, 20))),
        ("linear denoiser", WINDOW, both(baselines.linear_denoiser(15, 0.3))),
        ("ridge regression, rows", ROW, both(ridge(1, 100))),
        ("ridge regression", WINDOW, both(ridge(15, 1000))),
        ("ridge regression, offset", BEFORE.format(WINDOW), both(centred(ridge(15, 1000)))),
        ("Gaussian process", SEVEN, gp),
        (
            "Gaussian process, offset",
            BEFORE.format(SEVEN),
            {name: centred(method) for name, method in gp.items()},
        ),
    ]


def run(folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Measure every method on the test take and on training takes left out.

    Raises ValueError where the folders lack the takes.
    """
    protocol = read_protocol(folders)
    rows, filled = [], {}
    for name, sees, method in methods(protocol.deviation):
        test, left_out = [], []
        for group, columns in GROUPS.items():
            values = protocol.test_values(method[group](protocol.standardised, columns), columns)
            filled[name, group] = values[0]
            test += list(protocol.errors([values], columns))
            left_out += list(protocol.left_out(method[group], columns))
        rows.append([name, sees, *test, *left_out])
    for name, sees, network in (
        ("convolutional autoencoder", ALL, networks.convolutional),
        ("sequential autoencoder", ALL, networks.sequential),
    ):
        rows += _network_rows(protocol, name, sees, network, seed, filled)
