"""A Kinect recording, projected: holden2015, section 7 and figure 1, centre.

The paper records a person with a Kinect and with inertial sensors at once. No such recordings are
available here: `data_synth.see_with_kinect` simulates the Kinect's errors from published figures,
and the take itself is the truth. Part of these errors cannot be recognised in the motion: a joint
with a constant offset of a few centimetres, or an inclined floor.
"""

from collections.abc import Sequence

import numpy as np

from data_synth import see_with_kinect
from numpy_cae.experiments.clips import (
    AVERAGED,
    NETWORK,
    Clips,
    clips_of,
    project_ends_held,
    split_of,
    split_takes,
)
from numpy_cae.experiments.material import LabelledTake, Material, evenly
from numpy_cae.experiments.repair.repair_sweep import repair_baselines
from numpy_cae.experiments.result import Claim, Result, Table, moving
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.shifted_projection import project_shifted
from numpy_cae.motion import JOINTS, PARENTS
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH

CHOOSING_TAKES, TESTING_TAKES = 24, 60
"""At most, of each source, spread evenly."""
P = 0.1
"""Of the linear denoiser; also the paper's corruption in training."""
SEEN, TRUE = "seen by the Kinect", "truth"
LINEAR = f"linear denoiser, 15 frames, p = {P}"
Measured = dict[str, tuple[float, float]]
"""Method to error in cm and jitter in m/s²."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Simulate Kinect recordings of test takes, repair them, compare them with the takes."""
    split = split_of(manifold, material)
    linear = split.moments.solve(1 - P)
    choosing = evenly(split_takes(material.training)[1], CHOOSING_TAKES)
    practice, practice_truth = _seen(manifold, choosing, seed + 1)
    baselines = repair_baselines(split)
    best = {each.name: each.best(practice, practice_truth) for each in baselines}
    tables, claims, motions, sample = [], [], None, []
    for source in sorted({take.source for take in material.testing}, reverse=True):
        takes = evenly(material.of(source).testing, TESTING_TAKES)
        seen, truth = _seen(manifold, takes, seed)
        repaired = {
            SEEN: seen,
            **{each.name: each.repair(seen, best[each.name]) for each in baselines},
            LINEAR: linear.repair(seen),
            NETWORK: project_shifted(manifold.network, seen),
            AVERAGED: project_ends_held(manifold, seen, manifold.shifts),
            TRUE: truth.x,
        }
        measured = {name: (truth.error(x), truth.jitter(x)) for name, x in repaired.items()}
        rows = [[name, *values] for name, values in measured.items()]
        tables.append(Table("", [source, "error, cm", "jitter, m/s²"], rows))
        claims += _claims(source, measured)
        sample.append(f"{len(takes)} {source} takes ({len(truth)} windows)")
        if motions is None:
            window = truth.typical()
            colours = {SEEN: CORRUPTED, AVERAGED: PROJECTED, TRUE: TRUTH}
            motions = {x: (truth.features(repaired[x], window), colours[x]) for x in colours}
    return Result(
        "Repair: a Kinect recording",
        tables,
        claims,
        *moving(motions, manifold.rate, azimuth=55.0),
        f"Measured on {' and '.join(sample)} not used in training, seen by a simulated Kinect. "
        f"{split.fitted()}",
    )


def _seen(
    manifold: MotionManifold, takes: Sequence[LabelledTake], seed: int
) -> tuple[np.ndarray, Clips]:
    """Windows as seen by the Kinect, and the truth."""
    positions = [take.positions for take in takes]
    seen = [
        see_with_kinect(take, JOINTS, PARENTS, manifold.rate, np.random.default_rng([seed, number]))
        for number, take in enumerate(positions)
    ]
    return clips_of(manifold, [each.values for each in seen]).x, clips_of(manifold, positions)


def _claims(source: str, measured: Measured) -> list[Claim]:
    (before, before_jitter), (after, after_jitter) = measured[SEEN], measured[AVERAGED]
    truth = measured[TRUE][1]
    others = set(measured) - {SEEN, NETWORK, AVERAGED, TRUE}
    best = min(sorted(others), key=lambda name: measured[name][0])
    return [
        Claim(
            "After projection a Kinect recording matches the truth far more closely (holden2015, "
            f"section 7; {source} takes, a simulated Kinect; confirmed if less than two thirds of "
            "the error remains).",
            after < before * 2 / 3,
            f"{before:.2f} cm before, {after:.2f} cm after ({measured[NETWORK][0]:.2f} without "
            "what `repair` adds).",
        ),
        Claim(
            f"Projection brings its jitter nearer to the truth's ({source} takes).",
            abs(after_jitter - truth) < abs(before_jitter - truth),
            f"{before_jitter:.1f} m/s² before, {after_jitter:.1f} after, truth {truth:.1f}.",
        ),
        Claim(
            f"Projection leaves less error than filters and linear methods do ({source} takes).",
            after < measured[best][0],
            f"the network {after:.2f} cm, {best} {measured[best][0]:.2f} cm.",
        ),
    ]
