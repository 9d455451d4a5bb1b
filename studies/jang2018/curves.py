"""Figure 2 of jang2018: reconstruction error and discrepancy against iterations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from numpy_cae.evaluation.table import Table
from studies.jang2018.training import Curve, Study
from studies.shared.result import Claim, Picture, Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEAST_PROBABILITY = 0.01
"""LEAST_PROBABILITY: a curve has a trend if p is smaller than this."""
MEASURES = {"error": "reconstruction error, rad", "discrepancy": "discrepancy to the prior"}


def figure_2(studies: Sequence[Study]) -> Result:
    """Test the trend of each curve, and compare its first and its last tenth.

    τ is Kendall's correlation of the error with the iteration (the test of Mann and Kendall), p the
    probability that a curve without a trend has a τ so far from 0.
    """
    from scipy.stats import kendalltau  # slow to import

    curves = {study.action.name: study.curve for study in studies}
    rows = []
    for action, curve in curves.items():
        for measure, name in MEASURES.items():
            tenth = max(1, len(curve[measure]) // 10)
            first = curve[measure][:tenth].mean()
            last = curve[measure][-tenth:].mean()
            trend = kendalltau(curve["steps"], curve[measure])
            row = [f"{action}: {name}", first, last, last / first]
            rows.append([*row, float(trend.statistic), float(trend.pvalue)])
    formats = ("", ".3f", ".3f", ".2f", ".2f", ".1e")
    caption = "Errors on held-out clips against iterations (figure 2):"
    table = Table(caption, ["curve", "first tenth", "last tenth", "ratio", "τ", "p"], rows, formats)
    claims = [_claim(table, measure, list(curves)) for measure in MEASURES]
    title = "Figure 2 of jang2018: errors against iterations"
    return Result(title, [table], claims, {"figure_2": Picture(lambda: _draw(curves))})


def _claim(table: Table, measure: str, actions: Sequence[str]) -> Claim:
    names = [f"{action}: {MEASURES[measure]}" for action in actions]
    falls = True
    figures = []
    for name, action in zip(names, actions, strict=True):
        trend, probability, ratio = (table.value(name, column) for column in ("τ", "p", "ratio"))
        falls = falls and trend < 0 and probability < LEAST_PROBABILITY
        figures.append(f"{action} τ = {trend:.2f}, last tenth by first {ratio:.2f}")
    return Claim(f"{measure}_decreases", falls, f"{'; '.join(figures)}.")


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
