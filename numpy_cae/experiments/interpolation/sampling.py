"""New motion from a prior: holden2015, section 3.

Φ† "always produces" motion "within the subspace of valid human motion", and "the uniform
distribution of values […] drawn from [-1, 1]^(i×k) represents a prior probability distribution
over the space of human motion which can be augmented with other beliefs". The uniform prior is
compared with a Gaussian fitted to encoded windows and with the prior of `numpy-cae sample`.
"""

from __future__ import annotations

from dataclasses import astuple

import numpy as np

from numpy_cae.baselines import PCA
from numpy_cae.experiments.material import Material, features_of
from numpy_cae.experiments.result import Claim, Result, Table, moving
from numpy_cae.manifold import MotionManifold, NeighbourPrior, sample
from numpy_cae.manifold.sample import decode_units, encode_windows
from numpy_cae.measures import Validity, ValidityMeasure
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED

DRAWN = 24
"""Motions drawn from each prior."""
AXES = 100
"""Of the Gaussian: more than nine tenths of the variance of the hidden units."""
SLACK = 1.25
"""At most so many times the error of projected real motion counts as valid."""
REAL, PROJECTED_REAL = "test takes", "test takes, projected"
UNIFORM, GAUSSIAN, FITTED = "uniform prior", "Gaussian of windows", "fitted prior"


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Draw motions from each prior and measure their validity beside that of real motions.

    Raises ValueError where no training take is as long as a window.
    """
    rng = np.random.default_rng(seed)
    training = features_of(manifold, material.training)
    testing = features_of(manifold, material.testing)
    encoded = encode_windows(manifold, training)
    prior, frames = NeighbourPrior(encoded), encoded.shape[1] * manifold.network.frames_per_unit
    drawn = {
        UNIFORM: [sample(manifold, frames, rng) for _ in range(DRAWN)],
        GAUSSIAN: _from_gaussian(manifold, encoded, rng),
        FITTED: [sample(manifold, frames, rng, prior) for _ in range(DRAWN)],
    }
    clips = {REAL: testing, PROJECTED_REAL: [manifold.project(take) for take in testing], **drawn}
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    measured = {name: Validity.mean([measure.of(x) for x in clips[name]]) for name in clips}
    rows = [[name, *astuple(each)] for name, each in measured.items()]
    caption = f"Mean over {DRAWN} motions drawn from each prior:"
    motions = {UNIFORM: (drawn[UNIFORM][0], CORRUPTED), GAUSSIAN: (drawn[GAUSSIAN][0], PLAIN)}
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
        *moving(motions, manifold.rate, seconds=5.0),
    )


def _claim(sentence: str, made: Validity, real: Validity) -> Claim:
    held = all(
        getattr(made, name) <= SLACK * getattr(real, name)
        for name in ("bone_length", "foot_sliding", "jitter", "nearest_pose")
    )
    return Claim(
        sentence,
        held,
        f"{made.against(real)} of the projected test takes. Held if at most {SLACK} times theirs "
        "in bone length, sliding, jitter and nearest pose.",
    )


def _from_gaussian(
    manifold: MotionManifold, encoded: np.ndarray, rng: np.random.Generator
) -> list[np.ndarray]:
    """Y = m + Σ_i σ_i ε_i u_i, clipped to [-1, 1]: windows drawn from one Gaussian."""
    flat = encoded.reshape(len(encoded), -1).astype(np.float64)
    pca = PCA.fit(flat)
    axes = pca.axes[:AXES]
    spread = ((flat - pca.mean) @ axes.T).std(axis=0)
    drawn = pca.mean + (rng.standard_normal((DRAWN, len(axes))) * spread) @ axes
    y = np.clip(drawn, -1, 1).reshape(DRAWN, *encoded.shape[1:]).astype(encoded.dtype)
    return [decode_units(manifold, one) for one in y]
