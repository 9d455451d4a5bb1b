"""Measure new motion from a prior beside real motion: holden2015, section 3.

    python -m studies sampling --data bandai --test '*_005.bvh' -m best.npz

docs/lab_book/sampling.md has the findings.

Φ† "always produces" motion "within the subspace of valid human motion", and "the uniform
distribution of values […] drawn from [-1, 1]^(i×k) represents a prior probability distribution
over the space of human motion which can be augmented with other beliefs". The uniform prior is
compared with the prior of `numpy-cae sample`.
"""

from dataclasses import astuple

import numpy as np

from numpy_cae.manifold import MotionManifold, NeighbourPrior, sample
from numpy_cae.manifold.sampling import encode_windows
from numpy_cae.viz import CORRUPTED, PROJECTED
from studies.shared.material import Material, features_of
from studies.shared.result import Claim, Result, moving
from studies.shared.validity import Validity, ValidityMeasure, validity_table

DRAWN = 24
"""Motions drawn from each prior."""
SLACK = 1.25
"""A motion is valid if each error is at most this many times that of projected motion."""
REAL = "test takes"
PROJECTED_REAL = "test takes, projected"
UNIFORM = "uniform prior"
FITTED = "fitted prior"
STATEMENTS = {UNIFORM: "uniform_prior", FITTED: "other_prior"}


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Draw motions from each prior and measure their validity beside that of real motions.

    Raises ValueError where no training take is as long as a window.
    """
    rng = np.random.default_rng(seed)
    training = features_of(manifold, material.training)
    testing = features_of(manifold, material.testing)
    encoded = encode_windows(manifold, training)
    prior = NeighbourPrior(encoded)
    frames = encoded.shape[1] * manifold.network.stride
    clips = {
        REAL: testing,
        PROJECTED_REAL: [manifold.project(take) for take in testing],
        UNIFORM: [sample(manifold, frames, rng) for _ in range(DRAWN)],
        FITTED: [sample(manifold, frames, rng, prior) for _ in range(DRAWN)],
    }
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    measured = {source: measure.mean(motions) for source, motions in clips.items()}
    caption = f"Mean over {DRAWN} motions drawn from each prior:"
    motions = {UNIFORM: (clips[UNIFORM][0], CORRUPTED)}
    for letter, motion in zip("abc", clips[FITTED], strict=False):
        motions[f"{FITTED}, {letter}"] = motion, PROJECTED
    return Result(
        "Sampling from a prior",
        [validity_table(caption, measured)],
        [
            _claim(key, measured[prior], measured[PROJECTED_REAL])
            for prior, key in STATEMENTS.items()
        ],
        {"sampling": moving(motions, manifold.rate)},
    )


def _claim(key: str, sampled: Validity, real: Validity) -> Claim:
    pairs = zip(astuple(sampled), astuple(real), strict=True)
    is_valid = all(error <= SLACK * real_error for error, real_error in pairs)
    return Claim(key, is_valid, f"{sampled.against(real)} of the projected test takes.")
