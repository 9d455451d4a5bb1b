"""Figure 2 of jang2018: reconstruction error and discrepancy against iterations, by action."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.study import Curve, Study
from numpy_cae.experiments.table import text_table
from numpy_cae.viz import save_figure

KINDS = {
    "error": "reconstruction error, rad",
    "discrepancy": "discrepancy to the prior",
}


@dataclass(frozen=True)
class Figure2:
    """The curves of each action, measured on held-out motions."""

    curves: dict[str, Curve]
    title: str = "Figure 2 of jang2018: errors against iterations"

    def ends(self, action: str, kind: str) -> tuple[float, float]:
        """The mean of a curve over its first tenth and over its last."""
        values = getattr(self.curves[action], kind)
        tenth = max(1, len(values) // 10)
        return float(values[:tenth].mean()), float(values[-tenth:].mean())

    def text(self) -> str:
        """For each curve its first tenth, its last and their ratio."""
        rows = []
        for action in self.curves:
            for kind, name in KINDS.items():
                first, last = self.ends(action, kind)
                rows.append(
                    [f"{action}: {name}", f"{first:.3f}", f"{last:.3f}", f"{last / first:.2f}"]
                )
        return text_table(["curve", "first tenth", "last tenth", "ratio"], rows)

    def findings(self) -> list[Finding]:
        """Whether both errors decrease, each to below half, for every action."""
        found = []
        for kind, name in KINDS.items():
            ratios = {}
            for action in self.curves:
                first, last = self.ends(action, kind)
                ratios[action] = last / first
            found.append(
                Finding(
                    f"As the iteration increases, the {name.split(',')[0]} gradually decreases "
                    "(jang2018, Results; here: the last tenth below half of the first).",
                    all(ratio < 0.5 for ratio in ratios.values()),
                    ", ".join(f"{action} {ratio:.2f}" for action, ratio in ratios.items())
                    + " of the first tenth is left.",
                )
            )
        return found

    def save_picture(self, path: str | Path) -> None:
        """Two panels, a line for each action."""
        figure = Figure(figsize=(9, 3.4), layout="constrained")
        for axes, (kind, name) in zip(figure.subplots(1, 2), KINDS.items(), strict=True):
            for action, curve in self.curves.items():
                axes.plot(curve.steps, getattr(curve, kind), label=action.replace("_", " "))
            axes.set(xlabel="iterations", title=name)
            axes.set_yscale("log")
            axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False)
        save_figure(figure, path)


def figure_2(studies: Sequence[Study]) -> Figure2:
    """The figure of these trainings."""
    return Figure2({study.action.name: study.curve for study in studies})
