"""The representation of holden2015, sections 3 to 6, and what section 7 says that it cannot do.

    python -m studies representation --data bandai --test '*_005.bvh' -m best.npz

Sizes and bounds of the hidden units; the path that is integrated from the velocities; the bones and
the standing feet of a projection, which "cannot guarantee constraints such as ground contact and
joint lengths"; whether max pooling "provides a level of temporal invariance"; and the time of a
projection. A projection under constraints is future work in section 7: here it is fitted by
rotations of bones of the manifold's lengths, and its feet are mended as `repair --feet` mends them.

Random and even unpooling of the same hidden units (section 5): random unpooling "results in some
noise in the produced animation", even unpooling "does result in smooth animation with no high
frequency noise". Random unpooling is said to be "a good approximation for the inverse of max
pooling process", even unpooling "not an accurate approximation". Two senses of an inverse are
measured in each layer: the values before pooling, which are pooled and unpooled, and the pooled
values, which are unpooled and pooled again. The share of the squared values that is left as error
is 1 for zeros.

Section 5 says of the tanh that it clips the input "to the subspace" and allows "to construct a
non-linear manifold": windows are stretched about the mean pose, and the mean of the hidden units of
two windows is decoded.

What the filters express (section 6, "Once training is complete …"): one unit of a layer is raised
at one moment from its mean to its 99th percentile in test windows; the layers below decode the
difference. A filter moves the joints and lasts the frames that have together nine tenths of the
energy of this response. A filter of a deeper layer combines the filters of the layer below that
have together nine tenths of the energy of its weights, each weight times the deviation of its unit.
Untrained networks are measured beside it, and the principal components of 15 frames, which are
uncorrelated in the frames that they are fitted to.
"""

from collections.abc import Callable
from dataclasses import astuple, dataclass
from functools import partial
from time import process_time
from timeit import repeat
from typing import NamedTuple

import numpy as np

from numpy_cae import ops
from numpy_cae.cleanup.feet import find_feet, mend_feet
from numpy_cae.cleanup.view import View
from numpy_cae.evaluation import PCA, jitter, position_error
from numpy_cae.evaluation.baselines import Gaussian, gather_context
from numpy_cae.evaluation.tables import Clips, clips_of
from numpy_cae.manifold import MotionManifold, hidden_units
from numpy_cae.mocap import body_positions
from numpy_cae.motion import JOINTS, POSITIONS, features_to_positions
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.motion.features import bone_lengths, change_lengths
from numpy_cae.motion.fit import fit_motion
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.comparison import untrained
from studies.shared.judging import Interval, all_of, ratio_of_errors, ratio_of_means
from studies.shared.material import Material, evenly, features_of, testing_of
from studies.shared.result import Claim, Result, Table, combined, moving
from studies.shared.validity import Validity, ValidityMeasure

SIZES = [(80, 64), (40, 128), (20, 256)]
"""Frames and units of each layer for a window of 160 frames (section 5 and figure 3)."""
INTEGRATED = 0.01
"""A path is recovered if no joint is farther than this from its place (cm)."""
MOST_OFF = 0.01
"""Bones keep their lengths if they are off by at most this (cm)."""
WINDOWS = 64
"""So many test windows are projected together where a projection is timed, and give the
range of the hidden units."""
TRUE = "truth"
EVEN = "even unpooling"
RANDOM = "random unpooling"
REPEATED = "the value on both frames"
BEFORE = "values before pooling"
AGAIN = "pooled values, pooled again"
GOOD = 0.1
"""An inverse is a good approximation if at most this share of the squared values is left."""
COLOURS = {TRUE: TRUTH, EVEN: PROJECTED, RANDOM: CORRUPTED}
UNTURNED = 1e-4
"""Features of a turned take may differ by at most this."""
PIECE = 80
"""Frames of the pieces in which takes are projected beside windows and wholes."""
VARIABLE = 1.1
"""The length of a window is variable if the error grows at most so much."""
STRETCHED = 3.0
"""So many times the deviations from the mean pose are projected."""
CLIPPED = 2.0
"""They are clipped if their projection is at most so many times as far from training poses."""
STRETCHED_WINDOWS = 12
EVERY = 4
"""The nearest pose is looked for in every so-many-th frame: it is far away, so a search takes a
tenth of a millisecond."""
STRETCHED_TAKES = 60
"""At most so many training takes, which have the nearest poses."""
NON_LINEAR = 0.1
"""A manifold is not linear if a decoded mean is farther from the mean of decodings than this share
of their distance."""
TAKES = 24
"""At most this many test takes are measured for their bones and feet."""
NOISY = 2.0
"""Unpooling is noisy if the jitter is more than this many times the truth's."""
SMOOTH = 1.5
"""Unpooling is smooth if the jitter is less than this many times the truth's."""
SECOND = 30
"""Frames in a second."""
ENERGY = 0.9
"""The share of a response's energy in its joints and its frames."""
AXES = 200
"""Axes of the projection by PCA that is timed."""
REPETITIONS = 20
"""So often a projection is timed."""
SEVERAL = 2
"""A filter combines several filters of the layer below if it combines at least so many."""
UNTRAINED = 3
"""Untrained networks beside which the filters are measured."""
MAXIMUM = "the maximum of each pair"
MEAN = "the mean of each pair"
EVERY_SECOND = "every second frame"
TRUE_TAKES = "test takes"
PROJECTED_TAKES = "projected"
AVERAGED = "averaged over shifts"
CONSTRAINED = "constant bones, mended feet"
COMPONENTS = "principal components of 15 frames"
TRAINED = "the network"
INITIAL = "an untrained network"
PRINCIPAL = "PCA on frames"
SILENT = 1e-8
"""A filter whose response has less energy than this moves nothing, and is left out."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure the test takes and their projections, both unpoolings of their hidden units, and the
    filters. The seed is for the masks of unpooling and for the untrained network."""
    testing, sample = testing_of(manifold, material)
    takes = features_of(manifold, material.testing)
    turned = max(_change_by_turning(manifold, take.positions) for take in material.testing)
    off = max(_error_of_path(manifold, take.positions) for take in material.testing)
    parts = [
        units(manifold, takes, testing, off, seed),
        Result("", [], [_claim_of_lengths(manifold, takes), _claim_of_heading(turned)]),
        constraints(manifold, evenly(takes, TAKES)),
        unpoolings(manifold, testing, seed),
        inverses(manifold, testing, seed),
        non_linearity(manifold, material, testing, seed),
        filters(manifold, material, testing.pick_evenly(WINDOWS), seed),
    ]
    return combined("The representation and its limits", parts, sample)


