"""The network on a published protocol: missing data in a walk of CMU subject 35.

    python -m studies cmu35 --data cmu35

All methods learn from the 31 training takes alone. Their settings were chosen on training takes
left out, whose errors are in a table of their own; no setting was chosen on the test take.

A hole of 62 rows (2 s) reaches to the end of take 35_29. The other columns are known in all rows,
so that a method may see later rows of these; none sees hidden columns after the hole, where there
are no rows. Residual: the error on the take's rows before the hole is carried into it, which the
network's row includes. It starts from the Gaussian process.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from numpy_cae.viz.curves import Curve, curves_figure
from studies.cmu_protocol import baselines
from studies.cmu_protocol.networks import START, networks_of
from studies.cmu_protocol.protocol import GROUPS, Fill, Method, Protocol, read_protocol
from studies.shared.result import Claim, Picture, Result, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SEEDS, RATE = 5, 30
ROW, WINDOW, BEFORE = "the row", "15 rows around it", "; rows before"
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
LEFT_OUT = "Training takes left out, by which all settings were chosen (network: one seed)"
GAUSSIAN = "Gaussian process"
NETWORK = "convolutional autoencoder"
KNEE = 3
"""The index of the knee among the leg's columns."""


def simple_methods(group: str, deviation: np.ndarray) -> dict[tuple[str, str], Method]:
    """Methods by their name and what they see, with the settings of the smallest error on training
    takes left out."""
    ridge, gaussian = baselines.ridge(15, 1000), baselines.ridge(*START[group])
    return {
        ("nearest neighbour, standardised", ROW): baselines.nearest(np.ones(59)),
        ("nearest neighbour, radians", ROW): baselines.nearest(deviation),
        ("last known value", "rows before"): baselines.held,
        ("ridge regression, one row", ROW): baselines.ridge(1, 100),
        ("ridge regression", WINDOW): ridge,
        ("ridge regression, residual", WINDOW + BEFORE): baselines.corrected(ridge),
        (GAUSSIAN, "7 rows around it"): gaussian,
        (GAUSSIAN + ", residual", "7 rows around it" + BEFORE): baselines.corrected(gaussian),
    }


def run(folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Measure every method on the test take and on training takes left out, leg and body.

    Raises ValueError where the folders lack takes.
    """
    protocol = read_protocol(folders)
    groups = [_Group(protocol, name, seed) for name in GROUPS]
    rows = [[name, sees, *_printed(groups, name, "test")] for name, sees in groups[0].sees.items()]
    left_out = [[name, *_printed(groups, name, "left_out")] for name in groups[0].left_out]
    tables = [
        Table("Published", HEADER, PUBLISHED, FORMATS),
        Table(f"Measured; the network from {SEEDS} seeds, mean ± deviation", HEADER, rows, FORMATS),
        Table(LEFT_OUT, (HEADER[0], *HEADER[2:]), left_out, FORMATS[1:]),
    ]
    return Result(
        "CMU subject 35: a published protocol for missing data",
        tables,
        _claims(groups),
        {"cmu35": Picture(lambda: _figure(groups[0]))},
    )


class _Group:
    """The errors and the values of all methods for one group of hidden columns."""

    def __init__(self, protocol: Protocol, group: str, seed: int):
        self.name, self.columns = group, GROUPS[group]
        methods = simple_methods(group, protocol.deviation)
        self.sees = dict(methods.keys())
        self.simple = list(self.sees)

        def learn(takes: Sequence[np.ndarray], columns: list[int], seeds: int = 1) -> list[Fill]:
            simple = [method(takes, columns) for method in methods.values()]
            return simple + networks_of(range(seed, seed + seeds))(takes, columns)

        left_out = protocol.left_out(learn, self.columns)
        self.left_out = dict(zip([*self.simple, NETWORK], left_out, strict=True))
        fills = learn(protocol.standardised, self.columns, SEEDS)
        self.values: dict[str, np.ndarray] = {}
        self.test: dict[str, np.ndarray] = {}
        for name, fill in zip(self.simple, fills, strict=False):
            self._add(protocol, name, [fill])
        self._add(protocol, NETWORK, fills[len(self.simple) :])

    def _add(self, protocol: Protocol, name: str, fills: Sequence[Fill]) -> None:
        values = [protocol.test_values(fill, self.columns) for fill in fills]
        self.sees.setdefault(name, VISIBLE)
        self.values[name], self.truth = (protocol.degrees(each, self.columns) for each in values[0])
        self.test[name] = np.array([protocol.errors([each], self.columns) for each in values])


def _printed(groups: Sequence[_Group], name: str, kind: str) -> list[object]:
    """SC and degrees of each group; mean and deviation where there are several seeds."""
    cells: list[object] = []
    for group in groups:
        errors = np.atleast_2d(getattr(group, kind)[name])
        if len(errors) == 1:
            cells += list(errors[0])
            continue
        (sc, degrees), (sc_spread, spread) = errors.mean(axis=0), errors.std(axis=0, ddof=1)
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
        ours, other = errors[NETWORK], errors[simple]
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


def _figure(leg: _Group) -> Figure:
    """The knee of the hidden leg over time: truth, Gaussian process, network."""
    time = np.arange(len(leg.truth)) / RATE
    curves = [Curve(time, leg.truth[:, KNEE], "truth", TRUTH)]
    for name, colour in ((GAUSSIAN, CORRUPTED), (NETWORK, PROJECTED)):
        curves.append(Curve(time, leg.values[name][:, KNEE], name, colour))
    return curves_figure(curves, "time in the hole, s", "right knee, degrees", (9.5, 4.0))
