"""Clips of any length: holden2015, section 4, "in our framework this dimension is variable in
size".

A network trained on windows of 160 frames projects clips of other lengths: the same test takes
whole, or cut into pieces that are projected one by one and joined.
"""

import numpy as np

from numpy_cae.evaluation import position_error
from numpy_cae.experiments.material import Material, features_of
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import POSITIONS
from numpy_cae.motion.windows import LENGTH
from numpy_cae.viz import bars_figure

PIECES = (16, 40, 80, 160, 320)
WHOLE = "whole clip"
ERROR, JUMP = "error, cm", "jump at a seam, cm"
_SHORTEST = 3  # frames of the last piece of a take


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Project the test takes longer than a window (all, where none is) whole and in pieces.

    A jump is how much further a joint steps across a seam than in truth.
    """
    takes = features_of(manifold, material.testing)
    takes = [take for take in takes if len(take) > manifold.window] or takes
    truth = np.concatenate(takes)
    rows = []
    for length in PIECES:
        pieces = [np.split(take, _starts(len(take), length)[1:]) for take in takes]
        cut = [np.concatenate([manifold.project(piece) for piece in each]) for each in pieces]
        jumps = [_jumps(x, take, length) for x, take in zip(cut, takes, strict=True)]
        jump = np.concatenate(jumps)
        error = position_error(np.concatenate(cut), truth)
        rows.append([_named(length), error, float(jump.mean()) if len(jump) else None])
    whole = [manifold.project(take) for take in takes]
    rows.append([WHOLE, position_error(np.concatenate(whole), truth), None])
    caption = f"{len(takes)} test takes, {len(truth)} frames, the same in every row:"
    table = Table(caption, ["projected in pieces of", ERROR, JUMP], rows)

    whole_error, window_error = table.value(WHOLE, ERROR), table.value(_named(LENGTH), ERROR)
    window_jump = table.value(_named(LENGTH), JUMP)
    across = "" if window_jump is None else f", with a jump of {window_jump:.2f} cm at a seam"
    claim = Claim(
        "Windows have 160 frames, but in our framework this dimension is variable in size "
        "(holden2015, section 4).",
        whole_error <= window_error,
        f"takes projected whole are {whole_error:.2f} cm off, in windows of 160 frames "
        f"{window_error:.2f} cm{across}; pieces of {rows[0][0]} are {rows[0][1]:.2f} cm off.",
    )
    errors = [row[1] for row in rows]
    return Result(
        "Clips of any length",
        [table],
        [claim],
        lambda: bars_figure([row[0] for row in rows], [("projected", errors, None)], ERROR),
    )


def _named(length: int) -> str:
    return f"{length} frames"


def _starts(frames: int, length: int) -> list[int]:
    """First frames of the pieces; a rest that is too short stays with the piece before."""
    starts = range(0, frames, length)
    return [start for start in starts if start == 0 or frames - start >= _SHORTEST]


def _jumps(projected: np.ndarray, truth: np.ndarray, length: int) -> np.ndarray:
    """How much further joints step across each seam than in truth, cm: mean ‖Δp̂ - Δp‖."""
    seams = np.array(_starts(len(truth), length)[1:], dtype=int)
    gap = (projected - truth)[:, POSITIONS].reshape(len(truth), -1, 3)
    return 100 * np.linalg.norm(gap[seams] - gap[seams - 1], axis=-1).mean(axis=-1)
