"""Holes at known places: projection of the observed values alone, compared with interpolation, PCA
and plain projection, for gaps of several lengths."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae.baselines import PCA, interpolate_linearly
from numpy_cae.beyond import pose_pca, project_observed
from numpy_cae.beyond.observed import initial_fill
from numpy_cae.experiments.material import Material, evenly
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import FEATURES, POSITIONS, cut_windows, joint_slice
from numpy_cae.viz import Curve, curves_figure

TAKES, TRAINING_TAKES, TRAINING_WINDOWS = 6, 300, 600
FRAMES = 160
GAPS = (5, 15, 30, 45, 90)
LONG_GAP = 30
EVERY = 15
JOINT = "left_wrist"
SIZES = (20, 63, 200)
LINE, PCA_FRAMES, PCA_WINDOWS = "linear interpolation", "PCA on frames", "PCA on windows"
PCA_JOINED, PLAIN = "PCA on frames, joined", "plain projection"
OBSERVED, OBSERVED_FROM_PCA = "of the observed", "of the observed, from PCA"
METHODS = (LINE, PCA_FRAMES, PCA_WINDOWS, PCA_JOINED, PLAIN, OBSERVED, OBSERVED_FROM_PCA)
KEYS = f"all but every {EVERY}th frame"
CAPTION = (
    "Error of the missing coordinates in cm, {} test clips of at most {} frames. All methods but "
    "plain projection know where the holes are. PCA has its best size for each line, chosen on the "
    "test clips themselves, which favours it. The last column starts from PCA on frames, joined to "
    "the known frames around, where a part of the body is known throughout, else from a line."
)
Fill = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From a clip and which of its values are known, both (F, 63), to the filled clip."""
Errors = dict[str, float]


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Make holes in the middle of test clips and fill them with every method."""
    takes = [take for take in material.testing if len(take.positions) >= max(GAPS) + 30]
    clips = [manifold.features(take.positions[:FRAMES])[0] for take in evenly(takes, TAKES)]
    if not clips:
        raise ValueError(f"no test take is as long as {max(GAPS) + 30} frames")
    methods = _methods(manifold, material)

    def measured(known_of: Callable[[int], np.ndarray]) -> Errors:
        return {name: _best(options, clips, known_of) for name, options in methods.items()}

    gaps = {
        f"{JOINT} missing": {g: measured(lambda n, g=g: _gap(n, g, JOINT)) for g in GAPS},
        "the whole body missing": {g: measured(lambda n, g=g: _gap(n, g)) for g in GAPS},
    }
    errors = {f"{what}, {g} frames": each for what, by in gaps.items() for g, each in by.items()}
    errors[f"{JOINT} missing throughout"] = measured(lambda n: _gap(n, n, JOINT))
    errors[KEYS] = measured(_keys)
    rows = [[hole, *(each[method] for method in METHODS)] for hole, each in errors.items()]
    what, by_length = next(iter(gaps.items()))

    def figure():
        curves = [
            Curve(list(by_length), [each[method] for each in by_length.values()], method)
            for method in METHODS
        ]
        return curves_figure(curves, f"gap, frames, {what}", "error, cm")

    return Result(
        "Projection of the observed values",
        [Table(CAPTION.format(len(clips), FRAMES), ["missing", *METHODS], rows)],
        [*(_gap_claim(what, by) for what, by in gaps.items()), _keys_claim(errors[KEYS])],
        figure,
    )


def _gap_claim(what: str, by_length: dict[int, Errors]) -> Claim:
    best = [gap for gap, errors in by_length.items() if _is_best(errors)]
    long = [gap for gap in by_length if gap > LONG_GAP]
    return Claim(
        "Projection of the observed values beats linear interpolation, PCA with missing data and "
        f"plain projection in gaps of over a second ({what}; not in the paper).",
        all(gap in best for gap in long),
        f"best of all in gaps of {', '.join(map(str, best)) or 'no'} frames; at {long[0]} frames "
        f"{_listed(by_length[long[0]])} cm.",
    )


def _keys_claim(errors: Errors) -> Claim:
    sentence = f"It beats them where every {EVERY}th frame is kept (not in the paper)."
    return Claim(sentence, _is_best(errors), f"{_listed(errors)} cm.")


def _is_best(errors: Errors) -> bool:
    own = (OBSERVED, OBSERVED_FROM_PCA)
    others = [error for method, error in errors.items() if method not in own]
    return errors[OBSERVED_FROM_PCA] < min(others)


def _listed(errors: Errors) -> str:
    return ", ".join(f"{method} {errors[method]:.2f}" for method in METHODS)


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


def _methods(manifold: MotionManifold, material: Material) -> dict[str, list[Fill]]:
    """The methods, each with its options."""
    takes = evenly(material.training, TRAINING_TAKES)
    training = [manifold.features(take.positions)[0] for take in takes]
    pca_frames = pose_pca(manifold, training)
    windows = np.concatenate([cut_windows(x, FRAMES, FRAMES // 2)[0] for x in training])
    rows = manifold.normalise(windows).reshape(len(windows), -1).astype(np.float64)
    pca_windows = PCA.fit(rows[:TRAINING_WINDOWS])

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

    return {
        LINE: [line],
        PCA_FRAMES: [by_pca(pca_frames, size) for size in SIZES if size <= FEATURES],
        PCA_WINDOWS: [by_pca(pca_windows, size) for size in SIZES],
        PCA_JOINED: [lambda clip, known: initial_fill(manifold, clip, known, pca_frames)[0]],
        PLAIN: [plain],
        OBSERVED: [lambda clip, known: project_observed(manifold, clip, known)],
        OBSERVED_FROM_PCA: [
            lambda clip, known: project_observed(manifold, clip, known, poses=pca_frames)
        ],
    }
