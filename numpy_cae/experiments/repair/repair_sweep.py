"""Values zeroed with every probability p from 0.1 to 0.9, and who repairs them best: holden2015,
section 7, "Fixing Corrupt Motion Data", beside everything else that one would try.

Zeroing with probability p shrinks what is left: E[X_c] = (1 - p) X. So whatever is linear, and
the network too, is also given X_c / (1 - p), which is X on average.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from numpy_cae.baselines import Moments, interpolate_linearly
from numpy_cae.experiments.clips import (
    ALL_SHIFTS,
    ENDS_HELD,
    NETWORK,
    Clips,
    project,
    project_ends_held,
)
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.repair.repair_baselines import (
    MEDIAN,
    PCA_ON_FRAMES,
    PCA_ON_WINDOWS,
    SAVITZKY_GOLAY,
    Contender,
    contenders_of,
)
from numpy_cae.experiments.split import split_of
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.training import zero_values
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, Curve, curves_figure, save_figure

PS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
HALF = 0.5
"""The p of the paper's figure 1."""
CORRUPTED_ROW, LINEAR = "corrupted, X_c", "linear denoiser, 15 frames"
RESCALED = ", X_c / (1 - p)"
INTERPOLATED = "linear interpolation, told where the holes are"
COLOURS = {
    CORRUPTED_ROW: CORRUPTED,
    NETWORK: "#8fb8e8",
    ENDS_HELD: PROJECTED,
    ALL_SHIFTS: "#123f7a",
    LINEAR: "#222222",
    MEDIAN: "#9c6bb3",
    SAVITZKY_GOLAY: "#b59a3c",
    PCA_ON_FRAMES: "#c0504d",
    PCA_ON_WINDOWS: "#4aa6a6",
}


@dataclass(frozen=True)
class RepairSweep:
    """Errors in cm for each p of `PS`, by method.

    Parameters
    ----------
    blind : dict of str to list of float
        Nobody says which values are lost.
    told : dict of str to list of float
        Somebody does.
    chosen : dict of str to list of str
        The setting of each method that has one.
    floor : float
        Error of the network on undamaged windows, cm.
    sample : str
        What it was measured on.
    half : dict of str to dict of str to float
        The column of p = 0.5, by source of the takes.
    taught_rescaled : bool
        Whether the network was trained on X_c / (1 - p), so that this is its plain use.
    """

    blind: dict[str, list[float]]
    told: dict[str, list[float]]
    chosen: dict[str, list[str]]
    floor: float
    sample: str
    half: dict[str, dict[str, float]]
    taught_rescaled: bool = False
    title: str = "Repair: values set to zero"

    def winners(self) -> list[str]:
        """The blind method of least error for each p."""
        return [min(self.blind, key=lambda name: self.blind[name][i]) for i in range(len(PS))]

    def text(self) -> str:
        """Three tables: blind, told, and the settings."""
        ps = [f"p = {p}" for p in PS]

        def table(first: str, rows: dict[str, list[float]]) -> str:
            lines = [[name, *(f"{error:.2f}" for error in row)] for name, row in rows.items()]
            return text_table([first, *ps], lines)

        return "\n\n".join(
            [
                "Blind repair, error in cm (root mean square a coordinate). No method is told "
                "which values were lost, though a value of exactly zero gives it away to anyone "
                "who looks; rescaling, the linear denoiser and the chosen settings know p. Ends "
                "held: beyond a window the network sees its first and last frame, not the mean "
                "pose. All shifts: the mean of its projections at all places of its pooling grid, "
                "from the kind of input that it was trained on.",
                table("blind", self.blind),
                *self._by_source(),
                f"Least error: {self._winners()}.",
                "Where the holes are known the problem is another and easier one:",
                table("holes known", self.told),
                "Settings chosen (axes of PCA; frames, or frames and order, of a filter):",
                text_table(["setting", *ps], [[name, *row] for name, row in self.chosen.items()]),
                self.sample,
            ]
        )

    def _by_source(self) -> list[str]:
        if len(self.half) < 2:
            return []
        rows = [
            [name, *(f"{errors[name]:.2f}" for errors in self.half.values())] for name in self.blind
        ]
        table = text_table([f"p = {HALF}", *self.half], rows)
        return [f"At p = {HALF} by source of the takes:", table]

    def _winners(self) -> str:
        runs = groupby(zip(PS, self.winners(), strict=True), key=lambda pair: pair[1])
        parts = []
        for name, run in runs:
            ps = [p for p, _ in run]
            parts.append(f"{name} at p = {ps[0]}" + (f" to {ps[-1]}" if len(ps) > 1 else ""))
        return "; ".join(parts)

    def findings(self) -> list[Finding]:
        """What the paper says of p = 0.5, and what it does not ask."""
        half = PS.index(HALF)
        at = {name: errors[half] for name, errors in self.blind.items()}
        rescaled = RESCALED if self.taught_rescaled else ""
        plain, corrupted = at[NETWORK + rescaled], at[CORRUPTED_ROW]
        best = min(error for name, error in at.items() if name.startswith(NETWORK))
        pca = min(error for name, error in at.items() if name.startswith("PCA"))
        return [
            Finding(
                "Half of all values set to zero, projection effectively recovers the motion "
                "(holden2015, section 7; we count it as held if less than half of the error is "
                "left).",
                plain < corrupted / 2,
                f"{corrupted:.2f} cm before, {plain:.2f} cm after, {plain / corrupted:.2f} of it "
                f"({at[ENDS_HELD + rescaled]:.2f} cm with the ends of a window held, "
                f"{at[ALL_SHIFTS + rescaled]:.2f} cm with that and as the mean over all shifts of "
                f"the pooling grid); an undamaged motion comes back {self.floor:.2f} cm off.",
            ),
            Finding(
                "At p = 0.5 the network repairs better than PCA (a comparison that holden2015 "
                "does not make).",
                best < pca,
                f"network {best:.2f} cm, PCA {pca:.2f} cm, each at its best.",
            ),
            Finding(
                "At p = 0.5 the network repairs better than the best linear map of 15 frames "
                "(nor this one).",
                best < at[LINEAR],
                f"network {best:.2f} cm, linear denoiser {at[LINEAR]:.2f} cm.",
            ),
        ]

    def save_picture(self, path: str | Path) -> None:
        """Error over p, PNG; dashed: from X_c / (1 - p); dotted: told where the holes are."""
        curves = [
            Curve(
                PS,
                errors,
                name,
                COLOURS[name.removesuffix(RESCALED)],
                "--" if name.endswith(RESCALED) else "-",
            )
            for name, errors in self.blind.items()
        ]
        curves.append(Curve(PS, self.told[INTERPOLATED], "interpolation, told", PLAIN, ":"))
        figure = curves_figure(curves, "p, share of values set to zero", "error, cm")
        # Rescaling a filter's input blows its error up; what is worse than 1.5 times doing
        # nothing need not be seen.
        figure.axes[0].set_ylim(0, 1.5 * max(self.blind[CORRUPTED_ROW]))
        save_figure(figure, path)


