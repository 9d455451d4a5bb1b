"""What jang2018 names its manifold for and does not show: denoising, interpolation and analogy.

denoising      noise of σ standard deviations on every number of held-out clips; the error of what
               the network makes of them against the clean clips
interpolation  the middle of two held-out clips: how far it is from the nearest held-out clip of a
               third take, over what real training clips are from theirs
analogy        "a is to b as c is to ?": a tired and b neutral of one person, c neutral of another.
               Is the nearest of real clips, of every style, a tired one? With single clips, as in
               the paper, and with a mean of many in place of a - b.

Beside each the simplest thing that could be done without a network, in the space of the clips.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from data_synth import make_take
from numpy_cae.baselines import PCA, savitzky_golay
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.reconstruction import leading_axes
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.experiments.table import text_table
from numpy_cae.measures import clip_distances, nearest_distance
from numpy_cae.motion import ANGLE_RATE, PARENTS, angles_of, body_positions, cut_clips
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, save_figure, save_gif, strip_figure

SIGMAS = (0.25, 0.5, 1.0)
FILTERS = (5, 9, 15, 25)
"""Frames of Savitzky and Golay's parabola; the best on the clips themselves is used."""
PAIRS = 100
ANALOGIES, OF_A_STYLE = 30, 8
"""Analogies made, and people from whom a mean style is taken."""
NETWORK, LINEAR, LOW_PASS, NOTHING = "the network", "PCA", "low-pass", "doing nothing"
STRAIGHT, TRAINING = "straight line of clips", "real training clips"
SINGLE, MANY, IN_POSES, COPY = (
    "the network, single clips",
    "the network, mean of many",
    "the same in the space of clips",
    "c itself",
)
NEUTRAL, TIRED = "neutral", "tired"
_COLOURS = {"noisy": CORRUPTED, "from the manifold": PROJECTED, "a - b + c": PROJECTED}


@dataclass(frozen=True)
class SequenceUses:
    """Tables of one action; `analogies` is empty where no styles are known.

    Parameters
    ----------
    denoised : σ to method to mean squared error, standardised
    between : method to distance to the nearest held-out clip, over that of real training clips
    analogies : method to the share whose nearest real clip has the style that was asked for
    chance : float
        Share of real clips that have it.
    shown : use to label to positions (F, 20, 3)
    """

    action: str
    denoised: dict[float, dict[str, float]]
    between: dict[str, float]
    analogies: dict[str, float]
    chance: float
    shown: dict[str, dict[str, np.ndarray]]
    rate: float

    @property
    def title(self) -> str:
        """What is told."""
        return f"Denoising, interpolation and analogy on jang2018's manifold of {self.action}"

    def text(self) -> str:
        """All tables."""
        methods = list(next(iter(self.denoised.values())))
        rows = [
            [f"{sigma:g}", *(f"{errors[m]:.3f}" for m in methods)]
            for sigma, errors in self.denoised.items()
        ]
        parts = [
            "Noise of σ on every number: mean squared error against the clean clip, "
            f"standardised\n\n{text_table(['σ', *methods], rows)}",
            "Halfway between two clips: distance to the nearest held-out clip, over that of real "
            "training clips\n\n"
            + text_table(["motion", "near"], [[n, f"{v:.2f}"] for n, v in self.between.items()]),
        ]
        if self.analogies:
            rows = [[name, f"{share:.0%}"] for name, share in self.analogies.items()]
            parts.append(
                "Tired to neutral as ? to another person's neutral: the nearest real clip is a "
                f"tired one; {self.chance:.0%} of them are\n\n"
                + text_table(["analogy", "found tired"], rows)
            )
        return "\n\n".join(parts)

    def findings(self) -> list[Finding]:
        """What the poster's use of a manifold would need."""
        wins = [s for s, e in self.denoised.items() if min(e, key=e.get) == NETWORK]
        middle = self.denoised[SIGMAS[1]]
        found = [
            Finding(
                f"The manifold denoises {self.action} better than PCA with as many numbers and a "
                "low-pass filter do (not shown in jang2018).",
                len(wins) == len(self.denoised),
                f"best at σ = {', '.join(f'{s:g}' for s in wins) or 'none'}; at σ = {SIGMAS[1]:g} "
                + ", ".join(f"{name} {error:.3f}" for name, error in middle.items()) + ".",
            ),
            Finding(
                f"Between two clips of {self.action} the manifold has clips nearer to real ones "
                "than the straight line has (not shown in jang2018).",
                self.between[NETWORK] < self.between[STRAIGHT],
                ", ".join(f"{name} {near:.2f}" for name, near in self.between.items())
                + " of what real clips have.",
            ),
        ]  # fmt: skip
        if self.analogies:
            ours = self.analogies[SINGLE]
            found.append(
                Finding(
                    f"An analogy of three clips carries a style of {self.action} from one person "
                    "to another, more often than arithmetic on the clips does (not shown in "
                    "jang2018).",
                    ours > max(self.analogies[IN_POSES], self.analogies[COPY]),
                    ", ".join(f"{name} {share:.0%}" for name, share in self.analogies.items())
                    + f", chance {self.chance:.0%}.",
                )
            )
        return found

    def save_picture(self, path: str | Path) -> None:
        """Strips of one of each."""
        save_figure(strip_figure(self._actors(), self.rate, azimuth=75.0), path)

    def save_gif(self, path: str | Path) -> None:
        """The same, moving."""
        save_gif(self._actors(), path, self.rate, fps=12.5, azimuth=75.0)

    def _actors(self) -> list[Actor]:
        return [
            Actor(x, PARENTS, f"{use}: {label}", _COLOURS.get(label, TRUTH))
            for use, motions in self.shown.items()
            for label, x in motions.items()
        ]


