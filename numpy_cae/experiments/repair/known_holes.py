"""Holes that are known to be holes: projection that looks at what was observed alone, beside what
interpolation, PCA and plain projection make of them; and from which length of a gap on it pays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.baselines import PCA, interpolate_linearly
from numpy_cae.beyond import poses_of, project_observed
from numpy_cae.beyond.observed import started
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material, evenly
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import FEATURES, POSITIONS, cut_windows, joint_slice
from numpy_cae.viz import Curve, curves_figure, save_figure

TAKES = 6
FRAMES = 160
GAPS = (5, 15, 30, 45, 90)
EVERY = 15
JOINT = "left_wrist"
SIZES = (20, 63, 200)
LINE, PCA_FRAMES, PCA_WINDOWS = "linear interpolation", "PCA on frames", "PCA on windows"
PCA_JOINED = "PCA on frames, joined"
PLAIN, ALONE = "plain projection", "of the observed"
KNOWING = "of the observed, from PCA"
METHODS = (LINE, PCA_FRAMES, PCA_WINDOWS, PCA_JOINED, PLAIN, ALONE, KNOWING)
Fill = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class KnownHoles:
    """Root mean square error of the missing coordinates, cm: hole -> method -> error."""

    errors: dict[str, dict[str, float]]
    gaps: dict[str, dict[int, dict[str, float]]]
    clips: int
    title: str = "Projection that knows what is missing"

    def text(self) -> str:
        """One line a hole."""
        lines = [
            [hole, *(f"{errors[method]:.2f}" for method in METHODS)]
            for hole, errors in self.errors.items()
        ]
        return (
            f"Error of the missing coordinates in cm, {self.clips} test clips of {FRAMES} frames "
            "at most; all methods but plain projection are told where the holes are; PCA has the "
            "best size for each line, chosen on the test clips themselves, which favours it. The "
            "last column starts from PCA on frames, joined to what is known around, where a "
            "part of the body is known throughout; elsewhere that is a line."
            f"\n\n{text_table(['missing', *METHODS], lines)}"
        )

    def findings(self) -> list[Finding]:
        """Where it beats everything, and from which gap on."""
        found = []
        for what, by_length in self.gaps.items():
            wins = [g for g, e in by_length.items() if e[KNOWING] < min(_others(e))]
            long = [g for g in by_length if g > 30]
            found.append(
                Finding(
                    f"Projection that knows what is missing beats linear interpolation, PCA with "
                    f"missing data and plain projection in gaps of over a second ({what}).",
                    all(g in wins for g in long),
                    f"best of all in gaps of {', '.join(map(str, wins)) or 'no'} frames; at "
                    f"{long[0]} frames "
                    + ", ".join(f"{m} {by_length[long[0]][m]:.2f}" for m in METHODS)
                    + " cm.",
                )
            )
        keys = self.errors[_stepped()]
        found.append(
            Finding(
                f"It beats them where every {EVERY}th frame is kept.",
                keys[KNOWING] < min(_others(keys)),
                ", ".join(f"{method} {keys[method]:.2f}" for method in METHODS) + " cm.",
            )
        )
        return found

    def save_picture(self, path: str | Path) -> None:
        """Error by length of the gap, of one joint."""
        what, by_length = next(iter(self.gaps.items()))
        curves = [
            Curve(list(by_length), [errors[method] for errors in by_length.values()], method)
            for method in METHODS
        ]
        save_figure(curves_figure(curves, f"gap, frames, {what}", "error, cm"), path)


def _others(errors: dict[str, float]) -> list[float]:
    return [error for method, error in errors.items() if method not in (ALONE, KNOWING)]


def _stepped() -> str:
    return f"all but every {EVERY}th frame"


def known_holes(manifold: MotionManifold, material: Material, seed: int = 0) -> KnownHoles:
    """Cut holes into test clips and have every method fill them.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        PCA is fitted to its training half.
    seed : int
        Of nothing: holes are in the middle of clips.
    """
    takes = [take for take in material.testing if len(take.positions) >= max(GAPS) + 30]
    clips = [manifold.features(t.positions[:FRAMES])[0] for t in evenly(takes, TAKES)]
    if not clips:
        raise ValueError(f"no test take is as long as {max(GAPS) + 30} frames")
    fillers = _fillers(manifold, material)

    def measured(known_of: Callable[[int], np.ndarray]) -> dict[str, float]:
        return {name: _best(options, clips, known_of) for name, options in fillers.items()}

    gaps = {
        f"{JOINT} missing": {g: measured(lambda n, g=g: _gap(n, g, JOINT)) for g in GAPS},
        "the whole body missing": {g: measured(lambda n, g=g: _gap(n, g)) for g in GAPS},
    }
    errors = {
        f"{what}, {g} frames": e for what, by_length in gaps.items() for g, e in by_length.items()
    }
    errors[f"{JOINT} missing throughout"] = measured(lambda n: _gap(n, n, JOINT))
    errors[_stepped()] = measured(_keys)
    return KnownHoles(errors, gaps, len(clips))


def _gap(frames: int, gap: int, joint: str | None = None) -> np.ndarray:
    known = np.ones((frames, FEATURES), bool)
    first = (frames - gap) // 2
    known[first : first + gap, joint_slice(joint) if joint else slice(None)] = False
    return known


def _keys(frames: int) -> np.ndarray:
    known = np.zeros((frames, FEATURES), bool)
    known[::EVERY] = True
    return known


def _best(options: list[Fill], clips: list[np.ndarray], known_of) -> float:
    """The error of the option that is best on all clips together."""

    def error(fill: Fill) -> float:
        squares = []
        for clip in clips:
            known = known_of(len(clip))
            gap = (fill(clip, known) - clip)[:, POSITIONS]
            squares.append(np.mean(np.square(gap[~known[:, POSITIONS]])))
        return float(100 * np.sqrt(np.mean(squares)))

    return min(error(fill) for fill in options)


def _fillers(manifold: MotionManifold, material: Material) -> dict[str, list[Fill]]:
    training = [manifold.features(take.positions)[0] for take in evenly(material.training, 300)]
    pca_frames = poses_of(manifold, training)

    def line(clip: np.ndarray, known: np.ndarray) -> np.ndarray:
        return interpolate_linearly(np.where(known, clip, manifold.mean_pose), known)

    def plain(clip: np.ndarray, known: np.ndarray) -> np.ndarray:
        return manifold.project(np.where(known, clip, manifold.mean_pose))

    def by_pca(pca: PCA, size: int) -> Fill:
        def fill(clip: np.ndarray, known: np.ndarray) -> np.ndarray:
            numbers = len(pca.mean)
            length = max(len(clip), numbers // FEATURES)
            more = ((0, length - len(clip)), (0, 0))
            rows = np.pad(manifold.normalise(clip), more).reshape(-1, numbers)
            seen = np.pad(known, more).reshape(-1, numbers)
            filled = pca.fill(rows.astype(np.float64), seen, size)
            return manifold.denormalise(filled.reshape(length, FEATURES)[: len(clip)])

        return fill

    windows = manifold.normalise(
        np.concatenate([cut_windows(f, FRAMES, FRAMES // 2)[0] for f in training])
    )
    pca_windows = PCA.fit(windows.reshape(len(windows), -1).astype(np.float64)[:600])
    return {
        LINE: [line],
        PCA_FRAMES: [by_pca(pca_frames, size) for size in SIZES if size <= FEATURES],
        PCA_WINDOWS: [by_pca(pca_windows, size) for size in SIZES],
        PCA_JOINED: [lambda clip, known: started(manifold, clip, known, pca_frames)[0]],
        PLAIN: [plain],
        ALONE: [lambda clip, known: project_observed(manifold, clip, known)],
        KNOWING: [lambda clip, known: project_observed(manifold, clip, known, poses=pca_frames)],
    }
