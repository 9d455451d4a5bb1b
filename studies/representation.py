"""The representation of holden2015, sections 3 to 6, and what section 7 says that it cannot do.

    python -m studies representation --data bandai --test '*_005.bvh' -m best.npz

Sizes and bounds of the hidden units; the path that is integrated from the velocities; the bones and
the standing feet of a projection, which "cannot guarantee constraints such as ground contact and
joint lengths"; whether max pooling "provides a level of temporal invariance"; and the time of a
projection. A projection under constraints is future work in section 7: here it is fitted by
rotations of bones of the manifold's lengths, and its feet are mended as `repair --feet` mends them.

Random and even unpooling of the same hidden units (section 5): random unpooling "results in some
noise in the produced animation", even unpooling "does result in smooth animation with no high
frequency noise".

What the filters express (section 6, "Once training is complete …"): one unit of a layer is raised
at one moment from its mean to its 99th percentile in test windows; the layers below decode the
difference. A filter moves the joints and lasts the frames that have together nine tenths of the
energy of this response. An untrained network is measured beside it.
"""

from dataclasses import astuple
from timeit import repeat

import numpy as np

from numpy_cae import ops
from numpy_cae.cleanup.feet import find_feet, mend_feet
from numpy_cae.cleanup.view import View
from numpy_cae.evaluation import jitter, position_error
from numpy_cae.evaluation.tables import Clips
from numpy_cae.manifold import MotionManifold, hidden_units
from numpy_cae.mocap import body_positions
from numpy_cae.motion import JOINTS, POSITIONS, features_to_positions
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.motion.features import bone_lengths, change_lengths
from numpy_cae.motion.fit import fit_motion
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.comparison import untrained
from studies.shared.material import Material, features_of, testing_of
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
COLOURS = {TRUE: TRUTH, EVEN: PROJECTED, RANDOM: CORRUPTED}
NOISY = 2.0
"""Unpooling is noisy if the jitter is more than this many times the truth's."""
SMOOTH = 1.5
"""Unpooling is smooth if the jitter is less than this many times the truth's."""
ENERGY = 0.9
"""The share of a response's energy in its joints and its frames."""
SILENT = 1e-8
"""A filter whose response has less energy than this moves nothing, and is left out."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure the test takes and their projections, both unpoolings of their hidden units, and the
    filters. The seed is for the masks of unpooling and for the untrained network."""
    testing, sample = testing_of(manifold, material)
    takes = features_of(manifold, material.testing)
    off = max(_error_of_path(manifold, take.positions) for take in material.testing)
    parts = [
        units(manifold, takes, testing, off),
        constraints(manifold, takes),
        unpoolings(manifold, testing, seed),
        filters(manifold, testing.pick_evenly(WINDOWS), seed),
    ]
    return combined("The representation and its limits", parts, sample)


def units(manifold: MotionManifold, takes: list[np.ndarray], testing: Clips, off: float) -> Result:
    """The hidden units of the test takes, features (F, 63), and the time of a projection; `off` is
    the largest error of an integrated path, cm."""
    network = manifold.network
    largest = max(float(np.abs(hidden_units(manifold, take)).max()) for take in takes)
    window = np.zeros((1, 160, 63), np.float32)
    sizes = [network.encode(window, layers=n + 1).shape[1:] for n in range(len(network.layers))]
    x = testing.x[:WINDOWS]
    seconds = min(repeat(lambda: network.project(x), number=1, repeat=10)) / len(x)
    time = f"{1e3 * seconds:.2f} ms a window, {len(x)} together."
    pooled, skipped = _changes(manifold, takes)
    claims = [
        Claim("units_bounded", largest <= 1, f"the largest of all is {largest:.3f}."),
        Claim("sizes", sizes == SIZES, f"{', '.join(f'{t} x {k}' for t, k in sizes)}."),
        Claim("path_integrated", off < INTEGRATED, f"at most {off:.1e} cm off."),
        Claim(
            "pooling_invariant",
            pooled < skipped,
            f"units of layer 1 change by {pooled:.3f} of their deviation;",
            opponent=f"without the maximum, every second frame: {skipped:.3f}.",
        ),
        Claim("projected_fast", seconds < 1e-3, time),
    ]
    return Result("", [], claims)


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
        "test takes": takes,
        "projected": [manifold.project(take) for take in takes],
        "averaged over shifts": averaged,
        "constant bones, mended feet": [_constrain(manifold, x) for x in averaged],
    }
    rows = []
    for name, clips in kinds_of_motion.items():
        errors = [position_error(*pair) for pair in zip(clips, takes, strict=True)]
        slides = [_sliding(*pair) for pair in zip(clips, stands, strict=True)]
        validity = measure.mean(clips)
        rows.append([name, np.mean(errors), manifold.rate * np.mean(slides), *astuple(validity)])
    header = ["motion", "position, cm", "standing feet, cm/s", *Validity.HEADER]
    table = Table("", header, rows, ("", ".2f", ".1f", *Validity.FORMATS[1:]))
    return Result("", [table], _claims_of_constraints(rows))


def _claims_of_constraints(rows: list[list]) -> list[Claim]:
    """What a projection lacks, and what constraints cost, from the rows of the table."""
    true, plain, averaged, constrained = (Validity(*row[3:]) for row in rows)
    is_worse = plain.bone_length > true.bone_length and plain.foot_sliding > true.foot_sliding
    _, error, slide, *_ = rows[2]
    _, constrained_error, constrained_slide, *_ = rows[3]
    is_kept = (
        constrained.bone_length < MOST_OFF
        and constrained_slide <= slide / 5
        and constrained_error <= error
    )
    figures = (
        f"bones {constrained.bone_length:.1e} cm off, {averaged.bone_length:.2f} before; standing "
        f"feet {constrained_slide:.1f} cm/s, {slide:.1f} before; position "
        f"{constrained_error:.2f} cm, {error:.2f} before."
    )
    return [
        Claim("no_guarantee", is_worse, f"{plain.against(true)} of the true motion."),
        Claim("constraints_kept", bool(is_kept), figures),
    ]


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


