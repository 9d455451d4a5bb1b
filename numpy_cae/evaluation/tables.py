"""The tables that `train` and `demo` print: half of all values removed, then repaired (holden2015,
section 7 and figure 1, left), and held-out clips reconstructed by jang2018's network.

Each value of the normalised windows of test takes is set to zero, the value of the mean pose, with
probability 1/2. No method is given padded frames. The zeros show which values were removed. The
first methods are given the zeros as they are, as in the paper; the last ones, whose rows begin with
"mask:", are given which values are missing.

jang2018's network is compared with PCA of whole clips with as many numbers as z has, the mean pose,
and the first frame held. Errors are mean squares of standardised numbers (the mean pose has about
1) and jang2018's own, the Euclidean distance of a frame's 51 angles in radians.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.interpolate import pchip_interpolate

from numpy_cae.evaluation import angle_distance, position_error
from numpy_cae.evaluation.baselines import RIDGE, Gaussian, apply_linear_map, fit_gaussian
from numpy_cae.evaluation.pose_dynamics import PoseDynamics
from numpy_cae.manifold import MotionManifold, SequenceManifold
from numpy_cae.manifold.completion import interpolate_gaps, zeroed_fraction
from numpy_cae.manifold.pca import PCA
from numpy_cae.motion import POSITIONS, AngleSequence, cut_clips, cut_windows, joint_slice
from numpy_cae.motion.gaussian_process import fit_curves
from numpy_cae.training import zero_values


@dataclass(frozen=True)
class Table:
    """Plain values with a heading for each column; the first value of a row is its name.

    A value that is None or nan is an empty cell; a str or an int is printed as it is. `formats`
    are of the floats: one format for all columns, or one for each.

    Examples
    --------
    >>> print(Table("Errors:", ["method", "cm"], [["network", 1.3], ["PCA", 2.06]]).text())
    Errors:
    <BLANKLINE>
    | method  |   cm |
    |---------|-----:|
    | network | 1.30 |
    | PCA     | 2.06 |
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[object]]
    formats: str | Sequence[str] = ".2f"

    def text(self) -> str:
        """The caption and the table in Markdown's form, padded for a terminal: the first column is
        left-aligned, the others right-aligned."""
        formats = self.formats
        if isinstance(formats, str):
            formats = [formats] * len(self.header)
        columns: list[list[str]] = []
        for number_format, *values in zip(formats, self.header, *self.rows, strict=True):
            cells = [_format_cell(value, number_format) for value in values]
            width = max(map(len, cells))
            is_first = not columns
            heading, *padded = [
                f" {cell.ljust(width) if is_first else cell.rjust(width)} " for cell in cells
            ]
            rule = "-" * (width + 2) if is_first else "-" * (width + 1) + ":"
            columns.append([heading, rule, *padded])
        lines = ["|" + "|".join(row) + "|" for row in zip(*columns, strict=True)]
        if self.caption:
            lines = [self.caption, "", *lines]
        return "\n".join(lines)

    def value(self, row: str, column: str) -> object:
        """The value in the row of that name, the column of that heading."""
        values = next(values for values in self.rows if values[0] == row)
        return values[list(self.header).index(column)]


def _format_cell(value: object, number_format: str) -> str:
    if value is None:
        return ""
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else format(float(value), number_format)
    return str(value)


@dataclass(frozen=True, eq=False)
class Clips:
    """The true windows with which repaired windows are compared."""

    manifold: MotionManifold  # gives the mean skeleton and the scale
    x: np.ndarray  # X: normalised windows (N, T, 63); zero is the mean pose
    real: np.ndarray  # (N, T) bool: frames that count, not those that pad a short take
    take: np.ndarray  # (N,) number of the take of each window

    def __len__(self) -> int:
        return len(self.x)

    def error(self, x: np.ndarray, joint: str | None = None) -> float:
        """The `position_error` of windows, cm, over all joints or one."""
        gap = (x[self.real] - self.x[self.real]) / self.manifold.scale  # the mean pose cancels
        return position_error(gap, np.zeros(gap.shape[-1]), joint=joint)

    def squares_by_take(self, x: np.ndarray, joint: str | None = None) -> np.ndarray:
        """For each take the sum of the squared errors of its windows, cm², and their number: (K, 2)
        for K takes, of which `error` is the root mean square."""
        counted = POSITIONS if joint is None else joint_slice(joint)
        gap = ((x - self.x) / self.manifold.scale)[..., counted]
        squares = 1e4 * np.square(gap, dtype=np.float64).sum(axis=2)
        rows = []
        for number in np.unique(self.take):
            real = self.real[self.take == number]
            values = real.sum() * gap.shape[2]
            rows.append([squares[self.take == number][real].sum(), values])
        return np.array(rows)

    def pick_evenly(self, count: int) -> Clips:
        """At most `count` of the windows, evenly spaced."""
        chosen = np.linspace(0, len(self) - 1, min(count, len(self))).round().astype(int)
        return replace(self, x=self.x[chosen], real=self.real[chosen], take=self.take[chosen])


