"""Measure new motion from a prior beside real motion: holden2015, section 3.

    python -m studies sampling --data bandai --test '*_005.bvh' -m best.npz

docs/lab_book/sampling.md has the findings.

Φ† "always produces" motion "within the subspace of valid human motion", and "the uniform
distribution of values […] drawn from [-1, 1]^(i×k) represents a prior probability distribution
over the space of human motion which can be augmented with other beliefs". The uniform prior is
compared with the prior of `numpy-cae sample`, with independent normal units, and with the simplest
prior, which replays a training window. "It is easy to find a configuration in this space which does
not represent valid human motion" (section 1): values of the features are drawn by themselves.
"""

from dataclasses import astuple

import numpy as np

from numpy_cae.manifold import MotionManifold, NeighbourPrior, sample
from numpy_cae.manifold.sampling import encode_windows
from numpy_cae.viz import CORRUPTED, PROJECTED
from studies.shared.judging import Interval, all_of, ratio_of_samples
from studies.shared.material import Material, evenly, features_of
from studies.shared.result import Claim, Result, moving
from studies.shared.validity import Validity, ValidityMeasure, validity_table

DRAWN = 24
"""Motions drawn from each prior."""
TAKES = 40
"""At most this many test takes are projected."""
SLACK = 1.25
"""A motion is valid if each error is at most this many times that of projected motion, and the
jitter between 1 / SLACK and SLACK times."""
REAL = "test takes"
PROJECTED_REAL = "test takes, projected"
UNIFORM = "uniform prior"
FITTED = "fitted prior"
NORMAL = "independent normal units"
REPLAYED = "a training window, replayed"
VALUES = "independent values of the features"
VALUES_DRAWN = 8
"""Motions of independent values that are drawn."""
INVALID = 2.0
"""A motion is invalid if each measure is more than this many times that of test takes."""
STATEMENTS = {UNIFORM: "uniform_prior", FITTED: "other_prior"}


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Draw motions from each prior and measure their validity beside that of real motions.

    Raises ValueError where no training take is as long as a window.
    """
    rng = np.random.default_rng(seed)
    training = features_of(manifold, material.training)
    testing = features_of(manifold, evenly(material.testing, TAKES))
    encoded = encode_windows(manifold, training)
    frames = encoded.shape[1] * manifold.network.stride
    priors = {FITTED: NeighbourPrior(encoded), NORMAL: NormalUnits(encoded)}
    clips = {
        REAL: testing,
        PROJECTED_REAL: [manifold.project(take) for take in testing],
        UNIFORM: [sample(manifold, frames, rng) for _ in range(DRAWN)],
    }
    for name, prior in priors.items():
        clips[name] = [sample(manifold, frames, rng, prior) for _ in range(DRAWN)]
    clips[REPLAYED] = [sample(manifold, frames, rng, Replay(encoded)) for _ in range(DRAWN)]
    clips[VALUES] = draw_values(training, frames, rng)
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    measured = {source: measure.each(motions) for source, motions in clips.items()}
    means = {source: Validity.mean(of_clips) for source, of_clips in measured.items()}
    caption = f"Mean over {DRAWN} motions drawn from each prior:"
    motions = {UNIFORM: (clips[UNIFORM][0], CORRUPTED)}
    for letter, motion in zip("abc", clips[FITTED], strict=False):
        motions[f"{FITTED}, {letter}"] = motion, PROJECTED
    return Result(
        "Sampling from a prior",
        [validity_table(caption, means)],
        [
            *(_claim(key, prior, measured) for prior, key in STATEMENTS.items()),
            _claim_of_values(measured),
        ],
        {"sampling": moving(motions, manifold.rate)},
    )


class Replay(NeighbourPrior):
    """The simplest prior: a training window as it was encoded, and nothing new."""

    def _window(self, rng: np.random.Generator) -> np.ndarray:
        return self.encoded[rng.integers(len(self.encoded))]


class NormalUnits(NeighbourPrior):
    """Every unit by itself from the normal distribution of its encoded values, within [-1, 1]."""

    def _window(self, rng: np.random.Generator) -> np.ndarray:
        mean = self.encoded.mean(axis=(0, 1))
        deviation = self.encoded.std(axis=(0, 1))
        y = mean + deviation * rng.standard_normal(self.encoded.shape[1:])
        return y.clip(-1, 1).astype(np.float32)


def draw_values(
    training: list[np.ndarray], frames: int, rng: np.random.Generator
) -> list[np.ndarray]:
    """Motions (frames, 63) of which every value is drawn by itself from the normal distribution of
    its feature in training motions."""
    poses = np.concatenate(training)
    mean = poses.mean(axis=0)
    deviation = poses.std(axis=0)
    shape = (frames, poses.shape[1])
    return [mean + deviation * rng.standard_normal(shape) for _ in range(VALUES_DRAWN)]


def _claim_of_values(measured: dict[str, list[Validity]]) -> Claim:
    """Whether independent values are no valid motion."""
    is_invalid = {}
    listed = {}
    for name in (VALUES, REPLAYED):
        ratios = _ratios(measured[name], measured[REAL])
        is_invalid[name] = all_of(*(ratio.above(INVALID) for ratio in ratios.values()))
        listed[name] = ", ".join(f"{measure} {ratio:.2f}" for measure, ratio in ratios.items())
    return Claim(
        "easily_invalid",
        is_invalid[VALUES],
        f"times those of test takes: {listed[VALUES]};",
        opponent=f"{REPLAYED}: {listed[REPLAYED]}.",
        fulfilled_by=REPLAYED if is_invalid[REPLAYED] else "",
    )


def _claim(key: str, source: str, measured: dict[str, list[Validity]]) -> Claim:
    """Whether motions of a prior are as valid as projected takes, beside a replayed window."""
    listed = {}
    also = []
    for name in (source, NORMAL, REPLAYED):
        ratios = _ratios(measured[name], measured[PROJECTED_REAL])
        listed[name] = ", ".join(f"{measure} {ratio:.2f}" for measure, ratio in ratios.items())
        if name != source and _is_valid(ratios):
            also.append(name)
    return Claim(
        key,
        _is_valid(_ratios(measured[source], measured[PROJECTED_REAL])),
        f"times those of projected test takes: {listed[source]};",
        opponent=f"{REPLAYED}: {listed[REPLAYED]}; {NORMAL}: {listed[NORMAL]}.",
        fulfilled_by=" and ".join(also),
    )


def _ratios(sampled: list[Validity], real: list[Validity]) -> dict[str, Interval]:
    """Name of each measure to its mean over the samples, divided by that over real motions."""
    of_samples = np.array([astuple(validity) for validity in sampled])
    of_takes = np.array([astuple(validity) for validity in real])
    ratios = {}
    for heading, ours, theirs in zip(Validity.HEADER, of_samples.T, of_takes.T, strict=True):
        ratios[heading.split(",")[0]] = ratio_of_samples(ours, theirs)
    return ratios


def _is_valid(ratios: dict[str, Interval]) -> bool | None:
    """Whether bones, sliding and distance to the nearest pose are small, and the jitter real."""
    parts = [ratio.at_most(SLACK) for ratio in ratios.values()]
    return all_of(*parts, ratios["jitter"].above(1 / SLACK))