def _changes(manifold: MotionManifold, takes: list[np.ndarray]) -> tuple[float, float]:
    """By how much a delay of one frame changes the units of layer 1, in deviations of the units:
    with max pooling, and with every second frame instead."""
    layer = manifold.network.layers[0]
    with_maximum = []
    with_every_second = []
    for take in takes:
        x = manifold.normalise(take[: len(take) // 2 * 2 - 1])[None]
        longer = np.pad(x, ((0, 0), (0, 1), (0, 0)), mode="edge")
        delayed = np.pad(x, ((0, 0), (1, 0), (0, 0)), mode="edge")
        maps, _ = ops.conv1d(longer, layer.w, layer.b)
        delayed_maps, _ = ops.conv1d(delayed, layer.w, layer.b)
        pooled = ops.max_pool(maps)[0], ops.max_pool(delayed_maps)[0]
        with_maximum.append(_relative_change(*pooled))
        with_every_second.append(_relative_change(maps[:, ::2], delayed_maps[:, ::2]))
    return float(np.mean(with_maximum)), float(np.mean(with_every_second))


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
    trembling = {name: _jitter(testing, x) for name, x in decoded.items()}
    times = {name: value / trembling[TRUE] for name, value in trembling.items()}
    rows = [[name, testing.error(x), trembling[name], times[name]] for name, x in decoded.items()]
    header = ["unpooling", "error, cm", "jitter, m/s²", "of the truth's"]
    figures = {name: f"{ratio:.1f} times the jitter of the truth." for name, ratio in times.items()}
    motions = {n: (manifold.denormalise(decoded[n][0]), colour) for n, colour in COLOURS.items()}
    claims = [
        Claim("random_noisy", times[RANDOM] > NOISY, figures[RANDOM]),
        Claim("even_smooth", times[EVEN] < SMOOTH, figures[EVEN]),
    ]
    pictures = {"unpoolings": moving(motions, manifold.rate)}
    return Result("", [Table("", header, rows)], claims, pictures)


def _jitter(testing: Clips, x: np.ndarray) -> float:
    """The mean jitter of windows, of the frames that count, m/s²."""
    manifold = testing.manifold
    jitters = []
    for features, is_real in zip(manifold.denormalise(x), testing.real, strict=True):
        if is_real.sum() > 2:
            jitters.append(jitter(features_to_positions(features[is_real]), manifold.rate))
    return float(np.mean(jitters))


def filters(manifold: MotionManifold, clips: Clips, seed: int) -> Result:
    """Measure the filters of each layer, and those of an untrained network of this seed."""
    trained = _layers(manifold, clips)
    initial = _layers(untrained(manifold, seed), clips)
    header = ["layer", "frames", "joints", "correlation"]
    rows = [[f"layer {number}", *values] for number, values in enumerate(trained, start=1)]
    for number, values in enumerate(initial, start=1):
        rows.append([f"layer {number}, untrained", *values])
    frames, joints, correlations = np.array(trained).T
    listed = ", ".join(f"{value:.1f}" for value in joints)
    lasting = ", ".join(f"{value:.1f}" for value in frames)
    return Result(
        "",
        [Table("Medians over the filters; mean correlation of two units:", header, rows)],
        [
            Claim(
                "filters_correspond",
                bool(joints[0] >= 2 and frames[0] >= 3),
                f"a filter of layer 1 moves {joints[0]:.0f} joints for {frames[0]:.0f} frames.",
            ),
            Claim(
                "filters_independent",
                bool(correlations[0] < initial[0][2]),
                f"two units of layer 1 correlate {correlations[0]:.2f};",
                opponent=f"untrained {initial[0][2]:.2f}.",
            ),
            Claim(
                "filters_combine",
                bool((np.diff(joints) > 0).all() and (np.diff(frames) > 0).all()),
                f"joints by layer {listed}, frames {lasting}.",
            ),
        ],
    )


def _layers(manifold: MotionManifold, clips: Clips) -> list[tuple[float, float, float]]:
    """For each layer the frames that a filter lasts, the joints that it moves, and the mean
    magnitude of the correlation of two units."""
    measured = []
    for n in range(1, len(manifold.network.layers) + 1):
        units = manifold.network.encode(clips.x, layers=n)[clips.real[:, :: 2**n]]
        energy = np.square(responses(manifold, units, n)[..., POSITIONS], dtype=np.float64)
        energy = energy.reshape(*energy.shape[:2], len(JOINTS), 3).sum(axis=-1)
        energy = energy[energy.sum(axis=(1, 2)) > SILENT]
        varied = units[:, units.std(axis=0) > 1e-6]
        correlation = np.abs(np.corrcoef(varied, rowvar=False))
        between = (correlation.sum() - len(correlation)) / (correlation.size - len(correlation))
        measured.append((_count(energy.sum(axis=2)), _count(energy.sum(axis=1)), float(between)))
    return measured


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


def _count(energy: np.ndarray) -> float:
    """The median number of columns that have together `ENERGY` of each row's energy."""
    share = np.sort(energy, axis=1)[:, ::-1].cumsum(axis=1) / energy.sum(axis=1, keepdims=True)
    return float(np.median(1 + (share < ENERGY).sum(axis=1)))