def clips_of(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> Clips:
    """Cut world positions (F, 20, 3) of takes into windows of the manifold's length.

    The windows overlap by half, whatever the overlap in training, so that two networks are measured
    on the same windows. A window of a take that is shorter is zero after the last frame that
    counts; frames that are no whole hidden frame do not count. ValueError if there are no takes.
    """
    if not takes:
        raise ValueError("there are no takes to cut into windows")
    length = manifold.window
    cut = [cut_windows(manifold.features(take)[0], length, length // 2) for take in takes]
    x = np.concatenate([manifold.normalise(windows) for windows, _ in cut])
    real = np.concatenate([real for _, real in cut])
    frames = np.maximum(real.sum(axis=1) // manifold.stride, 1) * manifold.stride
    real &= np.arange(length) < frames[:, None]
    x *= real[..., None]
    take = np.repeat(np.arange(len(cut)), [len(windows) for windows, _ in cut])
    return Clips(manifold, x, real, take)


def apply_to_real_frames(
    repair: Callable[..., np.ndarray], real: np.ndarray, *arrays: np.ndarray
) -> np.ndarray:
    """What `repair` makes of the frames of windows (N, T, C) that count; zero elsewhere.

    Windows of one length are repaired together. No method is given frames that pad a short take:
    they repeat a pose, and their values would count as known.
    """
    repaired = np.zeros_like(arrays[0])
    frames = real.sum(axis=1)
    for count in np.unique(frames):
        rows = frames == count
        repaired[rows, :count] = repair(*(array[rows, :count] for array in arrays))
    return repaired


P = 0.5
"""The probability with which a value is removed."""
FITTED = 2000
"""Baselines are fitted to at most this many windows, evenly spaced, to save memory and time."""
WITH_MASK = 16
"""`compare_repairs` measures methods that are given the mask on at most this many windows, evenly
spaced: completing a window takes most of a second."""
SIZES = (1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 63, 100, 150, 200, 300, 450, 700, 1000, None)
"""Numbers of axes of PCA, the last one all, of which the best is taken."""
MEAN = "the mean pose"
DAMAGED = "as damaged"
PRINCIPAL = "PCA on windows, input / (1 - p)"
LINEAR = "linear map of 15 frames"
NETWORK = "the network"
AVERAGED = "the network, averaged over shifts"
LINES = "mask: linear interpolation"
PCHIP = "mask: monotone cubic (PCHIP)"
SPLINE = "mask: limited cubic spline"
PROCESS = "mask: Gaussian process of each channel"
GAUSSIAN = "mask: Gaussian of 15 frames"
DYNAMICS = "mask: Kalman smoother of poses"
COMPLETED = "mask: completed by the manifold"
SIMPLE = (PRINCIPAL, LINEAR)
SIMPLE_WITH_MASK = (LINES, PCHIP, SPLINE, PROCESS, GAUSSIAN, DYNAMICS)
"""SIMPLE, SIMPLE_WITH_MASK: the opponents of the network, and of the completion."""
METHODS = (DAMAGED, MEAN, *SIMPLE, NETWORK, AVERAGED, *SIMPLE_WITH_MASK, COMPLETED)
NOTE = (
    "Errors are of the pose in the body's own frame, without path and heading. The share is "
    "what is left of the damage. PCA has the number of axes that is best for the repair of the "
    "test takes, which favours PCA. PCA, the linear map and the Gaussian are fitted to the "
    'training takes. Rows with "mask:" are given which values are missing, and are measured on at '
    f"most {WITH_MASK} windows."
)


def compare_repairs(
    manifold: MotionManifold,
    training: Sequence[np.ndarray],
    testing: Sequence[np.ndarray],
    seed: int = 0,
) -> Table:
    """Compare the network, also averaged over all shifts of its pooling grid, and the completion
    by the manifold with no repair, the mean pose and the baselines.

    Takes are world positions (F, 20, 3); baselines are fitted to those for training. The seed draws
    the values that are removed. `NOTE` says how the table is read.
    """
    fitted = clips_of(manifold, training)
    test = clips_of(manifold, testing)
    repairs = Repairs(manifold, fitted, ridge=RIDGE)
    damaged = zero_values(test.x, P, np.random.default_rng(seed))
    rows = _error_rows(test, damaged, repairs.apply_to_zeros(test, damaged, P))
    some = test.pick_evenly(WITH_MASK)
    damaged = zero_values(some.x, P, np.random.default_rng(seed))
    given_mask = repairs.apply_with_mask(some, damaged, (SPLINE, GAUSSIAN, COMPLETED))
    rows += _error_rows(some, damaged, given_mask)
    title = f"{len(testing)} test takes, {len(test)} windows, errors in cm:"
    return Table(title, ["method", "reconstruction", "half removed", "share"], rows)


def _error_rows(test: Clips, damaged: np.ndarray, repaired: Iterator[tuple]) -> list[list]:
    """For each method its name, its errors on undamaged and on damaged windows, and the latter
    divided by the error of the damage."""
    before = test.error(damaged)
    rows = []
    for name, of_undamaged, of_damaged in repaired:
        error = test.error(of_damaged)
        rows.append([name, test.error(of_undamaged), error, error / before])
    return rows


class Repairs:
    """The methods of the table, with baselines fitted to windows of training takes.

    The ridge of the Gaussian is chosen on training takes that are left out, or it is the one that
    is given, for takes of another source.
    """

    def __init__(self, manifold: MotionManifold, training: Clips, ridge: float | None = None):
        self.manifold = manifold
        fitted = training.pick_evenly(FITTED)
        self.pca = PCA.fit(fitted.x.reshape(len(fitted), -1))
        if ridge is None:
            self.gaussian = fit_gaussian(fitted.x, fitted.real, fitted.take)
        else:
            self.gaussian = Gaussian(fitted.x, fitted.real, ridge)
        takes = [x[real] for x, real in zip(fitted.x, fitted.real, strict=True)]
        self.dynamics = PoseDynamics(takes)

    def of(self, manifold: MotionManifold) -> Repairs:
        """The same baselines beside another manifold that learned from the same takes."""
        repairs = copy(self)
        repairs.manifold = manifold
        return repairs

    def apply(self, test: Clips, damaged: np.ndarray, p: float) -> Iterator[tuple]:
        """The name of each of `METHODS`, and what it makes of the undamaged windows and of the
        damaged ones, in which zeros, a share p of the values, are missing."""
        yield from self.apply_to_zeros(test, damaged, p)
        yield from self.apply_with_mask(test, damaged, tuple(self.methods_with_mask()))

    def apply_to_zeros(self, test: Clips, damaged: np.ndarray, p: float) -> Iterator[tuple]:
        """The methods of `apply` that are given the zeros as they are."""
        yield from self.apply_simply(test, damaged, p)
        yield from self.project(test, damaged)

    def apply_simply(self, test: Clips, damaged: np.ndarray, p: float) -> Iterator[tuple]:
        """The methods of `apply_to_zeros` without a network."""
        x = test.x
        yield DAMAGED, x, damaged
        yield MEAN, 0 * x, 0 * x
        divided = apply_to_real_frames(_divide, test.real, damaged)
        size = min(SIZES, key=lambda n: test.error(self.pca.project(divided, n)))
        yield PRINCIPAL, self.pca.project(x, size), self.pca.project(divided, size)
        a = self.gaussian.linear_map(p)
        yield LINEAR, apply_linear_map((1 - p) * x, a), apply_linear_map(damaged, a)

    def project(self, test: Clips, damaged: np.ndarray) -> Iterator[tuple]:
        """The methods of `apply_to_zeros` with the network."""
        x = test.x
        for name, average in ((NETWORK, False), (AVERAGED, True)):
            project = partial(self.manifold.project_windows, average_shifts=average)
            projected = apply_to_real_frames(project, test.real, x)
            yield name, projected, apply_to_real_frames(project, test.real, damaged)

    def apply_with_mask(
        self, test: Clips, damaged: np.ndarray, names: Sequence[str]
    ) -> Iterator[tuple]:
        """The methods of these names, which are given which values are missing: those that are
        zero."""
        known = damaged != 0
        methods = self.methods_with_mask()
        for name in names:
            completed = apply_to_real_frames(methods[name], test.real, damaged, known)
            yield name, test.x, completed

    def methods_with_mask(self) -> dict[str, Callable[..., np.ndarray]]:
        """The methods that are given windows (N, T, 63) and the mask of what is known."""
        return {
            LINES: partial(interpolate_columns, curve=np.interp),
            PCHIP: partial(interpolate_columns, curve=interpolate_pchip),
            SPLINE: interpolate_gaps,
            PROCESS: fit_processes,
            GAUSSIAN: self.gaussian.complete,
            DYNAMICS: self.dynamics.complete,
            COMPLETED: self.manifold.complete_windows,
        }


def fit_processes(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Windows (N, T, C) completed by the curves of `motion.gaussian_process`."""
    pairs = zip(x, known, strict=True)
    return np.stack([fit_curves(window, mask).values for window, mask in pairs])


def _divide(damaged: np.ndarray) -> np.ndarray:
    """Damaged windows, divided by the share of values that is left."""
    return damaged / (1 - zeroed_fraction(damaged))


def interpolate_columns(
    x: np.ndarray, known: np.ndarray, curve: Callable[..., np.ndarray]
) -> np.ndarray:
    """Interpolate windows (N, T, C) over time by curve(frames, known frames, known values), each
    column by itself; before the first and after the last known value this value is repeated, and a
    column without one is zero."""
    interpolated = np.zeros_like(x)
    frames = np.arange(x.shape[1])
    for window, column in np.argwhere(known.any(axis=1)):
        keys = np.flatnonzero(known[window, :, column])
        inside = frames.clip(keys[0], keys[-1])
        interpolated[window, :, column] = curve(inside, keys, x[window, keys, column])
    return interpolated


def interpolate_pchip(frames: np.ndarray, keys: np.ndarray, values: np.ndarray) -> np.ndarray:
    """PCHIP through known values at the frames `keys`, for `interpolate_columns`."""
    if len(keys) == 1:
        return values
    return pchip_interpolate(keys, values, frames)


BY_PCA = "PCA"
HELD = "the first frame held"
SQUARED = "mean square, standardised"
PCA_CLIPS = 1500
"""Training clips that PCA is fitted to."""
Takes = Sequence[AngleSequence]


def compare_reconstructions(
    name: str, manifold: SequenceManifold, training: Takes, testing: Takes, seed: int = 0
) -> Table:
    """Measure the manifold of an action on clips of test motions.

    The seed chooses the clips of the training motions that PCA is fitted to.
    """
    latent = manifold.network.latent
    x = manifold.normalise(cut_clips(testing, frames=manifold.frames))
    rng = np.random.default_rng(seed)
    fitted = manifold.random_clips(training, rng, PCA_CLIPS)
    reconstructions = {
        NETWORK: manifold.network.denoise(x),
        BY_PCA: PCA.fit(fitted.reshape(PCA_CLIPS, -1)).project(x, latent),
        MEAN: np.zeros_like(x),
        HELD: np.broadcast_to(x[:, :1], x.shape),
    }
    truth = manifold.denormalise(x)
    rows: list[list[object]] = []
    for method, x_hat in reconstructions.items():
        squared = float(np.mean((x_hat.astype(np.float64) - x) ** 2))
        distance = angle_distance(manifold.denormalise(x_hat), truth)
        rows.append([f"{name}: {method}", squared, distance])
    return Table("", [f"{latent} numbers a clip", SQUARED, "distance, rad"], rows, ".3f")
