"""A wrist that is missing for a whole clip, and stepped animation: holden2015, section 7, "Filling
in Missing Data".

The network is not given the mask of what is missing. A missing joint is placed where it is in the
mean pose, which is zero for the network, and read from the projection. For stepped animation, which
repeats every 15th frame, the paper finds smooth transitions. With the mask given, see `damage`.
"""

import numpy as np

from numpy_cae.experiments.clips import NETWORK, REPEATED, Clips, project_repeated, testing_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table, moving
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import joint_slice
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH

EVERY = 15
DELAY = (EVERY - 1) // 2
"""Mean number of frames that a held key lags behind."""
MEAN_POSE, HELD, TRUE = "the mean pose", "held", "truth"
WRISTS = ("left_wrist", "right_wrist")
TARGET = 0.85
"""The wrist's error is to be below this share of the mean pose's."""
STEPPED = (
    f"Every {EVERY}th frame held, measured up to the last key. A held key lags behind by {DELAY} "
    'frames on average: "delayed" is the error against the truth so many frames before'
)


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Remove each wrist from test windows; hold every 15th frame of them; project both."""
    testing, sample = testing_of(manifold, material)
    wrists = {}
    for joint in WRISTS:
        lost = testing.x.copy()
        lost[..., joint_slice(joint)] = 0  # where it is in the mean pose
        projected = project_repeated(manifold, lost)
        wrists[joint] = [testing.error(x, joint) for x in (lost, projected)]
    stepped = _up_to_last_key(testing)
    frames = np.arange(stepped.x.shape[1])
    held = stepped.x[:, frames - frames % EVERY]
    filled = {HELD: held, REPEATED: project_repeated(manifold, held), TRUE: stepped.x}
    delayed = stepped.later(DELAY)
    measured = {
        name: (stepped.error(x), delayed.error(x), stepped.jitter(x)) for name, x in filled.items()
    }
    window = len(stepped) // 2
    colours = {HELD: CORRUPTED, REPEATED: PROJECTED, TRUE: TRUTH}
    motions = {name: (stepped.features(filled[name], window), colours[name]) for name in filled}
    rows = [[name, *values] for name, values in measured.items()]
    return Result(
        "Filling in: a missing marker and stepped keyframes",
        [
            Table(
                "Error at the missing joint, cm (root mean square of a coordinate):",
                ["missing joint", MEAN_POSE, NETWORK],
                [[joint, *errors] for joint, errors in wrists.items()],
                best="low across",
            ),
            Table(f"{STEPPED}:", ["method", "error, cm", "delayed, cm", "jitter, m/s²"], rows),
        ],
        [_wrist_claim(np.array(list(wrists.values()))), *_stepped_claims(measured)],
        *moving(motions, manifold.rate),
        sample,
    )


def _up_to_last_key(clips: Clips) -> Clips:
    """Only frames between two keys count; windows with one key are left out."""
    frames = np.count_nonzero(clips.real, axis=1)
    last = (frames - 1) // EVERY * EVERY
    between = np.arange(clips.real.shape[1]) <= last[:, None]
    return clips.where(last > 0, between)


def _wrist_claim(errors: np.ndarray) -> Claim:
    mean, network = np.sqrt(np.mean(errors**2, axis=0))
    return Claim(
        "Projection infers the position of a wrist whose marker is missing (holden2015, section 7; "
        f"confirmed if the error is below {TARGET} of the mean pose's).",
        bool(network < TARGET * mean),
        f"{network:.2f} cm, the mean pose {mean:.2f} cm, {network / mean:.2f} of it.",
    )


def _stepped_claims(measured: dict[str, tuple[float, float, float]]) -> list[Claim]:
    held, held_delayed, held_jitter = measured[HELD]
    error, delayed, jitter = measured[REPEATED]
    truth = measured[TRUE][2]
    return [
        Claim(
            "Projection inserts smooth transitions between stepped keyframes (holden2015, section "
            "7; confirmed if the jitter differs from the truth's by less than half of it).",
            abs(jitter - truth) < truth / 2,
            f"{held_jitter:.1f} m/s² held, {jitter:.1f} projected, truth {truth:.1f}.",
        ),
        Claim(
            "The inserted transitions correspond to motion (section 7; confirmed if they are "
            "nearer to the true motion than the held keys are, both undelayed and delayed).",
            error < held and delayed < held_delayed,
            f"{held:.2f} cm held, {error:.2f} cm projected; delayed {held_delayed:.2f} and "
            f"{delayed:.2f} cm.",
        ),
    ]
