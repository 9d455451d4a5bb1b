"""Figure 2 of jang2018: reconstruction error and discrepancy against iterations, by action."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.experiments.sequences.study import Curve, Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MEASURES = {"error": "reconstruction error, rad", "discrepancy": "discrepancy to the prior"}


def figure_2(studies: Sequence[Study]) -> Result:
    """Compare the first and the last tenth of each curve."""
    curves = {study.action.name: study.curve for study in studies}
    rows = [
        [f"{action}: {name}", *_first_and_last(curve[measure])]
        for action, curve in curves.items()
        for measure, name in MEASURES.items()
    ]
    rows = [[name, first, last, last / first] for name, first, last in rows]
    formats = ("", ".3f", ".3f", ".2f")
    table = Table("", ["curve", "first tenth", "last tenth", "ratio"], rows, formats)
    claims = [_claim(table, name, list(curves)) for name in MEASURES.values()]
    title = "Figure 2 of jang2018: errors against iterations"
    return Result(title, [table], claims, lambda: _draw(curves))


def _first_and_last(values: np.ndarray) -> tuple[float, float]:
    """The means of a curve over its first and its last tenth."""
    tenth = max(1, len(values) // 10)
    return float(values[:tenth].mean()), float(values[-tenth:].mean())


def _claim(table: Table, name: str, actions: Sequence[str]) -> Claim:
    ratios = {action: table.value(f"{action}: {name}", "ratio") for action in actions}
    remaining = ", ".join(f"{action} {ratio:.2f}" for action, ratio in ratios.items())
    return Claim(
        f"As the iteration increases, the {name.split(',')[0]} gradually decreases (jang2018, "
        "Results; here: the last tenth is below half of the first).",
        all(ratio < 0.5 for ratio in ratios.values()),
        f"Ratio of the last tenth to the first: {remaining}.",
    )


def _draw(curves: dict[str, Curve]) -> Figure:
    """Two panels with a line for each action."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.4), layout="constrained")
    for axes, (measure, name) in zip(figure.subplots(1, 2), MEASURES.items(), strict=True):
        for action, curve in curves.items():
            axes.plot(curve["steps"], curve[measure], label=action.replace("_", " "))
        axes.set(xlabel="iterations", title=name)
        axes.set_yscale("log")
        axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    return figure
