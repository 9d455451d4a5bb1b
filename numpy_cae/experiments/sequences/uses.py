"""Denoising, interpolation and analogy, which jang2018 names as uses and does not show.

denoising      noise of σ standard deviations on every number of held-out clips; the error of the
               denoised clips against the clean ones
interpolation  the midpoint of two held-out clips: its distance to the nearest held-out clip of a
               third take, relative to that of real training clips
analogy        "a is to b as c is to ?": a tired and b neutral of one person, c neutral of another.
               Is the nearest real clip, among all styles, a tired one?

Each is compared with simpler methods that need no network.
"""

from __future__ import annotations

import numpy as np

from data_synth import make_take
from numpy_cae.baselines import savitzky_golay
from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.experiments.sequences.reconstruction import clip_pca, project_clips
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.measures import clip_distances, nearest_distance
from numpy_cae.motion import ANGLE_RATE, PARENTS, angles_of, cut_clips
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, strip_figure

SIGMAS = (0.25, 0.5, 1.0)
FILTER_FRAMES = (5, 9, 15, 25)
"""Lengths of the Savitzky-Golay filter; the best on the clips themselves is reported."""
PAIRS = 100
ANALOGIES = 30
NETWORK, LINEAR, LOW_PASS, NOTHING = "the network", "PCA", "low-pass", "doing nothing"
STRAIGHT, TRAINING = "straight line of clips", "real training clips"
IN_POSES, COPY = "the same in the space of clips", "c itself"
NEUTRAL, TIRED = "neutral", "tired"

Part = tuple[Table, Claim, list[tuple[str, str, np.ndarray]]]
"""The table and claim of one use, and (label, colour, clip) to be drawn."""


def uses(study: Study, seed: int = 0) -> Result:
    """Denoise, interpolate and, where tired and neutral styles are known, make analogies.

    Parameters
    ----------
    study : Study
    seed : int
        Of noise, pairs and people.
    """
    clips = study.random_clips(2 * PAIRS, seed + 3, training=False)
    parts = [_denoising(study, clips, seed), _interpolation(study, clips, seed)]
    if {NEUTRAL, TIRED} <= set(study.action.styles):
        parts.append(_analogy(study, seed))
    actors = [
        Actor(study.positions(clip), PARENTS, label, colour)
        for _, _, drawn in parts
        for label, colour, clip in drawn
    ]
    rate = study.manifold.rate
    return Result(
        f"Denoising, interpolation and analogy on jang2018's manifold of {study.action.name}",
        [table for table, _, _ in parts],
        [claim for _, claim, _ in parts],
        lambda: strip_figure(actors, rate, azimuth=75.0),
        Animation(actors, rate, azimuth=75.0),
    )


def _denoising(study: Study, clips: np.ndarray, seed: int) -> Part:
    rng = np.random.default_rng([seed, 5])
    network = study.manifold.network
    pca = clip_pca(study, network.latent, rng.integers(2**31))
    lengths = [n for n in FILTER_FRAMES if n <= study.manifold.frames] or [3]
    errors, noisy = {}, {}
    for sigma in SIGMAS:
        x = clips + sigma * rng.standard_normal(clips.shape).astype(clips.dtype)
        noisy[sigma] = x
        errors[sigma] = {
            NOTHING: _error(x, clips),
            LINEAR: _error(project_clips(pca, x), clips),
            LOW_PASS: min(_error(savitzky_golay(x, n, 2), clips) for n in lengths),
            NETWORK: _error(network.denoise(x), clips),
        }
    table = Table(
        "Noise of σ on every number: mean squared error against the clean clip, standardised:",
        ["σ", *errors[SIGMAS[0]]],
        [[f"{sigma:g}", *each.values()] for sigma, each in errors.items()],
        ".3f",
    )
    best = [f"{sigma:g}" for sigma, each in errors.items() if min(each, key=each.get) == NETWORK]
    figures = ", ".join(f"{name} {error:.3f}" for name, error in errors[SIGMAS[1]].items())
    claim = Claim(
        f"The manifold denoises {study.action.name} better than PCA with as many numbers and a "
        "low-pass filter do (not shown in jang2018).",
        len(best) == len(SIGMAS),
        f"best at σ = {', '.join(best) or 'none'}; at σ = {SIGMAS[1]:g} {figures}.",
    )
    drawn = [
        ("denoising: noisy", CORRUPTED, noisy[SIGMAS[1]][0]),
        ("denoising: from the manifold", PROJECTED, network.denoise(noisy[SIGMAS[1]][:1])[0]),
        ("denoising: real", TRUTH, clips[0]),
    ]
    return table, claim, drawn