def units(
    manifold: MotionManifold, takes: list[np.ndarray], testing: Clips, off: float, seed: int
) -> Result:
    """The hidden units of the test takes, features (F, 63), and the time of a projection; `off` is
    the largest error of an integrated path, cm."""
    network = manifold.network
    largest = max(float(np.abs(hidden_units(manifold, take)).max()) for take in takes)
    window = np.zeros((1, 160, 63), np.float32)
    sizes = [network.encode(window, layers=n + 1).shape[1:] for n in range(len(network.layers))]
    seconds = [frames / manifold.rate for frames in receptive_frames(manifold)]
    listed = ", ".join(f"{second:.2f}" for second in seconds)
    claims = [
        Claim("units_bounded", largest <= 1, f"the largest of all is {largest:.3f}."),
        Claim("sizes", sizes == SIZES, f"{', '.join(f'{t} x {k}' for t, k in sizes)}."),
        Claim(
            "receptive_fields",
            0.4 <= seconds[0] <= 0.6 and seconds[-1] >= 2,
            f"a unit of each layer depends on {listed} s.",
        ),
        Claim("path_integrated", off < INTEGRATED, f"at most {off:.1e} cm off."),
        _claim_of_pooling(manifold, untrained(manifold, seed), takes),
        _claim_of_time(manifold, testing.x[:WINDOWS]),
    ]
    return Result("", [], claims)


def receptive_frames(manifold: MotionManifold) -> list[int]:
    """The frames of motion on which a unit of each layer depends."""
    frames = []
    span = 1
    for number, layer in enumerate(manifold.network.layers):
        stride = 2**number
        span += (len(layer.w) - 1) * stride + stride  # the convolution, then a pair
        frames.append(span)
    return frames


def _claim_of_pooling(
    manifold: MotionManifold, initial: MotionManifold, takes: list[np.ndarray]
) -> Claim:
    """Whether the maximum of a pair of frames changes less by a delay than every second frame."""
    changes = _changes(manifold, takes)
    changes_untrained = _changes(initial, takes)
    of_every_second = changes[EVERY_SECOND]
    maximum = ratio_of_means(changes[MAXIMUM], of_every_second)
    mean = ratio_of_means(changes[MEAN], of_every_second)
    without = ratio_of_means(changes_untrained[MAXIMUM], changes_untrained[EVERY_SECOND])
    also = []
    if mean.below(1):
        also.append("the mean of each pair")
    if without.below(1):
        also.append("an untrained network")
    return Claim(
        "pooling_invariant",
        maximum.below(1),
        f"units of layer 1 change by {np.mean(changes[MAXIMUM]):.3f} of their deviation, "
        f"{maximum:.3f} of the change without the maximum;",
        opponent=f"the mean of each pair {mean:.3f}, untrained with the maximum {without:.3f}.",
        fulfilled_by=" and ".join(also),
    )


