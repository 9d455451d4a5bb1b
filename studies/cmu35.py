"""The network on a published protocol: missing data in a walk of CMU subject 35.

    python -m studies cmu35 --data cmu35

All methods learn from the 31 training takes alone. Their settings were chosen on training takes
left out (docs/lab_book/cmu35.md); no setting was chosen on the test take.

A hole of 62 rows (2 s) reaches to the end of take 35_29. The other columns are known in all rows,
so that a method may see later rows of these; none sees hidden columns after the hole, where there
are no rows. Residual: the error on the take's rows before the hole is carried into it, which the
network's row includes. It starts from the Gaussian process.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from studies.cmu_protocol import baselines
from studies.cmu_protocol.networks import START, networks
from studies.cmu_protocol.protocol import GROUPS, Fill, Method, Protocol, read_protocol
from studies.shared.result import Claim, Result, Table

SEEDS = 5
ROW, WINDOW, BEFORE = "the row", "7 rows around it", "; rows before"
VISIBLE = "the take's visible columns" + BEFORE
PUBLISHED = [
    ["VGPDS, Matérn 3/2", VISIBLE, 6.99, 2.88, 14.22, 2.23],
    ["VGPDS, RBF", VISIBLE, 8.19, 3.57, 10.73, 1.90],
    ["VGPDS, Matérn 3/2, draft of 2013", VISIBLE, 6.84, 2.94, 13.93, 2.24],
    ["GP-LVM, q = 3", VISIBLE, 11.4, 3.40, 16.9, 2.49],
    ["GP-LVM, q = 4", VISIBLE, 9.7, 3.38, 20.7, 2.72],
    ["GP-LVM, q = 5", VISIBLE, 13.4, 4.25, 23.4, 2.78],
    ["nearest neighbour, standardised", ROW, 13.5, 4.44, 20.8, 2.62],
    ["nearest neighbour, radians", ROW, 14.0, 4.11, 30.9, 3.20],
    ["binary latent model, other columns", ROW + BEFORE, 11.7, None, 8.8, None],
]
"""SC and the error in degrees for leg and body. VGPDS is from Damianou, Titsias and Lawrence,
"Variational Gaussian process dynamical systems" (NIPS 2011, table 1, and the draft of the journal
version, 2013), the last row from Taylor et al. 2006, the others are from Lawrence 2007."""
BEST = {"leg": (6.84, 2.88), "body": (8.8, 1.90)}
"""The smallest published SC and error in degrees for each group, of any method."""
HEADER = ("method", "sees", "leg SC", "leg °", "body SC", "body °")
FORMATS = ("", "", ".1f", ".2f", ".1f", ".2f")
GAUSSIAN = "Gaussian process"
NETWORK = "convolutional autoencoder"


def simple_methods(group: str, deviation: np.ndarray) -> dict[tuple[str, str], Method]:
    """Methods by their name and what they see, with the settings of the smallest error on training
    takes left out."""
    gaussian = baselines.gaussian_process(*START[group])
    return {
        ("nearest neighbour, standardised", ROW): baselines.nearest(np.ones(59)),
        ("nearest neighbour, radians", ROW): baselines.nearest(deviation),
        (GAUSSIAN, WINDOW): gaussian,
        (GAUSSIAN + ", residual", WINDOW + BEFORE): baselines.corrected(gaussian),
    }


def run(folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Measure every method on the test take, leg and body.

    Raises ValueError where the folders lack takes.
    """
    protocol = read_protocol(folders)
    groups = [_Group(protocol, name, seed) for name in GROUPS]
    rows = [[name, sees, *_printed(groups, name)] for name, sees in groups[0].sees.items()]
    tables = [
        Table("Published", HEADER, PUBLISHED, FORMATS),
        Table(f"Measured; the network from {SEEDS} seeds, mean ± deviation", HEADER, rows, FORMATS),
    ]
    return Result(
        "CMU subject 35: a published protocol for missing data",
        tables,
        _claims(groups),
    )


class _Group:
    """The errors and the values of all methods for one group of hidden columns."""

    def __init__(self, protocol: Protocol, group: str, seed: int):
        self.name = group
        self.columns = GROUPS[group]
        methods = simple_methods(group, protocol.deviation)
        self.sees = dict(methods.keys())
        self.simple = list(self.sees)
        takes = protocol.standardised
        self.test: dict[str, np.ndarray] = {}
        for (name, _), method in methods.items():
            self._add(protocol, name, [method(takes, self.columns)])
        self._add(protocol, NETWORK, networks(takes, self.columns, range(seed, seed + SEEDS)))

    def _add(self, protocol: Protocol, name: str, fills: Sequence[Fill]) -> None:
        values = [protocol.test_values(fill, self.columns) for fill in fills]
        self.sees.setdefault(name, VISIBLE)
        self.test[name] = np.array([protocol.errors([each], self.columns) for each in values])


def _printed(groups: Sequence[_Group], name: str) -> list[object]:
    """SC and degrees of each group; mean and deviation where there are several seeds."""
    cells: list[object] = []
    for group in groups:
        errors = group.test[name]
        if len(errors) == 1:
            cells += list(errors[0])
            continue
        sc, degrees = errors.mean(axis=0)
        sc_spread, spread = errors.std(axis=0, ddof=1)
        cells += [f"{sc:.1f} ± {sc_spread:.1f}", f"{degrees:.2f} ± {spread:.2f}"]
    return cells


def _claims(groups: Sequence[_Group]) -> list[Claim]:
    names = [row[0] for row in PUBLISHED if str(row[0]).startswith("nearest")]
    published = np.array([row[2:] for row in PUBLISHED if row[0] in names], dtype=float)
    read = np.array([np.concatenate([g.test[name][0] for g in groups]) for name in names])
    off = np.abs(read - published).max(axis=0)
    same = bool((off < [0.1, 0.01, 0.1, 0.01]).all())
    claims = [
        Claim(
            "same_protocol", same, f"at most {off[::2].max():.2f} and {off[1::2].max():.3f}° off."
        )
    ]
    for group in groups:
        errors = {name: each.mean(axis=0) for name, each in group.test.items()}
        simple = min(group.simple, key=lambda name: errors[name][0])
        ours = errors[NETWORK]
        other = errors[simple]
        best = BEST[group.name]
        figures = f"{NETWORK} {ours[0]:.1f} and {ours[1]:.2f}°"
        of = f"{group.name} hidden"
        also = f"; {simple} {other[0]:.1f} and {other[1]:.2f}°."
        claims += [
            Claim(
                "below_published",
                bool((ours < np.array(best)).all()),
                f"{figures}; published {best[0]} and {best[1]}°.",
                of,
            ),
            Claim("below_simple", bool((ours < other).all()), figures + also, of),
        ]
    return claims