def uses(study: Study, seed: int = 0) -> SequenceUses:
    """Denoise, interpolate and, of synthetic actions with styles, make analogies.

    Parameters
    ----------
    study : Study
    seed : int
        Of noise, pairs and people.
    """
    rng = np.random.default_rng([seed, 5])
    clips = study.drawn(2 * PAIRS, seed + 3, training=False)
    denoised, noisy = _denoised(study, clips, rng)
    between = _between(study, clips, seed)
    analogies, chance, made = {}, 0.0, {}
    if {NEUTRAL, TIRED} <= set(study.action.styles):
        analogies, chance, made = _analogies(study, seed)

    def seen(clip: np.ndarray) -> np.ndarray:
        return body_positions(study.manifold.motion(clip))

    network = study.manifold.network
    middle = network.interpolate(clips[:1], clips[1:2], np.array([0.5]))[0, 0]
    shown = {
        "denoising": {
            "noisy": seen(noisy[0]),
            "from the manifold": seen(network.denoise(noisy[:1])[0]),
            "real": seen(clips[0]),
        },
        "between": {"one": seen(clips[0]), "from the manifold": seen(middle),
                    "the other": seen(clips[1])},
    }  # fmt: skip
    if made:
        shown["analogy"] = {label: seen(clip) for label, clip in made.items()}
    return SequenceUses(
        study.action.name, denoised, between, analogies, chance, shown, study.manifold.rate
    )


def _denoised(study: Study, clips: np.ndarray, rng: np.random.Generator):
    """Errors by σ and method, and clips with the noise that is shown."""
    pca = leading_axes(study, study.manifold.network.latent, rng.integers(2**31))
    errors = {}
    for sigma in SIGMAS:
        noisy = clips + sigma * rng.standard_normal(clips.shape).astype(clips.dtype)
        made = {
            NOTHING: [noisy],
            LINEAR: [_projected(pca, noisy)],
            LOW_PASS: [savitzky_golay(noisy, length, 2) for length in FILTERS],
            NETWORK: [study.manifold.network.denoise(noisy)],
        }
        errors[sigma] = {
            name: min(float(np.mean((x - clips) ** 2, dtype=np.float64)) for x in options)
            for name, options in made.items()
        }
        if sigma == SIGMAS[1]:
            shown = noisy
    return errors, shown


def _projected(pca: PCA, clips: np.ndarray) -> np.ndarray:
    rows = clips.reshape(len(clips), -1).astype(np.float64)
    return pca.project(rows, len(pca.axes)).reshape(clips.shape)


def _between(study: Study, clips: np.ndarray, seed: int) -> dict[str, float]:
    one, other = clips[:PAIRS], clips[PAIRS:]
    real = study.drawn(10 * PAIRS, seed + 4, training=False)
    made = {
        NETWORK: study.manifold.network.interpolate(one, other, np.array([0.5]))[:, 0],
        STRAIGHT: (one + other) / 2,
        "the ends, decoded": study.manifold.network.denoise(clips),
    }
    usual = nearest_distance(study.drawn(2 * PAIRS, seed + 5), real)
    return {name: nearest_distance(x, real) / usual for name, x in made.items()} | {TRAINING: 1.0}


def _analogies(study: Study, seed: int):
    """Shares found tired by method, the share that is, and one analogy to be shown."""
    frames, kind = study.manifold.settings["frames"], study.action.name

    def clips(style: str, people: range) -> np.ndarray:
        takes = [make_take(kind, 1_000_000 + 1000 * seed + p, frames / ANGLE_RATE + 0.2,
                           ANGLE_RATE, style) for p in people]  # fmt: skip
        cut = cut_clips([angles_of(take.motion) for take in takes], frames, frames)
        return study.manifold.normalise(cut)

    people, others = range(ANALOGIES), range(ANALOGIES, 2 * ANALOGIES)
    a, b, c = clips(TIRED, people), clips(NEUTRAL, people), clips(NEUTRAL, others)
    known = {style: clips(style, range(100, 100 + ANALOGIES)) for style in study.action.styles}
    whose = np.repeat(np.array(list(known)), [len(each) for each in known.values()])
    real, network = np.concatenate(list(known.values())), study.manifold.network
    manner = np.mean(network.encode(a[:OF_A_STYLE]) - network.encode(b[:OF_A_STYLE]), axis=0)
    made = {
        SINGLE: network.analogy(a, b, c),
        MANY: network.decode(network.encode(c) + manner, frames),
        IN_POSES: a - b + c,
        COPY: c,
    }
    found = {
        name: float(np.mean(whose[clip_distances(x, real).argmin(axis=1)] == TIRED))
        for name, x in made.items()
    }
    shown = {"a, tired": a[0], "b, neutral": b[0], "c, neutral": c[0], "a - b + c": made[SINGLE][0]}
    return found, float(np.mean(whose == TIRED)), shown
