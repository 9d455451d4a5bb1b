"""Figure 2 of jang2018: reconstruction error and discrepancy against iterations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from numpy_cae.evaluation.table import Table
from studies.jang2018.training import Curve, Study
from studies.shared.result import Claim, Picture, Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MEASURES = {"error": "reconstruction error, rad", "discrepancy": "discrepancy to the prior"}


def figure_2(studies: Sequence[Study]) -> Result:
    """Compare the first and the last tenth of each curve."""
    curves = {study.action.name: study.curve for study in studies}
    rows = []
    for action, curve in curves.items():
        for measure, name in MEASURES.items():
            tenth = max(1, len(curve[measure]) // 10)
            first, last = curve[measure][:tenth].mean(), curve[measure][-tenth:].mean()
            rows.append([f"{action}: {name}", first, last, last / first])
    formats = ("", ".3f", ".3f", ".2f")
    caption = "Errors on held-out clips against iterations (figure 2):"
    table = Table(caption, ["curve", "first tenth", "last tenth", "ratio"], rows, formats)
    claims = [_claim(table, measure, list(curves)) for measure in MEASURES]
    title = "Figure 2 of jang2018: errors against iterations"
    return Result(title, [table], claims, {"figure_2": Picture(lambda: _draw(curves))})


def _claim(table: Table, measure: str, actions: Sequence[str]) -> Claim:
    ratios = {action: table.value(f"{action}: {MEASURES[measure]}", "ratio") for action in actions}
    remaining = ", ".join(f"{action} {ratio:.2f}" for action, ratio in ratios.items())
    falls = all(ratio < 0.5 for ratio in ratios.values())
    return Claim(f"{measure}_decreases", falls, f"Last tenth by first: {remaining}.")


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