def _claim_of_time(manifold: MotionManifold, x: np.ndarray) -> Claim:
    """Whether a projection takes less than a millisecond of processor time for each window."""
    axes = np.ones((x[0].size, AXES), np.float32)
    rows = x.reshape(len(x), -1)
    ours = _milliseconds(lambda: manifold.network.project(x), len(x))
    linear = _milliseconds(lambda: rows @ axes @ axes.T, len(x))
    return Claim(
        "projected_fast",
        ours.at_most(1.0),
        f"{ours:.2f} ms of processor time a window, {len(x)} together;",
        opponent=f"PCA on windows with {AXES} axes {linear:.3f} ms.",
        fulfilled_by="PCA on windows" if linear.at_most(1.0) else "",
    )


def _milliseconds(work: Callable[[], object], windows: int) -> Interval:
    """Milliseconds of processor time for a window: the median of repetitions, and the quartiles.
    The first repetition, which makes buffers, is left out."""
    seconds = repeat(work, timer=process_time, number=1, repeat=REPETITIONS + 1)[1:]
    low, middle, high = 1e3 / windows * np.percentile(seconds, (25, 50, 75))
    return Interval(float(middle), float(low), float(high))


def constraints(manifold: MotionManifold, takes: list[np.ndarray]) -> Result:
    """Bones and feet of the takes, of their projections, and of these under constraints.

    The constraints are those of the projection that is averaged over shifts, since the other one
    trembles. Standing feet are those that stand in it: the truth is unknown where a motion has to
    be repaired.
    """
    measure = ValidityMeasure(takes, manifold.lengths, manifold.rate)
    averaged = [manifold.project(take, average_shifts=True) for take in takes]
    stands = [find_contacts(features_to_positions(x), manifold.rate) for x in averaged]
    kinds_of_motion = {
        TRUE_TAKES: takes,
        PROJECTED_TAKES: [manifold.project(take) for take in takes],
        AVERAGED: averaged,
        CONSTRAINED: [_constrain(manifold, x) for x in averaged],
    }
    rows = []
    measured = {}
    for name, clips in kinds_of_motion.items():
        errors = [position_error(*pair) for pair in zip(clips, takes, strict=True)]
        slides = [manifold.rate * _sliding(*pair) for pair in zip(clips, stands, strict=True)]
        of_clips = measure.each(clips)
        validity = Validity.mean(of_clips)
        rows.append([name, np.mean(errors), np.mean(slides), *astuple(validity)])
        measured[name] = Constrained(np.array(errors), np.array(slides), of_clips)
    header = ["motion", "position, cm", "standing feet, cm/s", *Validity.HEADER]
    table = Table("", header, rows, ("", ".2f", ".1f", *Validity.FORMATS[1:]))
    claims = [
        _claim_of_no_guarantee(measured[TRUE_TAKES], measured[PROJECTED_TAKES]),
        _claim_of_constraints(measured[AVERAGED], measured[CONSTRAINED]),
    ]
    return Result("", [table], claims)


class Constrained(NamedTuple):
    """The measures of motions, a number for each: the error of the position, cm, the sliding of
    standing feet, cm/s, and the validity."""

    errors: np.ndarray
    slides: np.ndarray
    validity: list[Validity]

    @property
    def bones(self) -> np.ndarray:
        """The errors of the bones' lengths, cm."""
        return np.array([validity.bone_length for validity in self.validity])

    @property
    def sliding(self) -> np.ndarray:
        """The sliding of the feet that stand in the motion itself, cm/s."""
        return np.array([validity.foot_sliding for validity in self.validity])


def _claim_of_no_guarantee(true: Constrained, projected: Constrained) -> Claim:
    """Whether bones and feet of projections are off by more than those of the takes."""
    bones = ratio_of_means(true.bones, projected.bones)
    sliding = ratio_of_means(true.sliding, projected.sliding)
    mean = Validity.mean(projected.validity)
    return Claim(
        "no_guarantee",
        all_of(bones.below(1), sliding.below(1)),
        f"{mean.against(Validity.mean(true.validity))} of the true motion; the takes slide "
        f"{sliding:.2f} of it.",
    )


def _claim_of_constraints(averaged: Constrained, constrained: Constrained) -> Claim:
    """What constraints leave of the errors of bones and feet, and what they cost."""
    sliding = ratio_of_means(constrained.slides, averaged.slides)
    position = ratio_of_means(constrained.errors, averaged.errors)
    bones = float(constrained.bones.mean())
    is_kept = all_of(bones < MOST_OFF, sliding.at_most(0.2), position.at_most(1))
    figures = (
        f"bones {bones:.1e} cm off, {averaged.bones.mean():.2f} before; standing feet "
        f"{constrained.slides.mean():.1f} cm/s, {averaged.slides.mean():.1f} before, "
        f"{sliding:.2f} of it; position {constrained.errors.mean():.2f} cm, "
        f"{averaged.errors.mean():.2f} before, {position:.2f} of it."
    )
    return Claim("constraints_kept", is_kept, figures)


