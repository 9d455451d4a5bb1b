"""PCA on one kind of motion and on many: holden2015, section 2.

    python -m studies kinds_of_motion --data bandai --test '*_005.bvh' -m best.npz

"PCA is an effective approach for modelling the manifold of human gait, although it cannot handle
many different types of motion altogether." PCA is fitted to the training takes of all kinds, or to
those of each kind by itself, and projects the test takes, undamaged. A kind is a content of the
labels. PCA on frames has as many axes as the network has hidden values for each frame, so that both
write a motion in as many numbers. PCA on windows has at most as many axes as there are windows to
fit it to: with as many for one kind as for all, these are the fewest of a kind; beside the network
it has all of its axes, at most as many as a window has hidden values.

Two sentences on motion itself: "valid human motion only exists in a small subspace of this
representation" (section 1), here of PCA with a tenth of the dimensions; and 160 frames cover "the
period of most distinct human actions" (section 4), here the takes, each of which has one label.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.tables import Clips, apply_to_real_frames, clips_of
from numpy_cae.manifold import MotionManifold
from studies.shared.judging import all_of, mean_of, ratio_of_errors, root_mean_square
from studies.shared.material import LabelledTake, Material, testing_of
from studies.shared.result import Claim, Result, Table, combined

FRAMES = "PCA on frames"
WINDOWS = "PCA on windows"
ALL = "one for all kinds"
OWN = "one for each kind"
ALL_AXES = "one for all kinds, all axes"
NETWORK = "the network"
GAIT = "walk"
"""Kinds whose names have this word are gait."""
EFFECTIVE = 0.1**0.5
"""PCA is effective where a tenth of the squared error is left, which is this share of the error."""
SIZES = (1, 2, 3, 5, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512)
"""Numbers of axes of which the least effective one is looked for."""
SMALL = 0.1
"""A subspace is small if it has at most this share of the dimensions."""
SMALL_ERROR = 0.01**0.5
"""Motion lies in a subspace that leaves a hundredth of the squared error, this of the error."""
ACTION = 160
"""Frames that cover an action."""
Rows = Callable[[Clips], np.ndarray]
"""The rows of windows to which PCA is fitted."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Project the test takes by PCA of their kind and of all kinds, and by the network.

    Raises ValueError where no kind has takes for training and for testing. The seed is not used.
    """
    return judge(manifold, material, measure_motion(manifold, material))


def measure_motion(manifold: MotionManifold, material: Material) -> "MeasuredMotion":
    """Everything that needs no network: of the manifold only its features and its size."""
    used = material.labelled("kinds_of_motion")
    training = Kinds.of(
        used.training, clips_of(manifold, [take.positions for take in used.training])
    )
    testing = Kinds.of(used.testing, testing_of(manifold, used)[0])
    kinds = [kind for kind in testing.counts() if training.counts().get(kind, 0) > 1]
    if not kinds:
        raise ValueError("kinds_of_motion needs windows of one kind for training and for testing")
    training = training.pick(kinds)
    testing = testing.pick(kinds)
    hidden = manifold.network.encode(testing.clips.x[:1]).size
    gait = gait_of(kinds)
    by_pca = []
    for name, rows in {FRAMES: rows_of_frames, WINDOWS: rows_of_windows}.items():
        numbers = hidden
        fewest = min(training.counts().values()) - 1
        if name == FRAMES:
            numbers = min(hidden // manifold.window, testing.clips.x.shape[-1])
            fewest = numbers
        of_all = PCA.fit(rows(training.clips))
        of_gait = None
        if gait:
            of_gait = _gait(name, rows, training.pick(gait), testing.pick(gait), numbers)
        by_pca.append(
            MeasuredPCA(
                _project(name, rows, of_all, training, testing, numbers, fewest),
                of_gait,
                _subspace(name, of_all, testing),
            )
        )
    return MeasuredMotion(kinds, by_pca, _actions([*used.training, *used.testing]))


def judge(manifold: MotionManifold, material: Material, motion: "MeasuredMotion") -> Result:
    """What was measured of the motion of this material, beside the projection by the network."""
    used = material.labelled("kinds_of_motion")
    testing = Kinds.of(used.testing, testing_of(manifold, used)[0]).pick(motion.kinds)
    x = apply_to_real_frames(manifold.project_windows, testing.clips.real, testing.clips.x)
    gait = gait_of(motion.kinds)
    parts = []
    for by_pca in motion.by_pca:
        parts.append(_compare(by_pca.projection, testing.clips.squares_by_take(x)))
        if by_pca.gait:
            walks = testing.pick(gait).clips
            of_walks = x[np.isin(testing.kinds, gait)]
            parts.append(_compare_gait(by_pca.gait, walks.squares_by_take(of_walks)))
        parts.append(by_pca.subspace)
    return combined("PCA on one kind of motion and on many", [*parts, motion.actions])


@dataclass(frozen=True, eq=False)
class Projection:
    """The squared errors of the test takes by PCA, with as many axes as each kind has for itself,
    and with at most as many as the network has numbers."""

    name: str
    axes: int
    most: int
    numbers: int
    squares: dict[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class Gait:
    """The squared errors of the walks at their mean pose and by PCA of walks, with most axes, and
    the fewest axes that are enough."""

    name: str
    most: int
    least: int | None
    squares: np.ndarray
    at_mean: np.ndarray


@dataclass(frozen=True)
class MeasuredPCA:
    """What was measured with PCA on frames or on windows; without walks there is no gait."""

    projection: Projection
    gait: Gait | None
    subspace: Result


@dataclass(frozen=True)
class MeasuredMotion:
    """What was measured without a network, of these kinds."""

    kinds: list[str]
    by_pca: list[MeasuredPCA]
    actions: Result


@dataclass(frozen=True, eq=False)
class Kinds:
    """Windows and the kind of each."""

    clips: Clips
    kinds: np.ndarray  # (N,) of str

    @classmethod
    def of(cls, takes: Sequence[LabelledTake], clips: Clips) -> "Kinds":
        """The windows of labelled takes."""
        return cls(clips, np.array([takes[number].content for number in clips.take]))

    def pick(self, kinds: Sequence[str]) -> "Kinds":
        """The windows of these kinds."""
        chosen = np.isin(self.kinds, kinds)
        clips = self.clips
        picked = replace(clips, x=clips.x[chosen], real=clips.real[chosen], take=clips.take[chosen])
        return Kinds(picked, self.kinds[chosen])

    def counts(self) -> dict[str, int]:
        """Kind to the number of its windows."""
        names, counts = np.unique(self.kinds, return_counts=True)
        return {str(name): int(count) for name, count in zip(names, counts, strict=True)}


def gait_of(kinds: Sequence[str]) -> list[str]:
    """The kinds that are gait."""
    return [kind for kind in kinds if GAIT in kind]


def rows_of_frames(clips: Clips) -> np.ndarray:
    """The frames that count, (M, 63)."""
    return clips.x[clips.real]


def rows_of_windows(clips: Clips) -> np.ndarray:
    """The windows as rows of all their numbers."""
    return clips.x.reshape(len(clips), -1)


def _project(
    name: str,
    rows: Rows,
    of_all: PCA,
    training: Kinds,
    testing: Kinds,
    numbers: int,
    fewest: int,
) -> Projection:
    """PCA of all kinds, with as many axes as each kind has for itself, and with at most as many
    numbers as the network has."""
    axes = min(numbers, max(fewest, 1))
    projected = {
        ALL: of_all.project(testing.clips.x, axes),
        OWN: _project_by_kind(rows, training, testing, axes),
        ALL_AXES: of_all.project(testing.clips.x, numbers),
    }
    squares = {of: testing.clips.squares_by_take(x) for of, x in projected.items()}
    return Projection(name, axes, min(numbers, len(of_all.axes)), numbers, squares)


def _compare(by_pca: Projection, by_network: np.ndarray) -> Result:
    """PCA of all kinds beside PCA of each kind and beside the network."""
    squares = by_pca.squares | {NETWORK: by_network}
    axes, most = by_pca.axes, by_pca.most
    table_rows: list[list[object]] = []
    for of, used in {ALL: axes, OWN: axes, ALL_AXES: most, NETWORK: by_pca.numbers}.items():
        label = of if of == NETWORK else f"{by_pca.name}, {of}"
        table_rows.append([label, used, root_mean_square(squares[of])])
    to_own = ratio_of_errors(squares[ALL], squares[OWN])
    to_network = ratio_of_errors(squares[ALL_AXES], squares[NETWORK])
    errors = {of: f"{root_mean_square(of_takes):.2f} cm" for of, of_takes in squares.items()}
    claim = Claim(
        "pca_many_types",
        all_of(to_own.above(1), to_network.above(1)),
        f"{axes} axes {errors[ALL]}, {to_own:.2f} of the error with one for each kind; {most} axes "
        f"{errors[ALL_AXES]}, {to_network:.2f} of the network's;",
        by_pca.name,
        f"one for each kind {errors[OWN]}; the network, {by_pca.numbers} numbers, "
        f"{errors[NETWORK]}.",
    )
    header = ["projection of all kinds", "numbers", "error, cm"]
    return Result("", [Table("", header, table_rows)], [claim])


def _gait(name: str, rows: Rows, training: Kinds, testing: Kinds, numbers: int) -> Gait:
    """PCA of walks, and their mean pose."""
    fitted = PCA.fit(rows(training.clips))
    mean_pose = rows_of_frames(training.clips).mean(axis=0)
    at_mean = testing.clips.squares_by_take(np.broadcast_to(mean_pose, testing.clips.x.shape))

    def squares_of(size: int) -> np.ndarray:
        return testing.clips.squares_by_take(fitted.project(testing.clips.x, size))

    most = min(numbers, len(fitted.axes))
    least = None
    for size in SIZES:
        if size > most:
            break
        if root_mean_square(squares_of(size)) <= EFFECTIVE * root_mean_square(at_mean):
            least = size
            break
    return Gait(name, most, least, squares_of(most), at_mean)


def _compare_gait(gait: Gait, by_network: np.ndarray) -> Result:
    """What PCA of walks, and the network, leave of the error of their mean pose."""
    left = ratio_of_errors(gait.squares, gait.at_mean)
    left_by_network = ratio_of_errors(by_network, gait.at_mean)
    enough = f"{gait.least} axes are enough" if gait.least else "no number of axes is enough"
    claim = Claim(
        "pca_gait",
        left.at_most(EFFECTIVE),
        f"{left:.3f} of the error of the mean pose is left with {gait.most} axes, {enough};",
        gait.name,
        f"the network {left_by_network:.3f}.",
    )
    row = [f"{gait.name} of walks", gait.most, root_mean_square(gait.squares)]
    at = ["mean pose of walks", 0, root_mean_square(gait.at_mean)]
    header = ["projection of walks", "numbers", "error, cm"]
    return Result("", [Table("", header, [row, at])], [claim])


def _subspace(name: str, fitted: PCA, testing: Kinds) -> Result:
    """What a tenth of the dimensions, as principal components, leaves of the error."""
    dimensions = len(fitted.mean)
    axes = min(max(int(SMALL * dimensions), 1), len(fitted.axes))
    x = testing.clips.x
    of_axes = testing.clips.squares_by_take(fitted.project(x, axes))
    left = ratio_of_errors(of_axes, testing.clips.squares_by_take(np.zeros_like(x)))
    figures = f"{axes} of {dimensions} dimensions leave {left:.3f} of the error."
    claim = Claim("small_subspace", left.at_most(SMALL_ERROR), figures, name)
    table_rows = [[name, axes, dimensions, left.value]]
    header = ["principal components", "axes", "dimensions", "error left"]
    return Result("", [Table("", header, table_rows, ".3f")], [claim])


def _actions(takes: Sequence[LabelledTake]) -> Result:
    """The share of the takes that last at most `ACTION` frames."""
    frames = np.array([len(take.positions) for take in takes])
    share = mean_of(frames <= ACTION)
    low, middle, high = np.percentile(frames, (25, 50, 75))
    figures = f"{share:.0%} of {len(frames)} takes; they last {middle:.0f} frames in the median."
    claim = Claim("window_covers_actions", share.above(0.5), figures)
    header = ["frames of a take", "quartile", "median", "quartile"]
    table = Table("", header, [[f"{len(frames)} takes", low, middle, high]], ".0f")
    return Result("", [table], [claim])


def _project_by_kind(rows: Rows, training: Kinds, testing: Kinds, axes: int) -> np.ndarray:
    """The test windows, each projected by PCA of its kind."""
    projected = np.zeros_like(testing.clips.x)
    for kind in testing.counts():
        of_kind = PCA.fit(rows(training.pick([kind]).clips))
        chosen = testing.kinds == kind
        projected[chosen] = of_kind.project(testing.clips.x[chosen], axes)
    return projected
