"""The four charts of docs/results.md, each drawn from the tables of a study.

Backgrounds are transparent and texts grey, so that a chart can be read on light and on dark pages.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING

from numpy_cae.evaluation.tables import COMPLETED, DYNAMICS, GAUSSIAN, LINEAR, NETWORK, PROCESS
from studies.shared.result import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

GREY = "#7c8691"
"""Texts and axes."""
ORANGE = "#e8833a"
BLUE = "#3f83cf"
GREEN = "#3f9a4b"
PURPLE = "#9a6bc2"
METHODS = {
    LINEAR: ("linear map, zeros", GREY, "--"),
    NETWORK: ("network, zeros", BLUE, "--"),
    PROCESS: ("Gaussian process, mask given", PURPLE, "-"),
    DYNAMICS: ("Kalman smoother, mask given", GREEN, "-"),
    GAUSSIAN: ("Gaussian, mask given", ORANGE, "-"),
    COMPLETED: ("complete, mask given", BLUE, "-"),
}
"""Row of the table to its label, colour and style in the chart of errors."""
PARTS = {"wrist": ORANGE, "arm": PURPLE, "leg": BLUE, "whole body": GREEN}


def draw_errors_by_share(tables: Sequence[Table]) -> Figure:
    """Error over the share of values that are removed: a panel for each source left out."""
    left_out = [table for table in tables if table.caption.endswith("left out:")]
    figure = _figure(2.9 * len(left_out), 3.4)
    axes = figure.subplots(1, len(left_out), sharey=True, squeeze=False)[0]
    for panel, table in zip(axes, left_out, strict=True):
        shares = [100 * number_in(title) for title in table.header[1:]]
        for row in table.rows:
            if row[0] not in METHODS:
                continue
            label, colour, style = METHODS[str(row[0])]
            errors = [number_in(cell) for cell in row[1:]]
            panel.plot(shares, errors, style, color=colour, marker="o", markersize=4, label=label)
        panel.set_title(table.caption.removesuffix(", left out:"), fontsize=10)
        panel.set_xticks(shares)
        panel.set_xlabel("values removed, %")
    axes[0].set_ylim(bottom=0)
    axes[0].set_ylabel("error, cm")
    _finish(figure, axes)
    handles, labels = axes[0].get_legend_handles_labels()
    _legend(figure.legend(handles, labels, loc="outside lower center", ncols=3))
    return figure


def draw_ratios_by_length(table: Table, ratio: str) -> Figure:
    """Error of `fill` in holes by that of the best curve, in a column, over the length."""
    column = list(table.header).index(ratio)
    ratios: dict[str, dict[float, float]] = {}
    for row in table.rows:
        part, _, length = str(row[0]).rpartition(", ")
        ratios.setdefault(part, {})[number_in(length) / 30] = number_in(row[column])
    figure = _figure(5.4, 3.2)
    axes = figure.subplots()
    axes.axhline(1, color=GREY, linewidth=1)
    axes.annotate("the best curve", (3, 1.02), color=GREY, fontsize=8, va="bottom", ha="right")
    for part, values in ratios.items():
        seconds = sorted(values)
        heights = [values[second] for second in seconds]
        axes.plot(seconds, heights, color=PARTS[part], marker="o", markersize=4, label=part)
    axes.set_xlabel("length of the hole, s")
    axes.set_ylabel("error, divided by that of the best curve")
    axes.set_ylim(0, 1.15)
    _finish(figure, [axes])
    _legend(axes.legend(loc="lower left", bbox_to_anchor=(1, 0)))
    return figure


def draw_damage_and_repair(table: Table, damaged: str, unknown: str, given: str) -> Figure:
    """A line for each kind of damage: the error as damaged, repaired, and with the mask given."""
    rows = {str(row[0]): row[1:] for row in table.rows}
    kinds = table.header[1:]
    measured = [column for column in range(len(kinds)) if rows[damaged][column] is not None]
    order = sorted(measured, key=lambda column: number_in(rows[damaged][column]))
    figure = _figure(6.4, 0.34 * len(kinds) + 1.1)
    axes = figure.subplots()
    for place, column in enumerate(order):
        before = number_in(rows[damaged][column])
        after = number_in(rows[unknown][column])
        axes.plot([after, before], [place, place], color=GREY, linewidth=1, zorder=1)
        axes.plot(before, place, "o", color=ORANGE, label="as damaged")
        axes.plot(after, place, "o", color=BLUE, label="repaired, mask unknown")
        if rows[given][column] is not None:
            best = number_in(rows[given][column])
            axes.plot(best, place, "|", color=GREEN, markersize=12, label="repaired, mask given")
    axes.set_yticks(range(len(order)), [kinds[column] for column in order])
    axes.set_xlabel("mean error of the damaged joints, cm")
    axes.set_xlim(left=0)
    _finish(figure, [axes])
    handles, labels = axes.get_legend_handles_labels()
    by_label = dict(zip(labels, handles, strict=True))
    _legend(axes.legend(by_label.values(), by_label.keys(), loc="lower right"))
    return figure


def draw_speed(tables: Sequence[Table]) -> Figure:
    """PyTorch's time divided by ours, as bars: one panel for each table, a group for each case."""
    cases = [list(dict.fromkeys(str(row[0]) for row in table.rows)) for table in tables]
    figure = _figure(8.4, 3.2)
    widths = [len(names) for names in cases]
    panels = figure.subplots(1, len(tables), squeeze=False, sharey=True, width_ratios=widths)[0]
    for panel, table, names in zip(panels, tables, cases, strict=True):
        batches = list(dict.fromkeys(row[1] for row in table.rows))
        width = 0.8 / len(batches)
        for number, batch in enumerate(batches):
            offset = width * (number + 0.5) - 0.4
            rows = [row for row in table.rows if row[1] == batch]
            places = [names.index(str(row[0])) + offset for row in rows]
            heights = [number_in(row[-1]) for row in rows]
            shade = 1 - 0.2 * (len(batches) - 1 - number)
            panel.bar(places, heights, width, color=BLUE, alpha=shade, label=f"{batch} at a time")
        panel.axhline(1, color=GREY, linewidth=1)
        panel.set_xticks(range(len(names)), [fill(name, 13) for name in names])
        panel.set_title(table.caption.rstrip(":"))
        _legend(panel.legend(loc="upper right", ncols=2))
    panels[0].set_ylabel("PyTorch's time / ours")
    panels[0].set_ylim(top=1.25 * panels[0].get_ylim()[1])
    _finish(figure, panels)
    return figure


def number_in(cell: object) -> float:
    """The first number of a cell, such as 3.78 of "3.78 ± 0.04"."""
    found = re.search(r"-?\d+(\.\d+)?", str(cell))
    if found is None:
        raise ValueError(f"no number in {cell!r}")
    return float(found[0])


def _figure(width: float, height: float) -> Figure:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained", facecolor="none")


def _finish(figure: Figure, panels: Sequence[Axes]) -> None:
    """Grey axes without a box, on no background."""
    for axes in panels:
        axes.set_facecolor("none")
        axes.spines[["top", "right"]].set_visible(False)
        axes.spines[["left", "bottom"]].set_color(GREY)
        axes.tick_params(colors=GREY, labelsize=8)
        for text in (axes.title, axes.xaxis.label, axes.yaxis.label):
            text.set_color(GREY)
            text.set_fontsize(9)


def _legend(legend: object) -> None:
    """Grey texts without a frame."""
    legend.set_frame_on(False)  # type: ignore[attr-defined]
    for text in legend.get_texts():  # type: ignore[attr-defined]
        text.set_color(GREY)
        text.set_fontsize(8)
