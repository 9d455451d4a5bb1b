"""Samples of jang2018's manifolds: `figure_3` draws samples, `samples` measures them in a table.

The poster samples "from trained multinomial motion manifold distribution". We take this to be a
multivariate normal distribution, fitted to the latent vectors of the training clips. If the
regulariser succeeds, this distribution equals the prior. Samples of both are drawn and measured.

near           mean distance to the nearest held-out clip, relative to that of training clips
distinguished  accuracy of a 1-nearest-neighbour two-sample test against held-out clips; 50% is
               perfect
diversity      mean distance between two samples, relative to that between two held-out clips

`regulariser` compares the regulariser of jang2018 with none, λ = 0, and with MMD: do latent vectors
match the prior, at what cost of reconstruction, and what do samples of the prior look like?
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from numpy_cae.evaluation import (
    PCA,
    angle_distance,
    diversity,
    foot_sliding,
    jitter,
    nearest_distance,
    nearest_neighbour_accuracy,
)
from numpy_cae.evaluation.tables import Table
from numpy_cae.motion.joints import PARENTS
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH, Actor, strip_figure
from studies.jang2018.behaviours import SHOWN, STANDING, count_behaviours
from studies.jang2018.training import CLIPS, Study, discrepancy
from studies.shared.result import Claim, Picture, Result

SHOWN_IN_PAPER = 16
"""Samples of an action."""
FITTED = "fitted"
PRIOR = "prior"
REAL = "test"
PRINCIPAL = "PCA"
TRAINING = "training"
COLOURS = {FITTED: PROJECTED, PRIOR: PLAIN, REAL: TRUTH}
MOVED = 40
"""Clips whose jitter and sliding are measured."""
SAMPLES = 100
"""Clips from each source that are measured."""
HEADER = ("samples from", "near", "distinguished", "diversity", "jitter", "sliding")
FORMATS = ("", ".2f", ".0%", ".2f", ".2f", ".2f")
NATURAL = 1.25
"""Samples are natural if their distance to real clips, their jitter and their sliding are at most
this many times those of other real clips, and …"""
TOLD = 0.05
"""… a classifier tells them from real clips at most so much better."""
PCA_CLIPS = 1000
"""Training clips to which PCA is fitted."""


def fitted_latents(study: Study, count: int, seed: int) -> np.ndarray:
    """Draws (count, D) from the normal distribution fitted to the encoded training clips."""
    z = study.manifold.network.encode(study.random_clips(CLIPS, seed)).astype(np.float64)
    rng = np.random.default_rng([seed, 1])
    drawn = rng.multivariate_normal(z.mean(axis=0), np.cov(z, rowvar=False), count)
    return drawn.astype(study.manifold.network.weights["state_w"].dtype)


def sample_clips(study: Study, source: str, count: int, seed: int) -> np.ndarray:
    """Normalised clips (count, F, 54) from FITTED or PRIOR, or REAL ones of the test motions."""
    network = study.manifold.network
    frames = study.manifold.frames
    if source == FITTED:
        return network.decode(fitted_latents(study, count, seed), frames)
    if source == PRIOR:
        return network.sample(count, np.random.default_rng([seed, 2]), frames)
    if source == PRINCIPAL:
        return sample_principal(study, count, seed)
    return study.random_clips(count, seed, training=source == TRAINING)


def sample_principal(study: Study, count: int, seed: int) -> np.ndarray:
    """Clips (count, F, 54) of the simplest manifold: as many principal components of whole training
    clips as z has numbers, each drawn from the normal distribution of its variance."""
    fitted = study.random_clips(PCA_CLIPS, seed)
    rows = fitted.reshape(len(fitted), -1)
    pca = PCA.fit(rows)
    axes = pca.axes[: study.manifold.network.latent]
    deviation = ((rows - pca.mean) @ axes.T).std(axis=0)
    rng = np.random.default_rng([seed, 3])
    scores = deviation * rng.standard_normal((count, len(axes)))
    clips = (pca.mean + scores @ axes).reshape(count, *fitted.shape[1:])
    return clips.astype(fitted.dtype)


def figure_3(study: Study, seed: int = 0, source: str = FITTED) -> Picture:
    """Draw sixteen clips from one source as strips; clips from FITTED also move."""
    clips = sample_clips(study, source, SHOWN_IN_PAPER, seed)
    actors = [
        Actor(study.positions(clip), PARENTS, f"{source} {number}", COLOURS[source])
        for number, clip in enumerate(clips, start=1)
    ]
    rate = study.manifold.rate
    shown = actors if source == FITTED else []
    return Picture(lambda: strip_figure(actors, rate), shown, rate)


def samples(studies: Sequence[Study], seed: int = 0) -> Result:
    """Draw clips from each source and study, and measure them."""
    rows: list[list] = []
    for study in studies:
        rows += _rows(study, seed)
    caption = "Samples compared with test clips; training clips, as real ones, have 1 but for the "
    caption += "share that is distinguished:"
    table = Table(caption, HEADER, rows, FORMATS)
    claims = [_claim_of_nature(table, studies)]
    periodic = [study.action.periodic for study in studies]
    if any(periodic) and not all(periodic):
        differences = {}
        for source in (FITTED, PRINCIPAL, REAL):
            differences[source] = [_difference(study, source, seed) for study in studies]
        claims.append(_claim_of_variety(differences, np.array(periodic)))
    for study in studies:
        if study.action.name == "waiting":
            claims.append(_claim_of_behaviours(study, seed))
    return Result("Samples of jang2018's manifolds compared with test clips", [table], claims)


def _claim_of_nature(table: Table, studies: Sequence[Study]) -> Claim:
    """Whether random points of the prior become clips as natural as real ones."""
    is_natural = {}
    figures = {}
    for source in (PRIOR, PRINCIPAL):
        of_actions = []
        listed = []
        for study in studies:
            name = f"{study.action.name}: {source}"
            near, told, _, trembling, sliding = [table.value(name, title) for title in HEADER[1:]]
            real = table.value(f"{study.action.name}: {TRAINING}", "distinguished")
            ratios = max(near, trembling, sliding)
            of_actions.append(bool(told <= real + TOLD and ratios <= NATURAL))
            listed.append(
                f"{study.action.name} {told:.0%} distinguished (real {real:.0%}), distance "
                f"{near:.2f}, jitter {trembling:.2f}, sliding {sliding:.2f}"
            )
        is_natural[source] = all(of_actions)
        figures[source] = "; ".join(listed)
    return Claim(
        "samples_natural",
        is_natural[PRIOR],
        f"{figures[PRIOR]};",
        opponent=f"PCA: {figures[PRINCIPAL]}.",
        fulfilled_by="PCA with as many numbers" if is_natural[PRINCIPAL] else "",
    )


def _difference(study: Study, source: str, seed: int) -> float:
    """How much as many clips as figure 3 has differ: the mean over all pairs, in radians."""
    clips = study.manifold.denormalise(sample_clips(study, source, SHOWN_IN_PAPER, seed))
    pairs = combinations(clips, 2)
    return float(np.mean([distance_at_best_shift(first, second) for first, second in pairs]))


def distance_at_best_shift(a: np.ndarray, b: np.ndarray) -> float:
    """The distance of two clips (F, 54) in the joint angles, in radians, at the shift of up to half
    a clip that makes it least: walking is alike at every phase of the step."""
    frames = len(a)
    distances = []
    for shift in range(frames // 2 + 1):
        distances.append(angle_distance(a[shift:], b[: frames - shift]))
        distances.append(angle_distance(b[shift:], a[: frames - shift]))
    return min(distances)


def _claim_of_variety(differences: dict[str, list[float]], periodic: np.ndarray) -> Claim:
    """Whether samples of the periodic action differ less than those of the others."""
    is_lower = {}
    listed = {}
    for source, values in differences.items():
        of_periodic = np.array(values)[periodic]
        aperiodic = np.array(values)[~periodic]
        is_lower[source] = bool(of_periodic.max() < aperiodic.min())
        listed[source] = f"{of_periodic.max():.2f} and {_listed(aperiodic, 2)}"
    return Claim(
        "samples_vary",
        is_lower[FITTED],
        f"{listed[FITTED]} rad for the periodic action and the others (real clips {listed[REAL]});",
        opponent=f"PCA {listed[PRINCIPAL]}.",
        fulfilled_by="PCA with as many numbers" if is_lower[PRINCIPAL] else "",
    )


def _claim_of_behaviours(study: Study, seed: int) -> Claim:
    """Whether samples of waiting show every behaviour of figure 3."""
    shows_all = {}
    listed = {}
    for source in (PRIOR, PRINCIPAL):
        clips = sample_clips(study, source, SHOWN_IN_PAPER, seed)
        counts = count_behaviours(study, clips, seed)
        shows_all[source] = all(counts[behaviour] for behaviour in SHOWN)
        listed[source] = ", ".join(f"{label} {counts[label]}" for label in (*SHOWN, STANDING))
    return Claim(
        "behaviours_reconstructed",
        shows_all[PRIOR],
        f"of {SHOWN_IN_PAPER} samples {listed[PRIOR]};",
        opponent=f"PCA {listed[PRINCIPAL]}.",
        fulfilled_by="PCA with as many numbers" if shows_all[PRINCIPAL] else "",
    )


def _rows(study: Study, seed: int) -> list[list]:
    """A row for each source: all but the share that is distinguished relative to training clips."""
    held_out = study.random_clips(SAMPLES, seed, training=False)
    measured = {}
    for source in (FITTED, PRIOR, PRINCIPAL, TRAINING):
        number = seed + 1 if source == TRAINING else seed
        clips = sample_clips(study, source, SAMPLES, number)
        positions = [study.positions(clip) for clip in clips[:MOVED]]
        rate = study.manifold.rate
        measured[source] = (
            nearest_distance(clips, held_out),
            nearest_neighbour_accuracy(held_out, clips),
            diversity(clips),
            float(np.mean([jitter(points, rate) for points in positions])),
            float(np.mean([foot_sliding(points, rate) for points in positions])),
        )
    real = measured[TRAINING]
    rows = []
    for source, values in measured.items():
        ratios = [value / max(of_real, 1e-9) for value, of_real in zip(values, real, strict=True)]
        ratios[1] = values[1]
        rows.append([f"{study.action.name}: {source}", *ratios])
    return rows


MAX_DISCREPANCY_RATIO = 2.0
"""The discrepancy may be at most this many times that of two draws of the prior."""
REPEATS = 10
"""Measurements in a mean: a single discrepancy varies by a seventh."""
SLICED = "sliced Wasserstein"
MMD = "MMD"
NONE = "none, λ = 0"
REGULARISERS = ("regulariser", "mean square", "to the prior", "of two draws", "distinguished")


def regulariser(
    trained: dict[str, Sequence[Study]], seed: int = 0, repeats: int = REPEATS
) -> Result:
    """Compare studies of the same actions, trained from one seed with each regulariser.

    The seed chooses the clips and draws of the discrepancies, which are sliced Wasserstein
    distances in all rows. "Distinguished" is the accuracy with which samples of the prior are told
    from test clips.
    """
    smallest = prior_discrepancy(trained[SLICED][0].manifold.network.latent, seed)
    rows = []
    errors: dict[str, np.ndarray] = {}
    ratios: dict[str, np.ndarray] = {}
    ratios_in_training: dict[str, np.ndarray] = {}
    told: dict[str, list[float]] = {}
    for name, studies in trained.items():
        distances = [_mean_discrepancy(study, seed, repeats) for study in studies]
        errors[name] = np.array([study.squared_error() for study in studies])
        ratios[name] = np.array(distances) / smallest
        in_training = [_mean_discrepancy(study, seed, repeats, True) for study in studies]
        ratios_in_training[name] = np.array(in_training) / smallest
        measured = zip(studies, errors[name], distances, ratios[name], strict=True)
        for study, error, distance, ratio in measured:
            sampled = sample_clips(study, PRIOR, SAMPLES, seed)
            real = study.random_clips(SAMPLES, seed, training=False)
            accuracy = nearest_neighbour_accuracy(real, sampled)
            told.setdefault(name, []).append(accuracy)
            rows.append([f"{study.action.name}: {name}", error, distance, ratio, accuracy])
    caption = f"Regularisers; two draws of the prior are {smallest:.4f} apart:"
    costs = errors[SLICED] / errors[NONE]
    return Result(
        "The Wasserstein regulariser of jang2018, beside MMD and none",
        [Table(caption, REGULARISERS, sorted(rows), ("", ".3f", ".4f", ".1f", ".0%"))],
        [
            Claim(
                "prior_matched",
                bool((ratios_in_training[SLICED] <= MAX_DISCREPANCY_RATIO).all()),
                f"{_listed(ratios_in_training[SLICED])} times that distance (held-out clips "
                f"{_listed(ratios[SLICED])});",
                opponent=f"MMD {_listed(ratios_in_training[MMD])}, "
                f"λ = 0 {_listed(ratios_in_training[NONE])}.",
            ),
            Claim(
                "regulariser_promotes",
                bool((costs < 1).all()),
                f"error relative to λ = 0: {_listed(costs, 2)};",
                opponent=f"MMD {_listed(errors[MMD] / errors[NONE], 2)}.",
            ),
            _claim_of_regulariser(told),
        ],
    )


def _claim_of_regulariser(told: dict[str, list[float]]) -> Claim:
    """Whether samples of each action are told from real clips less often than those of a network
    without a regulariser."""
    listed = {}
    is_less = {}
    for name, of_actions in told.items():
        listed[name] = ", ".join(f"{accuracy:.0%}" for accuracy in of_actions)
        is_less[name] = all(np.array(of_actions) < told[NONE])
    return Claim(
        "regulariser_natural",
        is_less[SLICED],
        f"{listed[SLICED]} distinguished (50% is perfect);",
        opponent=f"λ = 0 {listed[NONE]}, MMD {listed[MMD]}.",
        fulfilled_by=MMD if is_less[MMD] else "",
    )


def _listed(values: np.ndarray, digits: int = 1) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values)


def prior_discrepancy(latent: int, seed: int = 0) -> float:
    """The mean discrepancy between two draws of the prior: the least that can be expected."""
    rng = np.random.default_rng(seed)
    sizes = REPEATS * [(CLIPS, latent)]
    return float(np.mean([discrepancy(rng.standard_normal(size), rng) for size in sizes]))


def _mean_discrepancy(study: Study, seed: int, repeats: int, training: bool = False) -> float:
    """Of so many draws of held-out clips, or of training clips."""
    rng = np.random.default_rng(seed)
    draws = [study.random_clips(CLIPS, seed + n, training) for n in range(repeats)]
    return float(np.mean([discrepancy(study.manifold.network.encode(x), rng) for x in draws]))