def _error(x: np.ndarray, truth: np.ndarray) -> float:
    return float(np.mean((x - truth) ** 2, dtype=np.float64))


def _interpolation(study: Study, clips: np.ndarray, seed: int) -> Part:
    network, one, other = study.manifold.network, clips[:PAIRS], clips[PAIRS:]
    real = study.random_clips(10 * PAIRS, seed + 4, training=False)
    middle = network.interpolate(one, other, np.array([0.5]))[:, 0]
    made = {
        NETWORK: middle,
        STRAIGHT: (one + other) / 2,
        "the ends, decoded": network.denoise(clips),
        TRAINING: study.random_clips(2 * PAIRS, seed + 5),
    }
    near = {name: nearest_distance(x, real) for name, x in made.items()}
    near = {name: distance / near[TRAINING] for name, distance in near.items()}
    table = Table(
        "The midpoint of two clips: distance to the nearest held-out clip, relative to that of "
        "real training clips:",
        ["motion", "near"],
        list(near.items()),
    )
    claim = Claim(
        f"Between two clips of {study.action.name} the manifold has clips nearer to real ones than "
        "the straight line has (not shown in jang2018).",
        near[NETWORK] < near[STRAIGHT],
        ", ".join(f"{name} {ratio:.2f}" for name, ratio in near.items())
        + " of what real clips have.",
    )
    drawn = [
        ("between: one", TRUTH, one[0]),
        ("between: from the manifold", PROJECTED, middle[0]),
        ("between: the other", TRUTH, other[0]),
    ]
    return table, claim, drawn


def _analogy(study: Study, seed: int) -> Part:
    frames, network = study.manifold.frames, study.manifold.network

    def clips(style: str, people: range) -> np.ndarray:
        seeds = [1_000_000 + 1000 * seed + person for person in people]
        seconds = frames / ANGLE_RATE + 0.2
        takes = [make_take(study.action.name, n, seconds, ANGLE_RATE, style) for n in seeds]
        cut = cut_clips([angles_of(take.motion) for take in takes], frames, frames)
        return study.manifold.normalise(cut)

    people, others = range(ANALOGIES), range(ANALOGIES, 2 * ANALOGIES)
    a, b, c = clips(TIRED, people), clips(NEUTRAL, people), clips(NEUTRAL, others)
    real = [clips(style, range(100, 100 + ANALOGIES)) for style in study.action.styles]
    styles = np.repeat(study.action.styles, [len(each) for each in real])
    made = {
        NETWORK: network.analogy(a, b, c),
        IN_POSES: a - b + c,
        COPY: c,
    }
    nearest = {
        name: styles[clip_distances(x, np.concatenate(real)).argmin(axis=1)]
        for name, x in made.items()
    }
    tired = {name: float(np.mean(found == TIRED)) for name, found in nearest.items()}
    chance = np.mean(styles == TIRED)
    table = Table(
        "Tired to neutral as ? to another person's neutral: the nearest real clip is a tired one; "
        f"{chance:.0%} of them are:",
        ["analogy", "found tired"],
        list(tired.items()),
        ".0%",
    )
    claim = Claim(
        f"An analogy of three clips carries a style of {study.action.name} from one person to "
        "another, more often than arithmetic on the clips does (not shown in jang2018).",
        tired[NETWORK] > max(tired[IN_POSES], tired[COPY]),
        ", ".join(f"{name} {share:.0%}" for name, share in tired.items())
        + f", chance {chance:.0%}.",
    )
    drawn = [
        ("analogy: a, tired", TRUTH, a[0]),
        ("analogy: b, neutral", TRUTH, b[0]),
        ("analogy: c, neutral", TRUTH, c[0]),
        ("analogy: a - b + c", PROJECTED, made[NETWORK][0]),
    ]
    return table, claim, drawn
