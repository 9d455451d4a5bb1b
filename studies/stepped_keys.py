"""Stepped animation, every 15th frame held: holden2015, section 7, "Filling in Missing Data".

    python -m studies stepped_keys --data bandai --test '*_005.bvh' -m best.npz

"Our method inserts smooth transitions between the stepped keyframes, corresponding to motion found
in the training data." The network is not given which frames are keys; nor are the moving averages
of 15 frames, once and twice, its simplest opponents. The keys are visible, where the held pose
changes: linear interpolation between them, with bones at their lengths, is the simplest method that
uses them. The rotation curves of animation programs are given which frames are keys, and the
rotations of the rig in these. Errors are measured up to the last key. A held key lags behind by
half of the distance of two keys on average: "delayed" is the error against the truth so many frames
before.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from numpy_cae.cleanup.interpolation import interpolate_joints
from numpy_cae.evaluation import jitter, position_error
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.filling import keyframe_mask
from numpy_cae.mocap import body_positions
from numpy_cae.motion import Motion, features_to_positions
from numpy_cae.motion.hole_curves import ROTATION_CURVES
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.interpolation import set_bone_lengths
from studies.shared.judging import all_of, ratio_of_means
from studies.shared.material import Material, evenly, features_of
from studies.shared.result import Claim, Result, Table, moving
from studies.shared.validity import ValidityMeasure

EVERY = 15
DELAY = (EVERY - 1) // 2
"""Mean number of frames that a held key lags behind."""
TAKES = 24
"""The most takes that are stepped, spread evenly over all."""
HELD = "held"
AVERAGE = "moving average of 15 frames"
TWICE = "moving average, twice"
LINEAR = "keys: linear, bones at their lengths"
CURVE = "keys: {} of the rotations"
NETWORK = "the network"
TRUE = "truth"
FREE = (AVERAGE, TWICE)
"""The opponents that are given as much as the network: nothing."""
SMOOTH = 1.5
"""Transitions are smooth if their jitter is at most this many times that of the true motion."""
FOUND = 1.25
"""Poses are found in the training data if they are at most this many times as far from the nearest
training pose as those of the true motion."""
HEADER = ("method", "error, cm", "delayed, cm", "jitter, m/s²", "nearest pose, cm")


class Measured(NamedTuple):
    """The columns of the table, a number for each take."""

    error: np.ndarray
    delayed: np.ndarray
    jitter: np.ndarray
    nearest: np.ndarray


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Hold every 15th frame of test takes, and insert transitions with every method.

    Nearest poses are those of the training takes. Raises ValueError where no take has two keys. The
    seed is not used.
    """
    takes = [take for take in material.testing if len(take.positions) > EVERY]
    if not takes:
        raise ValueError(f"it needs a test take of more than {EVERY} frames at 30 a second")
    measure = ValidityMeasure(
        features_of(manifold, material.training), manifold.lengths, manifold.rate
    )
    takes = evenly(takes, TAKES)
    fillings = []
    for take, features in zip(takes, features_of(manifold, takes), strict=True):
        filling = fill_steps(manifold, features)
        motion = material.motion(take).resampled(manifold.rate).at(slice(len(filling[TRUE])))
        fillings.append(filling | fill_by_curves(manifold, motion))
    measured = {}
    for method in fillings[0]:
        rows = [_measure(filling[method], filling[TRUE], measure) for filling in fillings]
        measured[method] = Measured(*np.array(rows).T)
    table_rows = []
    for method, columns in measured.items():
        table_rows.append([method, *(float(column.mean()) for column in columns)])
    table = Table(f"Every {EVERY}th frame held, mean of {len(fillings)} takes:", HEADER, table_rows)
    example = fillings[len(fillings) // 2]
    colours = {HELD: CORRUPTED, NETWORK: PROJECTED, TRUE: TRUTH}
    motions = {method: (example[method], colour) for method, colour in colours.items()}
    pictures = {"stepped_keys": moving(motions, manifold.rate)}
    return Result("Stepped keyframes", [table], _claims(measured), pictures)


def fill_steps(manifold: MotionManifold, features: np.ndarray) -> dict[str, np.ndarray]:
    """The features (F, 63) of a motion, up to its last key, by every method."""
    last = (len(features) - 1) // EVERY * EVERY
    truth = features[: last + 1]
    frames = np.arange(last + 1)
    keys = frames[::EVERY]
    held = truth[frames - frames % EVERY]
    average = _average(held)
    linear = np.stack([np.interp(frames, keys, column[keys]) for column in truth.T], axis=1)
    return {
        TRUE: truth,
        HELD: held,
        AVERAGE: average,
        TWICE: _average(average),
        LINEAR: set_bone_lengths(linear, manifold.lengths),
        NETWORK: manifold.project(held),
    }


def fill_by_curves(manifold: MotionManifold, motion: Motion) -> dict[str, np.ndarray]:
    """The features (F, 63) of a motion that ends at a key, of which the rotations in the keys are
    interpolated by each rotation curve."""
    mask = keyframe_mask(len(motion), EVERY)
    filled = {}
    for name, curve in ROTATION_CURVES.items():
        interpolated = interpolate_joints(motion, mask, lambda *_, curve=curve: curve)
        filled[CURVE.format(name)] = manifold.features(body_positions(interpolated))[0]
    return filled


def _average(features: np.ndarray) -> np.ndarray:
    return uniform_filter1d(features, EVERY, axis=0, mode="nearest")


def _measure(
    x: np.ndarray, truth: np.ndarray, measure: ValidityMeasure
) -> tuple[float, float, float, float]:
    """The error, that against the truth `DELAY` frames before, the jitter, the nearest pose."""
    delayed = position_error(x[DELAY:], truth[:-DELAY])
    trembling = jitter(features_to_positions(x), measure.rate)
    nearest = float(measure.nearest_distances(x).mean())
    return position_error(x, truth), delayed, trembling, nearest


def _claims(measured: dict[str, Measured]) -> list[Claim]:
    """Whether the transitions are smooth, and motion, and found in the training data."""
    truth = measured[TRUE]
    held = measured[HELD]
    network = measured[NETWORK]
    jitters = {}
    nearest = {}
    is_smooth = {}
    is_motion = {}
    is_found = {}
    for method, columns in measured.items():
        jitters[method] = ratio_of_means(columns.jitter, truth.jitter)
        nearest[method] = ratio_of_means(columns.nearest, truth.nearest)
        is_smooth[method] = jitters[method].at_most(SMOOTH)
        error = ratio_of_means(columns.error, held.error)
        delayed = ratio_of_means(columns.delayed, held.delayed)
        is_motion[method] = all_of(error.below(1), delayed.below(1))
        is_found[method] = nearest[method].at_most(FOUND)
    smooth = [method for method in FREE if is_smooth[method]]
    moving_on = [method for method in FREE if is_motion[method]]
    near = [method for method in (HELD, *FREE, LINEAR) if is_found[method]]
    best = min(FREE, key=lambda method: measured[method].error.mean())
    error = ratio_of_means(network.error, held.error)
    delayed = ratio_of_means(network.delayed, held.delayed)
    return [
        Claim(
            "smooth_transitions",
            is_smooth[NETWORK],
            f"{jitters[NETWORK]:.2f} of the truth's jitter, held {jitters[HELD].value:.2f};",
            opponent=f"{AVERAGE} {jitters[AVERAGE].value:.2f}, {TWICE} {jitters[TWICE].value:.2f}.",
            fulfilled_by=" and ".join(smooth),
        ),
        Claim(
            "transitions_are_motion",
            is_motion[NETWORK],
            f"{network.error.mean():.2f} cm, {error:.2f} of the held keys'; delayed "
            f"{network.delayed.mean():.2f} cm, {delayed:.2f};",
            opponent=f"{best}: {measured[best].error.mean():.2f} cm, delayed "
            f"{measured[best].delayed.mean():.2f}.",
            fulfilled_by=" and ".join(moving_on),
        ),
        Claim(
            "transitions_found",
            is_found[NETWORK],
            f"{nearest[NETWORK]:.2f} of the distance of the true motion to the nearest pose;",
            opponent=f"held {nearest[HELD].value:.2f}, {AVERAGE} {nearest[AVERAGE].value:.2f}, "
            f"linear with bones {nearest[LINEAR].value:.2f}.",
            fulfilled_by=" and ".join(near),
        ),
    ]
