"""Values removed from takes and completed by every method that is given the mask; a wrist that is
missing for a whole clip, and stepped animation: holden2015, section 7, "Filling in Missing Data".

    python -m studies filling_in --data bandai --test '*_003.bvh'
    python -m studies filling_in --data bandai --test '*_003.bvh' --takes 3 --seeds 1

Of at most `--takes` takes of each source, evenly spaced, each value is removed with probability p,
in at most 160 frames in the middle of the take. Errors are root mean squares of the missing joint
coordinates over all takes and seeds. `complete` weighs a Gaussian process of each column, the same
refined by what the frames of the take say, and the network's completion refined
(numpy_cae/manifold/weighted_completion.py has the equations). What the network adds is the
difference to the same without the network. docs/lab_book/completion.md has the findings.

For stepped keys, errors are measured up to the last key. A held key lags behind by half of their
distance on average: "delayed" is the error against the truth so many frames before. The curves
through the rotations of the rig are given the keys and which they are.

The network is not given the mask of what is missing. A missing joint is placed where it is in the
mean pose, which is zero for the network, and read from the projection. For stepped animation, which
repeats every 15th frame, the paper finds smooth transitions. The rotation curves of animation
programs are given which frames are keys, and the rotations of the rig in these. A wrist that is
missing for a whole clip has no keys; `python -m studies holes` has holes between known frames.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from numpy_cae.cleanup.interpolation import interpolate_joints
from numpy_cae.evaluation import jitter, position_error
from numpy_cae.evaluation.tables import Clips
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.filling import keyframe_mask
from numpy_cae.mocap import body_positions
from numpy_cae.mocap.retargeting.body import Body
from numpy_cae.motion import Motion, features_to_positions, joint_slice
from numpy_cae.motion.hole_curves import ROTATION_CURVES
from numpy_cae.motion.motion import RATE
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.shared.completions import table_of_missing_columns, table_of_removed_values
from studies.shared.material import Material, evenly, features_of, testing_of
from studies.shared.result import Claim, Result, Table, combined, moving

EVERY = 15
CURVE = " of the rotations, keys given"
DELAY = (EVERY - 1) // 2
"""Mean number of frames that a held key lags behind."""
MEAN_POSE = "the mean pose"
HELD = "held"
TRUE = "truth"
NETWORK = "the network"
REPEATED = "the network, ends repeated"
WRISTS = ("left_wrist", "right_wrist")
TARGET = 0.85
"""The wrist's error is to be below this share of the mean pose's."""
WRIST_ERROR = "Error at the missing joint, cm (root mean square of a coordinate):"
HEADER = ("method", "error, cm", "delayed, cm", "jitter, m/s²")
STEPPED_TAKES = 20
"""The most takes that are stepped, spread evenly over all."""


def run(
    manifold: MotionManifold, material: Material, takes: int = 12, seeds: int = 2, seed: int = 0
) -> Result:
    """Remove values of test takes, and each wrist of them; hold every 15th frame; fill all in."""
    testing, sample = testing_of(manifold, material)
    removed = _with_values_removed(manifold, material, takes, range(seed, seed + seeds))
    wrists = _without_wrists(manifold, testing)
    stepped = _with_stepped_takes(manifold, material)
    parts = [wrists, stepped, removed]
    return combined("Filling in: missing values, a missing marker, stepped keys", parts, sample)


def _with_values_removed(
    manifold: MotionManifold, material: Material, takes: int, seeds: Sequence[int]
) -> Result:
    """The errors of every method in takes that lack values, or a wrist, by source."""
    if takes < 1 or not seeds:
        raise ValueError("--takes and --seeds are 1 or more")
    tables = []
    for source in dict.fromkeys(take.source for take in material.testing):
        chosen = features_of(manifold, evenly(material.of(source).testing, takes))
        tables.append(table_of_removed_values(manifold, chosen, seeds, source))
        tables.append(table_of_missing_columns(manifold, chosen, WRISTS, source))
    return Result("", tables)


def _without_wrists(manifold: MotionManifold, testing: Clips) -> Result:
    """The error of each wrist where it is missing from test windows."""
    errors = {joint: _errors_without(manifold, testing, joint) for joint in WRISTS}
    table = _table(WRIST_ERROR, ["missing joint", MEAN_POSE, NETWORK], errors)
    claim = _wrist_claim(np.array(list(errors.values())))
    return Result("", [table], [claim])


def _with_stepped_takes(manifold: MotionManifold, material: Material) -> Result:
    """The errors of every method on test takes of which every 15th frame is held."""
    takes = [take for take in material.testing if len(take.positions) > EVERY]
    if not takes:
        raise ValueError(f"it needs a test take of more than {EVERY} frames at 30 a second")
    fillings = []
    for take in evenly(takes, STEPPED_TAKES):
        fillings.append(_fill_stepped(manifold, material.motion(take).resampled(RATE)))
    means = _mean_measures(fillings)
    table = _table(f"Every {EVERY}th frame held, mean of {len(fillings)} takes:", HEADER, means)
    example = fillings[len(fillings) // 2]
    colours = {HELD: CORRUPTED, REPEATED: PROJECTED, TRUE: TRUTH}
    motions = {method: (example[method], colour) for method, colour in colours.items()}
    pictures = {"filling_in": moving(motions, manifold.rate)}
    return Result("", [table], _stepped_claims(means), pictures)


def _mean_measures(fillings: Sequence[Mapping[str, np.ndarray]]) -> dict[str, np.ndarray]:
    """The measures of each method, their mean over the takes."""
    means = {}
    for method in fillings[0]:
        measures = [_measure(filling[method], filling[TRUE]) for filling in fillings]
        means[method] = np.mean(measures, axis=0)
    return means


def _table(caption: str, header: Sequence[str], rows: Mapping[str, Iterable[float]]) -> Table:
    return Table(caption, header, [[name, *numbers] for name, numbers in rows.items()])


def _errors_without(manifold: MotionManifold, testing: Clips, joint: str) -> list[float]:
    """The error of a joint, cm, where it is in the mean pose, and after projection."""
    lost = testing.x.copy()
    lost[..., joint_slice(joint)] = 0
    projected = [manifold.project(window) for window in manifold.denormalise(lost)]
    return [testing.error(x, joint) for x in (lost, manifold.normalise(np.stack(projected)))]


def _fill_stepped(manifold: MotionManifold, motion: Motion) -> dict[str, np.ndarray]:
    """The features (F, 63) of a motion at `RATE`, up to its last key, by every method."""
    frames = np.arange((len(motion) - 1) // EVERY * EVERY + 1)
    motion = motion.at(frames)
    truth = Body(motion, manifold.lengths).features
    mask = keyframe_mask(len(motion), EVERY)
    held = truth[frames - frames % EVERY]
    filled = {HELD: held, REPEATED: manifold.project(held)}
    for name, curve in ROTATION_CURVES.items():
        positions = body_positions(interpolate_joints(motion, mask, lambda *_, curve=curve: curve))
        filled[name + CURVE] = manifold.features(positions)[0]
    return filled | {TRUE: truth}


def _measure(x: np.ndarray, truth: np.ndarray) -> tuple[float, float, float]:
    """The error, the error against the truth delayed by `DELAY` frames, and the jitter."""
    delayed = position_error(x[DELAY:], truth[:-DELAY])
    return position_error(x, truth), delayed, jitter(features_to_positions(x), RATE)


def _wrist_claim(errors: np.ndarray) -> Claim:
    mean, network = np.sqrt(np.mean(errors**2, axis=0))
    figures = f"{network:.2f} cm, the mean pose {mean:.2f} cm, {network / mean:.2f} of it."
    return Claim("wrist_inferred", bool(network < TARGET * mean), figures)


def _stepped_claims(measured: dict[str, np.ndarray]) -> list[Claim]:
    held, held_delayed, held_jitter = measured[HELD]
    error, delayed, jitter = measured[REPEATED]
    truth = measured[TRUE][2]
    curves = {name: row[0] for name, row in measured.items() if name.endswith(CURVE)}
    best = min(curves, key=lambda name: curves[name])
    return [
        Claim(
            "smooth_transitions",
            abs(jitter - truth) < truth / 2,
            f"{held_jitter:.1f} m/s² held, {jitter:.1f} projected, truth {truth:.1f}.",
        ),
        Claim(
            "transitions_are_motion",
            error < held and delayed < held_delayed,
            f"{held:.2f} cm held, {error:.2f} cm projected; delayed {held_delayed:.2f} and "
            f"{delayed:.2f} cm. {best}: {curves[best]:.2f} cm.",
        ),
    ]