def _sliding(features: np.ndarray, stands: np.ndarray) -> float:
    """The mean step of feet along the ground while they stand, (F, 2) bool, cm a frame."""
    feet = features_to_positions(features)[:, FEET][..., [0, 2]]
    steps = np.linalg.norm(np.diff(feet, axis=0), axis=-1)[stands[1:] & stands[:-1]]
    return 100 * float(steps.mean()) if steps.size else 0.0


def _constrain(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    """Features (F, 63) on bones of the manifold's lengths, with feet that stand still."""
    positions = features_to_positions(features)
    fitted = fit_motion(positions, manifold.lengths, manifold.rate)
    view = View(fitted)
    mended = mend_feet(view, find_feet(view, sensitivity=1.0))
    return manifold.features(body_positions(mended))[0]


def _error_of_path(manifold: MotionManifold, positions: np.ndarray) -> float:
    """The largest distance between a motion and the one integrated from its features, cm."""
    body = change_lengths(positions, bone_lengths(positions), manifold.lengths)
    back = features_to_positions(*manifold.features(positions))
    return float(100 * np.linalg.norm(back - body, axis=-1).max())


def _change_by_turning(manifold: MotionManifold, positions: np.ndarray) -> float:
    """The largest change of a feature of a motion that is moved along the floor and turned by one
    radian."""
    turn = np.array([[np.cos(1), 0, np.sin(1)], [0, 1, 0], [-np.sin(1), 0, np.cos(1)]])
    moved = positions @ turn.T + np.array([3.0, 0.0, -2.0])
    return float(np.abs(manifold.features(moved)[0] - manifold.features(positions)[0]).max())


def _claim_of_heading(turned: float) -> Claim:
    return Claim("heading_removed", turned <= UNTURNED, f"they change by at most {turned:.1e}.")


def _claim_of_lengths(manifold: MotionManifold, takes: list[np.ndarray]) -> Claim:
    """Whether takes are projected as well in shorter pieces and as wholes as in windows."""
    whole = max(len(take) for take in takes)
    squares = {}
    for length in (PIECE, manifold.window, whole):
        squares[length] = np.array([_squares_in_pieces(manifold, x, length) for x in takes])
    in_windows = squares[manifold.window]
    pieces = ratio_of_errors(squares[PIECE], in_windows)
    wholes = ratio_of_errors(squares[whole], in_windows)
    return Claim(
        "window_variable",
        all_of(pieces.at_most(VARIABLE), wholes.at_most(VARIABLE)),
        f"in pieces of {PIECE} frames {pieces:.3f} times the error in windows of "
        f"{manifold.window}, as wholes {wholes:.3f}.",
    )


def _squares_in_pieces(
    manifold: MotionManifold, features: np.ndarray, length: int
) -> tuple[float, int]:
    """The sum of the squared errors of a take that is projected in pieces of at most so many
    frames, cm², and their number."""
    stride = manifold.stride
    x = manifold.normalise(features[: max(len(features) // stride, 1) * stride])
    total = 0.0
    for start in range(0, len(x), length):
        piece = x[None, start : start + length]
        gap = (manifold.project_windows(piece) - piece) / manifold.scale
        total += 1e4 * float(np.square(gap[..., POSITIONS], dtype=np.float64).sum())
    return total, x[:, POSITIONS].size


def _changes(manifold: MotionManifold, takes: list[np.ndarray]) -> dict[str, np.ndarray]:
    """By how much a delay of one frame changes the units of layer 1 of each take, in deviations of
    the units: with max pooling, with the mean of each pair, and with every second frame."""
    layer = manifold.network.layers[0]
    changes: dict[str, list[float]] = {MAXIMUM: [], MEAN: [], EVERY_SECOND: []}
    for take in takes:
        x = manifold.normalise(take[: len(take) // 2 * 2 - 1])[None]
        longer = np.pad(x, ((0, 0), (0, 1), (0, 0)), mode="edge")
        delayed = np.pad(x, ((0, 0), (1, 0), (0, 0)), mode="edge")
        maps, _ = ops.conv1d(longer, layer.w, layer.b)
        delayed_maps, _ = ops.conv1d(delayed, layer.w, layer.b)
        pooled, _ = ops.max_pool(maps)
        delayed_pooled, _ = ops.max_pool(delayed_maps)
        changes[MAXIMUM].append(_relative_change(pooled, delayed_pooled))
        means = (maps[:, ::2] + maps[:, 1::2]) / 2
        delayed_means = (delayed_maps[:, ::2] + delayed_maps[:, 1::2]) / 2
        changes[MEAN].append(_relative_change(means, delayed_means))
        changes[EVERY_SECOND].append(_relative_change(maps[:, ::2], delayed_maps[:, ::2]))
    return {name: np.array(of_takes) for name, of_takes in changes.items()}


def _relative_change(maps: np.ndarray, delayed: np.ndarray) -> float:
    """The root mean square of the change of the units, by their standard deviation."""
    units = np.tanh(maps)
    return float(np.sqrt(np.mean((units - np.tanh(delayed)) ** 2) / units.var()))


def unpoolings(manifold: MotionManifold, testing: Clips, seed: int) -> Result:
    """Decode the hidden units of test windows in both ways; the masks are drawn from the seed."""
    y = manifold.network.encode(testing.x)
    decoded = {
        TRUE: testing.x,
        EVEN: manifold.network.decode(y),
        RANDOM: y,
    }
    rng = np.random.default_rng(seed)
    for layer in reversed(manifold.network.layers):
        first = rng.random(decoded[RANDOM].shape) < 0.5
        decoded[RANDOM], _ = layer.decode_with_pullback(decoded[RANDOM], first)
    trembling = {name: _jitters(testing, x) for name, x in decoded.items()}
    times = {}
    rows = []
    for name, x in decoded.items():
        times[name] = ratio_of_means(trembling[name], trembling[TRUE])
        mean = float(trembling[name].mean())
        rows.append([name, testing.error(x), mean, times[name].value])
    header = ["unpooling", "error, cm", "jitter, m/s²", "of the truth's"]
    motions = {n: (manifold.denormalise(decoded[n][0]), colour) for n, colour in COLOURS.items()}
    even = f"{times[EVEN]:.1f} times the jitter of the truth"
    random = f"{times[RANDOM]:.1f} times the jitter of the truth"
    claims = [
        Claim("random_noisy", times[RANDOM].above(NOISY), f"{random};", "", f"even: {even}."),
        Claim("even_smooth", times[EVEN].at_most(SMOOTH), f"{even};", "", f"random: {random}."),
    ]
    pictures = {"unpoolings": moving(motions, manifold.rate)}
    return Result("", [Table("", header, rows)], claims, pictures)


def inverses(manifold: MotionManifold, testing: Clips, seed: int) -> Result:
    """How far each unpooling is from an inverse of the maximum; the masks are drawn from the
    seed."""
    rng = np.random.default_rng(seed)
    errors: dict[tuple[str, str], list[np.ndarray]] = {}
    x = testing.x
    for number, layer in enumerate(manifold.network.layers):
        maps, _ = ops.conv1d(x, layer.w, layer.b)
        pooled, _ = ops.max_pool(maps)
        x = np.tanh(pooled)
        for name, unpooled in _unpool(pooled, rng).items():
            again, _ = ops.max_pool(unpooled)
            before = _squares(testing, unpooled - maps, maps, 2**number)
            after = _squares(testing, again - pooled, pooled, 2 ** (number + 1))
            errors.setdefault((BEFORE, name), []).append(before)
            errors.setdefault((AGAIN, name), []).append(after)
    rows = []
    claims = []
    for sense in (BEFORE, AGAIN):
        of_sense = {name: errors[sense, name] for name in (RANDOM, EVEN, REPEATED)}
        shares = {name: _shares_left(of_layers) for name, of_layers in of_sense.items()}
        for name, of_layers in shares.items():
            rows.append([f"{sense}: {name}", *(share.value for share in of_layers)])
        claims += _claims_of_inverses(sense, of_sense, shares)
    header = ["share of the squared values that is left", *_layer_names(manifold)]
    return Result("", [Table("", header, rows)], claims)


def _layer_names(manifold: MotionManifold) -> list[str]:
    return [f"layer {number + 1}" for number in range(len(manifold.network.layers))]


def _unpool(pooled: np.ndarray, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """The pooled values (B, T, C) unpooled in each way, (B, 2T, C)."""
    random, _ = ops.unpool_random(pooled, rng.random(pooled.shape) < 0.5)
    even, _ = ops.unpool_even(pooled)
    return {RANDOM: random, EVEN: even, REPEATED: np.repeat(pooled, 2, axis=1)}


def _squares(testing: Clips, error: np.ndarray, values: np.ndarray, stride: int) -> np.ndarray:
    """For each take the sum of the squares of an error and of the values, (K, 2), in the frames
    that count, of which a hidden frame has `stride`."""
    real = testing.real[:, ::stride]
    rows = []
    for number in np.unique(testing.take):
        of_take = testing.take == number
        sums = []
        for array in (error, values):
            sums.append(np.square(array[of_take][real[of_take]], dtype=np.float64).sum())
        rows.append(sums)
    return np.array(rows)


def _shares_left(of_layers: list[np.ndarray]) -> list[Interval]:
    """The share of the squared values that is left as error in each layer, from `_squares`."""
    return [ratio_of_means(*squares.T) for squares in of_layers]


def _claims_of_inverses(
    sense: str, of_sense: dict[str, list[np.ndarray]], shares: dict[str, list[Interval]]
) -> list[Claim]:
    """Whether random unpooling is a good inverse, and even unpooling a worse one."""
    listed = {}
    is_good = {}
    for name, of_layers in shares.items():
        listed[name] = ", ".join(f"{share:.2f}" for share in of_layers)
        is_good[name] = all_of(*(share.at_most(GOOD) for share in of_layers))
    also = [name for name in (EVEN, REPEATED) if is_good[name]]
    is_inaccurate = []
    for share, even, random in zip(shares[EVEN], of_sense[EVEN], of_sense[RANDOM], strict=True):
        is_inaccurate.append(share.above(GOOD))
        is_inaccurate.append(ratio_of_means(even[:, 0], random[:, 0]).above(1))
    return [
        Claim(
            "random_inverse",
            is_good[RANDOM],
            f"by layer {listed[RANDOM]} of the squared values;",
            sense,
            f"{EVEN} {listed[EVEN]}; {REPEATED} {listed[REPEATED]}.",
            " and ".join(also),
        ),
        Claim(
            "even_inaccurate",
            all_of(*is_inaccurate),
            f"by layer {listed[EVEN]} of the squared values;",
            sense,
            f"{RANDOM} {listed[RANDOM]}.",
        ),
    ]


def non_linearity(
    manifold: MotionManifold, material: Material, testing: Clips, seed: int
) -> Result:
    """Project stretched windows, and decode means of hidden units, by the network and by an
    untrained one."""
    complete = testing.x[testing.real.all(axis=1)]
    if len(complete) < 2:
        complete = testing.x[:2]
    networks = {TRAINED: manifold, INITIAL: untrained(manifold, seed)}
    training = features_of(manifold, evenly(material.training, STRETCHED_TAKES))
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    size = manifold.network.encode(complete[:1]).size // complete.shape[1]
    pca = PCA.fit(manifold.normalise(np.concatenate(training)))
    some = evenly(list(complete), STRETCHED_WINDOWS)
    by_pca = partial(pca.project, size=size)
    ratios = {PRINCIPAL: _ratio_of_stretched(manifold, measure, by_pca, some)}
    gaps = {}
    for name, network in networks.items():
        project = network.network.project
        ratios[name] = _ratio_of_stretched(manifold, measure, project, some)
        gaps[name] = _gap_of_means(network, complete)
    clipped = {name: ratio.at_most(CLIPPED) for name, ratio in ratios.items()}
    bent = {name: gap.above(NON_LINEAR) for name, gap in gaps.items()}
    rows = []
    for name, ratio in ratios.items():
        rows.append([name, ratio.value, gaps[name].value if name in gaps else None])
    header = ["manifold", "nearest pose, stretched", "decoded mean"]
    claims = [
        Claim(
            "tanh_clips",
            clipped[TRAINED],
            f"{ratios[TRAINED]:.2f} times as far;",
            opponent=f"{PRINCIPAL} {ratios[PRINCIPAL]:.2f}, {INITIAL} {ratios[INITIAL]:.2f}.",
            fulfilled_by=" and ".join(name for name in (PRINCIPAL, INITIAL) if clipped[name]),
        ),
        Claim(
            "manifold_nonlinear",
            bent[TRAINED],
            f"{gaps[TRAINED]:.3f} of the distance;",
            opponent=f"{INITIAL} {gaps[INITIAL]:.3f}.",
            fulfilled_by=INITIAL if bent[INITIAL] else "",
        ),
    ]
    return Result("", [Table("", header, rows, ("", ".2f", ".3f"))], claims)


def _ratio_of_stretched(
    manifold: MotionManifold,
    measure: ValidityMeasure,
    project: Callable[[np.ndarray], np.ndarray],
    windows: list[np.ndarray],
) -> Interval:
    """How many times as far from training poses stretched windows are projected as windows."""
    distances = []
    for factor in (STRETCHED, 1.0):
        of_windows = []
        for x in windows:
            features = manifold.denormalise(project(factor * x[None])[0])
            of_windows.append(measure.nearest_distances(features[::EVERY]).mean())
        distances.append(of_windows)
    return ratio_of_means(*np.array(distances))


def _gap_of_means(manifold: MotionManifold, x: np.ndarray) -> Interval:
    """The distance of the decoded mean of the hidden units of two windows from the mean of their
    decodings, divided by the distance of their decodings; a window with that half of all away."""
    y = manifold.network.encode(x)
    other = np.roll(y, len(y) // 2, axis=0)
    decode = manifold.network.decode
    first, second = decode(y).copy(), decode(other).copy()
    gap = decode((y + other) / 2) - (first + second) / 2
    return ratio_of_means(_norms(gap), _norms(first - second))


def _norms(x: np.ndarray) -> np.ndarray:
    """The Euclidean norm of each window (N, T, C)."""
    return np.linalg.norm(x.reshape(len(x), -1).astype(np.float64), axis=1)


def _jitters(testing: Clips, x: np.ndarray) -> np.ndarray:
    """For each take the mean jitter of its windows, of the frames that count, m/s²."""
    manifold = testing.manifold
    jitters: dict[int, list[float]] = {}
    windows = zip(manifold.denormalise(x), testing.real, testing.take, strict=True)
    for features, is_real, take in windows:
        if is_real.sum() > 2:
            value = jitter(features_to_positions(features[is_real]), manifold.rate)
            jitters.setdefault(int(take), []).append(value)
    return np.array([np.mean(of_take) for of_take in jitters.values()])


def filters(manifold: MotionManifold, material: Material, clips: Clips, seed: int) -> Result:
    """Measure the filters of each layer, and those of untrained networks, in windows of test
    takes."""
    trained = measure_filters(manifold, clips)
    initial = []
    for number in range(UNTRAINED):
        initial.append(measure_filters(untrained(manifold, seed + number), clips))
    header = ["layer", "frames", "joints", "combined filters", "correlation"]
    rows: list[list[object]] = []
    for number, layer in enumerate(trained, start=1):
        rows.append([f"layer {number}", *layer.medians()])
    for number, layer in enumerate(initial[0], start=1):
        rows.append([f"layer {number}, untrained", *layer.medians()])
    table = Table("Medians over the filters; mean correlation of two units:", header, rows)
    claims = [
        _claim_of_correspondence(trained, initial[0]),
        _claim_of_independence(
            trained,
            [network[0].correlation for network in initial],
            _correlation_of_components(manifold, material, clips),
        ),
        _claim_of_combination(trained, initial[0]),
        _claim_of_duration(trained, initial[0]),
    ]
    return Result("", [table], claims)


@dataclass(frozen=True)
class Filters:
    """The filters of a layer: the frames that they last, the joints that they move and the filters
    of the layer below that they combine, with the quartiles, and the mean magnitude of the
    correlation of two units. Layer 1 has no layer below."""

    frames: Interval
    joints: Interval
    combined: Interval | None
    correlation: float

    def medians(self) -> list[float | None]:
        """The columns of the table."""
        combined = self.combined and self.combined.value
        return [self.frames.value, self.joints.value, combined, self.correlation]


def _claim_of_correspondence(trained: list[Filters], initial: list[Filters]) -> Claim:
    """Whether a filter of layer 1 moves several joints for some time."""
    figures = []
    for layer in (trained[0], initial[0]):
        figures.append(f"{layer.joints.value:.0f} joints for {layer.frames.value:.0f} frames")
    return Claim(
        "filters_correspond",
        _moves_several(trained[0]),
        f"a filter of layer 1 moves {figures[0]};",
        opponent=f"an untrained one {figures[1]}.",
        fulfilled_by="untrained filters" if _moves_several(initial[0]) else "",
    )


def _moves_several(layer: Filters) -> bool:
    return layer.joints.value >= 2 and layer.frames.value >= 3


def _claim_of_independence(
    trained: list[Filters], untrained_correlations: list[float], of_components: float
) -> Claim:
    """Whether two units of layer 1 correlate less than those of every untrained network, as
    principal components do."""
    ours = trained[0].correlation
    least, most = min(untrained_correlations), max(untrained_correlations)
    below = Interval(ours, ours - (most - least), ours + (most - least)).at_most(least)
    listed = ", ".join(f"{value:.2f}" for value in untrained_correlations)
    figures = f"two units of layer 1 correlate {ours:.2f};"
    return Claim(
        "filters_independent",
        below,
        figures,
        opponent=f"untrained {listed}; {COMPONENTS} {of_components:.2f}.",
        fulfilled_by=COMPONENTS if of_components < least else "",
    )


def _correlation_of_components(manifold: MotionManifold, material: Material, clips: Clips) -> float:
    """The mean correlation of two principal components of 15 frames, as many as layer 1 has
    units, fitted to training takes and measured in the windows of clips."""
    training = clips_of(manifold, [take.positions for take in material.training])
    fitted = Gaussian(training.x, training.real).every
    _, axes = np.linalg.eigh(fitted.covariance)
    first = axes[:, -manifold.network.layers[0].b.size :]
    rows = []
    for x, real in zip(clips.x, clips.real, strict=True):
        rows.append((gather_context(x) - fitted.mean)[real] @ first)
    return correlation_of(np.concatenate(rows))


def _claim_of_combination(trained: list[Filters], initial: list[Filters]) -> Claim:
    """Whether the filters of each deeper layer combine several filters of the layer below, and last
    longer than these."""
    figures = []
    for layers in (trained, initial):
        combined = ", ".join(f"{layer.combined.value:.0f}" for layer in layers if layer.combined)
        frames = ", ".join(f"{layer.frames.value:.0f}" for layer in layers)
        joints = ", ".join(f"{layer.joints.value:.0f}" for layer in layers)
        figures.append(
            f"filters of deeper layers combine {combined} of the layer below; frames by layer "
            f"{frames}, joints {joints}"
        )
    return Claim(
        "filters_combine",
        _combine(trained),
        f"{figures[0]};",
        opponent=f"untrained: {figures[1]}.",
        fulfilled_by="untrained filters" if _combine(initial) else "",
    )


def _combine(layers: list[Filters]) -> bool:
    frames = 0.0
    for layer in layers:
        if layer.frames.value <= frames:
            return False
        if layer.combined is not None and layer.combined.value < SEVERAL:
            return False
        frames = layer.frames.value
    return True


def _claim_of_duration(trained: list[Filters], initial: list[Filters]) -> Claim:
    """Whether filters of layer 1 last at most a second, and those of the last layer two."""
    is_fulfilled = []
    for layers in (trained, initial):
        is_short = layers[0].frames.at_most(SECOND)
        is_fulfilled.append(all_of(is_short, layers[-1].frames.above(2 * SECOND)))
    return Claim(
        "filters_last",
        is_fulfilled[0],
        f"frames in layer 1 {trained[0].frames:.0f}, in the last layer {trained[-1].frames:.0f};",
        opponent=f"untrained {initial[0].frames:.0f}, {initial[-1].frames:.0f}.",
        fulfilled_by="untrained filters" if is_fulfilled[1] else "",
    )


def measure_filters(manifold: MotionManifold, clips: Clips) -> list[Filters]:
    """The filters of each layer; units are those of the windows of clips."""
    measured = []
    for n in range(1, len(manifold.network.layers) + 1):
        units = manifold.network.encode(clips.x, layers=n)[clips.real[:, :: 2**n]]
        energy = energy_of_responses(manifold, units, n)
        frames = _quartiles(count_columns(energy.sum(axis=2)))
        joints = _quartiles(count_columns(energy.sum(axis=1)))
        combined = None
        if n > 1:
            below = manifold.network.encode(clips.x, layers=n - 1)[clips.real[:, :: 2 ** (n - 1)]]
            weights = manifold.network.layers[n - 1].w * below.std(axis=0)[:, None]
            energy_of_weights = np.square(weights, dtype=np.float64).sum(axis=0).T
            combined = _quartiles(count_columns(energy_of_weights))
        measured.append(Filters(frames, joints, combined, correlation_of(units)))
    return measured


def correlation_of(units: np.ndarray) -> float:
    """The mean magnitude of the correlation of two units (N, k); constant units are left out."""
    varied = units[:, units.std(axis=0) > 1e-6]
    correlation = np.abs(np.corrcoef(varied, rowvar=False))
    off_diagonal = correlation.sum() - len(correlation)
    return float(off_diagonal / (correlation.size - len(correlation)))


def responses(manifold: MotionManifold, units: np.ndarray, n: int) -> np.ndarray:
    """What raising each of the units (N, k) of layer n adds to the motion, (k, frames, 63)."""
    layers = manifold.network.layers[:n]
    radius = sum(len(layer.w) // 2 * 2**below for below, layer in enumerate(layers))
    middle = radius // 2**n + 1
    filters = np.arange(units.shape[1])
    raised = np.tile(units.mean(axis=0), (len(filters) + 1, 2 * middle + 1, 1))
    raised[filters, middle, filters] = np.quantile(units, 0.99, axis=0)
    for layer in reversed(layers):
        raised, _ = layer.decode_with_pullback(raised.astype(layer.w.dtype))
    return raised[:-1] - raised[-1]  # the last one has no unit raised


def energy_of_responses(manifold: MotionManifold, units: np.ndarray, n: int) -> np.ndarray:
    """The energy of the response of each filter of layer n, (k, frames, joints), of the units
    (N, k); filters that move nothing are left out."""
    energy = np.square(responses(manifold, units, n)[..., POSITIONS], dtype=np.float64)
    energy = energy.reshape(*energy.shape[:2], len(JOINTS), 3).sum(axis=-1)
    return energy[energy.sum(axis=(1, 2)) > SILENT]


def count_columns(energy: np.ndarray) -> np.ndarray:
    """The number of columns that have together `ENERGY` of each row's energy."""
    share = np.sort(energy, axis=1)[:, ::-1].cumsum(axis=1) / energy.sum(axis=1, keepdims=True)
    return 1 + (share < ENERGY).sum(axis=1)


def _quartiles(counts: np.ndarray) -> Interval:
    """The median and the quartiles over the filters."""
    low, middle, high = np.percentile(counts, (25, 50, 75))
    return Interval(float(middle), float(low), float(high))
