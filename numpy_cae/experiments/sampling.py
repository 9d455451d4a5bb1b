"""New motion from a prior: holden2015, section 3.

Φ† "always produces" motion "within the subspace of valid human motion", and "the uniform
distribution of values […] drawn from [-1, 1]^(i×k) represents a prior probability distribution
over the space of human motion which can be augmented with other beliefs". The uniform prior is
compared with the prior of `numpy-cae sample`.
"""

from dataclasses import astuple

import numpy as np

from numpy_cae.evaluation import Validity, ValidityMeasure
from numpy_cae.experiments.material import Material, features_of
from numpy_cae.experiments.result import Claim, Result, Table, moving
from numpy_cae.manifold import MotionManifold, NeighbourPrior, sample
from numpy_cae.manifold.sample import encode_windows
from numpy_cae.viz import CORRUPTED, PROJECTED

DRAWN = 24
"""Motions drawn from each prior."""
SLACK = 1.25
"""At most so many times the error of projected real motion counts as valid."""
REAL, PROJECTED_REAL = "test takes", "test takes, projected"
UNIFORM, FITTED = "uniform prior", "fitted prior"


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Draw motions from each prior and measure their validity beside that of real motions.

    Raises ValueError where no training take is as long as a window.
    """
    rng = np.random.default_rng(seed)
    training = features_of(manifold, material.training)
    testing = features_of(manifold, material.testing)
    encoded = encode_windows(manifold, training)
    prior, frames = NeighbourPrior(encoded), encoded.shape[1] * manifold.network.stride
    drawn = {
        UNIFORM: [sample(manifold, frames, rng) for _ in range(DRAWN)],
        FITTED: [sample(manifold, frames, rng, prior) for _ in range(DRAWN)],
    }
    clips = {REAL: testing, PROJECTED_REAL: [manifold.project(take) for take in testing], **drawn}
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    measured = {name: Validity.mean([measure.of(x) for x in clips[name]]) for name in clips}
    rows = [[name, *astuple(each)] for name, each in measured.items()]
    caption = f"Mean over {DRAWN} motions drawn from each prior:"
    motions = {UNIFORM: (drawn[UNIFORM][0], CORRUPTED)}
    for letter, motion in zip("abc", drawn[FITTED], strict=False):
        motions[f"{FITTED}, {letter}"] = motion, PROJECTED
    return Result(
        "Sampling from a prior",
        [Table(caption, ["motion", *Validity.HEADER], rows, Validity.FORMATS)],
        [
            _claim(
                "The uniform distribution over [-1, 1] is a prior over the space of human motion: "
                "its inverse projection is valid motion (holden2015, section 3).",
                measured[UNIFORM],
                measured[PROJECTED_REAL],
            ),
            _claim(
                "The prior can be augmented with other beliefs (holden2015, section 3): fitted to "
                "encoded motion, it gives motion as valid as projected real motion.",
                measured[FITTED],
                measured[PROJECTED_REAL],
            ),
        ],
        *moving(motions, manifold.rate),
    )


def _claim(sentence: str, made: Validity, real: Validity) -> Claim:
    confirmed = all(
        getattr(made, name) <= SLACK * getattr(real, name)
        for name in ("bone_length", "foot_sliding", "jitter", "nearest_pose")
    )
    return Claim(
        sentence,
        confirmed,
        f"{made.against(real)} of the projected test takes. Confirmed if at most {SLACK} times "
        "theirs in bone length, sliding, jitter and nearest pose.",
    )
