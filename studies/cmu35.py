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

from studies.cmu_protocol.networks import networks, start
from studies.cmu_protocol.protocol import GROUPS, Protocol, add_residual, nearest, read_protocol
from studies.shared.result import Claim, Result, Table

SEEDS = 5
ROW = "the row"
WINDOW = "7 rows around it"
BEFORE = "; rows before"
VISIBLE = "the take's visible columns" + BEFORE
STANDARDISED = "nearest neighbour, standardised"
RADIANS = "nearest neighbour, radians"
GAUSSIAN = "Gaussian process"
RESIDUAL = "Gaussian process, residual"
NETWORK = "convolutional autoencoder"
SEES = {
    STANDARDISED: ROW,
    RADIANS: ROW,
    GAUSSIAN: WINDOW,
    RESIDUAL: WINDOW + BEFORE,
    NETWORK: VISIBLE,
}
"""Method to what it is given."""
PUBLISHED = [
    ["VGPDS, Matérn 3/2", VISIBLE, 6.99, 2.88, 14.22, 2.23],
    ["VGPDS, RBF", VISIBLE, 8.19, 3.57, 10.73, 1.90],
    ["VGPDS, Matérn 3/2, draft of 2013", VISIBLE, 6.84, 2.94, 13.93, 2.24],
    ["GP-LVM, q = 3", VISIBLE, 11.4, 3.40, 16.9, 2.49],
    ["GP-LVM, q = 4", VISIBLE, 9.7, 3.38, 20.7, 2.72],
    ["GP-LVM, q = 5", VISIBLE, 13.4, 4.25, 23.4, 2.78],
    [STANDARDISED, ROW, 13.5, 4.44, 20.8, 2.62],
    [RADIANS, ROW, 14.0, 4.11, 30.9, 3.20],
    ["binary latent model, other columns", ROW + BEFORE, 11.7, None, 8.8, None],
]
"""SC and the error in degrees for leg and body. VGPDS is from Damianou, Titsias and Lawrence,
"Variational Gaussian process dynamical systems" (NIPS 2011, table 1, and the draft of the journal
version, 2013), the last row from Taylor et al. 2006, the others are from Lawrence 2007."""
BEST = {"leg": (6.84, 2.88), "body": (8.8, 1.90)}
"""The smallest published SC and error in degrees for each group, of any method."""
HEADER = ("method", "sees", "leg SC", "leg °", "body SC", "body °")
FORMATS = ("", "", ".1f", ".2f", ".1f", ".2f")
Errors = dict[str, np.ndarray]
"""Method to SC and the error in degrees, a row for each seed."""


def run(folders: Sequence[str | Path], seed: int = 0) -> Result:
    """Measure every method on the test take, leg and body.

    Raises ValueError where the folders lack takes.
    """
    protocol = read_protocol(folders)
    errors = {group: _errors(protocol, group, seed) for group in GROUPS}
    rows = []
    for name, sees in SEES.items():
        row: list[object] = [name, sees]
        for group in GROUPS:
            row += _cells(errors[group][name])
        rows.append(row)
    tables = [
        Table("Published", HEADER, PUBLISHED, FORMATS),
        Table(f"Measured; the network from {SEEDS} seeds, mean ± deviation", HEADER, rows, FORMATS),
    ]
    title = "CMU subject 35: a published protocol for missing data"
    return Result(title, tables, _claims(errors))


def _errors(protocol: Protocol, group: str, seed: int) -> Errors:
    """SC and degrees of every method for a group of hidden columns, from each seed."""
    columns = GROUPS[group]
    takes = protocol.standardised
    gaussian = start(takes, columns)
    fills = {
        STANDARDISED: [nearest(takes, columns, np.ones(59))],
        RADIANS: [nearest(takes, columns, protocol.deviation)],
        GAUSSIAN: [gaussian],
        RESIDUAL: [add_residual(gaussian, columns)],
        NETWORK: networks(takes, columns, range(seed, seed + SEEDS)),
    }
    errors = {}
    for name, fills_of_method in fills.items():
        errors[name] = np.array([protocol.errors(fill, columns) for fill in fills_of_method])
    return errors


def _cells(errors: np.ndarray) -> list[object]:
    """SC and degrees; mean and deviation where there are several seeds."""
    if len(errors) == 1:
        return list(errors[0])
    sc, degrees = errors.mean(axis=0)
    sc_spread, spread = errors.std(axis=0, ddof=1)
    return [f"{sc:.1f} ± {sc_spread:.1f}", f"{degrees:.2f} ± {spread:.2f}"]


def _claims(of_groups: dict[str, Errors]) -> list[Claim]:
    published = np.array([row[2:] for row in PUBLISHED if row[0] in (STANDARDISED, RADIANS)])
    measured = []
    for name in (STANDARDISED, RADIANS):
        measured.append(np.concatenate([of_groups[group][name][0] for group in GROUPS]))
    off = np.abs(np.array(measured) - published.astype(float)).max(axis=0)
    same = bool((off < [0.1, 0.01, 0.1, 0.01]).all())
    figures = f"at most {off[::2].max():.2f} and {off[1::2].max():.3f}° off."
    claims = [Claim("same_protocol", same, figures)]
    for group, errors in of_groups.items():
        mean = {name: of_seeds.mean(axis=0) for name, of_seeds in errors.items()}
        network = mean.pop(NETWORK)
        simple = min(mean, key=lambda name: mean[name][0])
        best = BEST[group]
        figures = f"{NETWORK} {network[0]:.1f} and {network[1]:.2f}°"
        below = f"{figures}; published {best[0]} and {best[1]}°."
        also = f"{figures}; {simple} {mean[simple][0]:.1f} and {mean[simple][1]:.2f}°."
        of = f"{group} hidden"
        claims.append(Claim("below_published", bool((network < np.array(best)).all()), below, of))
        claims.append(Claim("below_simple", bool((network < mean[simple]).all()), also, of))
    return claims