def repair_sweep(manifold: MotionManifold, material: Material, seed: int = 0) -> RepairSweep:
    """Zero values of held-out windows and repair them in every way.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
    seed : int
        Of the lost values.
    """
    split = split_of(manifold, material)
    choosing, testing = split.choosing, split.testing
    contenders = contenders_of(split)
    moments = Moments.of(split.training.x, split.training.real)
    floor = testing.error(project(manifold, testing.x))
    source = np.array([material.testing[take].source for take in testing.take])
    of_source = {name: testing.where(source == name, testing.real) for name in sorted(set(source))}
    half = {name: {} for name in of_source}
    table = RepairSweep({}, {}, {}, floor, split.text(), half, manifold.rescales)

    def note(p: float, column: dict[str, list[float]], name: str, repaired: np.ndarray) -> None:
        column.setdefault(name, []).append(testing.error(repaired))
        if p == HALF:
            for each, clips in of_source.items():
                half[each][name] = clips.error(repaired[source == each])

    for number, p in enumerate(PS):
        rng = np.random.default_rng([seed, number])
        practice, _ = _zeroed(choosing, p, rng)
        lost, known = _zeroed(testing, p, rng)
        note(p, table.blind, CORRUPTED_ROW, lost)
        for rescaled, by in (("", 1.0), (RESCALED, 1 / (1 - p))):
            for contender in _worth_it(contenders, rescaled):
                setting = contender.best(practice * by, choosing)
                name = contender.name + rescaled
                note(p, table.blind, name, contender.repair(lost * by, setting))
                table.chosen.setdefault(name, []).append(str(setting).strip("()"))
            note(p, table.blind, NETWORK + rescaled, project(manifold, lost * by))
            note(p, table.blind, ENDS_HELD + rescaled, project_ends_held(manifold, lost * by))
            if bool(rescaled) == manifold.rescales:  # eight times the work: only as it was taught
                shifted = project_ends_held(manifold, lost * by, manifold.shifts)
                note(p, table.blind, ALL_SHIFTS + rescaled, shifted)
        note(p, table.blind, LINEAR, moments.solve(1 - p).repair(lost))
        note(p, table.told, INTERPOLATED, interpolate_linearly(lost, known))
    return table


def _worth_it(contenders: list[Contender], rescaled: str) -> list[Contender]:
    # The median of what is left is not shrunk: it is a value that was there, or zero.
    return [each for each in contenders if not (rescaled and each.name == MEDIAN)]


def _zeroed(clips: Clips, p: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """X_c, and which of its values are known."""
    kept = zero_values(np.ones_like(clips.x), p, rng)
    return clips.x * kept, kept > 0
