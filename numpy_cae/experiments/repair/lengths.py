"""Clips of any length: holden2015, section 4, "in our framework this dimension is variable in
size".

A network trained on windows of 160 frames is given clips of other lengths. The same test takes are
cut into pieces that do not overlap, each piece is projected by itself, and the projections are
glued together; or nothing is cut. Every row of the table is measured on the same frames.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.measures import position_error
from numpy_cae.motion import POSITIONS, joint_slice
from numpy_cae.motion.windows import LENGTH
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, save_figure

PIECES = (16, 40, 80, 160, 320)
WHOLE = "whole clip"
_LEAST = 3  # frames of a piece, at the end of a take


@dataclass(frozen=True)
class Row:
    """Takes projected in pieces of one length.

    Parameters
    ----------
    pieces : str
        How long a piece is.
    error : float
        `position_error` against the truth, cm.
    seam : float
        Mean step of a joint from one piece's last frame to the next one's first, cm: how much
        further than in truth. Not a number where nothing was cut.
    """

    pieces: str
    error: float
    seam: float


@dataclass(frozen=True)
class Lengths:
    """The table, and the left wrist of one take in pieces, whole and in truth."""

    rows: list[Row]
    takes: int
    frames: int
    wrist: dict[str, np.ndarray]
    seams: list[int]
    rate: float
    title: str = "Clips of any length"

    def row(self, pieces: str) -> Row:
        """The row of a length."""
        return next(row for row in self.rows if row.pieces == pieces)

    def text(self) -> str:
        """Each length by its error and its seams."""
        rows = [
            [row.pieces, f"{row.error:.2f}", "" if np.isnan(row.seam) else f"{row.seam:.2f}"]
            for row in self.rows
        ]
        table = text_table(["projected in pieces of", "error, cm", "jump at a seam, cm"], rows)
        return f"{self.takes} test takes, {self.frames} frames, the same in every row:\n\n{table}"

    def findings(self) -> list[Finding]:
        """Whether the length matters."""
        whole, window = self.rows[-1], self.row(_frames(LENGTH))
        shortest = self.rows[0]
        return [
            Finding(
                "Windows have 160 frames, but in our framework this dimension is variable in size "
                "(holden2015, section 4).",
                whole.error <= window.error,
                f"takes projected whole are {whole.error:.2f} cm off, in windows of 160 frames "
                f"{window.error:.2f} cm and with a jump of {window.seam:.2f} cm at every seam; "
                f"pieces of {shortest.pieces} are {shortest.error:.2f} cm off.",
            )
        ]

    def save_picture(self, path: str | Path) -> None:
        """Error by length, and the height of a wrist across the seams."""
        figure = Figure(figsize=(10, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.6))
        names = [row.pieces.removesuffix(" frames") for row in self.rows]
        left.bar(names, [row.error for row in self.rows], color=PROJECTED)
        left.set(xlabel="frames in a piece", ylabel="error, cm", title="error by length")
        colours = {"truth": TRUTH, "in pieces": CORRUPTED, WHOLE: PROJECTED}
        seconds = np.arange(len(self.wrist["truth"])) / self.rate
        for seam in self.seams:
            right.axvline((seam - 0.5) / self.rate, color="#cccccc", linewidth=0.8)
        for name, height in self.wrist.items():
            right.plot(seconds, 100 * height, label=name, color=colours[name])
        title = "left wrist's height; grey: seams between pieces of 40 frames"
        right.set(xlabel="s", ylabel="cm", title=title)
        right.legend()
        save_figure(figure, path)


def lengths(manifold: MotionManifold, material: Material, seed: int = 0) -> Lengths:
    """Project test takes whole and in pieces of every length.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        Of its test takes those longer than a window are used, or all where none is.
    seed : int
        Unused: nothing is drawn.
    """
    takes = [manifold.features(take.positions)[0] for take in material.testing]
    takes = [take for take in takes if len(take) > manifold.settings.get("window", LENGTH)] or takes
    truth = np.concatenate(takes)
    rows = []
    for length in PIECES:
        cut = [_in_pieces(manifold, take, length) for take in takes]
        seams = [_jumps(x, take, length) for x, take in zip(cut, takes, strict=True)]
        jump = np.concatenate(seams)
        error = position_error(np.concatenate(cut), truth)
        rows.append(Row(_frames(length), error, jump.mean() if len(jump) else np.nan))
    whole = [manifold.project(take) for take in takes]
    rows.append(Row(WHOLE, position_error(np.concatenate(whole), truth), np.nan))
    wrist, seams = _wrist(manifold, max(takes, key=len))
    return Lengths(rows, len(takes), len(truth), wrist, seams, manifold.rate)


def _frames(length: int) -> str:
    return f"{length} frames"


def _starts(frames: int, length: int) -> list[int]:
    """Where pieces start; a rest too short to stand alone stays with the piece before."""
    return [start for start in range(0, frames, length) if start == 0 or frames - start >= _LEAST]


def _in_pieces(manifold: MotionManifold, take: np.ndarray, length: int) -> np.ndarray:
    pieces = np.split(take, _starts(len(take), length)[1:])
    return np.concatenate([manifold.project(piece) for piece in pieces])


def _jumps(projected: np.ndarray, truth: np.ndarray, length: int) -> np.ndarray:
    """How much further joints step across each seam than in truth, cm: mean ‖Δp̂ - Δp‖."""
    seams = np.array(_starts(len(truth), length)[1:], dtype=int)
    gap = (projected - truth)[:, POSITIONS].reshape(len(truth), -1, 3)
    return 100 * np.linalg.norm(gap[seams] - gap[seams - 1], axis=-1).mean(axis=-1)


def _wrist(manifold: MotionManifold, take: np.ndarray) -> tuple[dict[str, np.ndarray], list[int]]:
    height = joint_slice("left_wrist").start + 1
    shown = slice(0, 240)
    motions = {
        "truth": take,
        "in pieces": _in_pieces(manifold, take, 40),
        WHOLE: manifold.project(take),
    }
    seams = [start for start in _starts(len(take), 40)[1:] if start < shown.stop]
    return {name: x[shown, height] for name, x in motions.items()}, seams
