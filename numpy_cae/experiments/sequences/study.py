"""One training of jang2018's network on one action, watched on motions that it never sees.

error         mean over frames of ‖θ̂ - θ‖, radians: "Euclidean distance … in the joint angle
              space"
discrepancy   the sliced Wasserstein distance between the latent vectors of held-out clips and
              the prior; clips, prior and directions are drawn for this alone
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from numpy_cae import ops
from numpy_cae.experiments.sequences.actions import Action
from numpy_cae.manifold import SequenceManifold, learn_sequences
from numpy_cae.manifold.sequence_learning import HIDDEN, LATENT
from numpy_cae.measures import angle_distance
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.motion import CLIP, cut_clips, draw_clips
from numpy_cae.training import SequenceSchedule, unit_directions

DRAWS = 1000
"""Latent vectors and draws of the prior that a discrepancy is measured with."""
DIRECTIONS = 128
TURNS = 10
"""Times that both are drawn anew where a mean is wanted: one discrepancy varies by a seventh."""
POINTS = 40
"""Of a curve."""


@dataclass(frozen=True)
class Curve:
    """Both errors against the number of steps made, (P,) arrays."""

    steps: np.ndarray
    error: np.ndarray
    discrepancy: np.ndarray


@dataclass(frozen=True)
class Study:
    """A trained manifold, how it came to be where that was watched, and what to measure it on."""

    action: Action
    manifold: SequenceManifold
    curve: Curve | None = None

    def held_out(self) -> np.ndarray:
        """Normalised clips of the motions that nothing was trained on, (N, F, 54)."""
        frames = self.manifold.settings["frames"]
        return self.manifold.normalise(cut_clips(self.action.testing, frames=frames))

    def drawn(self, count: int, seed: int, training: bool = True) -> np.ndarray:
        """Normalised clips that begin anywhere, (count, F, 54)."""
        sequences = self.action.training if training else self.action.testing
        rng = np.random.default_rng(seed)
        frames = self.manifold.settings["frames"]
        return self.manifold.normalise(draw_clips(sequences, count, rng, frames))


def study(
    action: Action,
    schedule: SequenceSchedule | None = None,
    seed: int = 0,
    hidden: int = HIDDEN,
    latent: int = LATENT,
    frames: int = CLIP,
    network: type[SequentialAutoencoder] = SequentialAutoencoder,
    show_progress: bool = True,
) -> Study:
    """Train on one action and measure along the way.

    Parameters
    ----------
    action : Action
    schedule, seed, hidden, latent, frames, network
        As `learn_sequences` takes them.
    """
    schedule = schedule or SequenceSchedule()
    every = max(1, schedule.epochs * schedule.steps // POINTS)
    measured: list[tuple[int, float, float]] = []
    rng = np.random.default_rng([seed, 1])

    def watch(manifold: SequenceManifold, step: int) -> None:
        if step % every == 0:
            # Both errors of the same fresh clips: of all there are takes a third of the training.
            x = manifold.normalise(draw_clips(action.testing, DRAWS, rng, frames))
            z = manifold.network.encode(x)
            x_hat = manifold.network.decode(z, x.shape[1])
            error = angle_distance(manifold.denormalise(x_hat), manifold.denormalise(x))
            measured.append((step, error, discrepancy(z, rng)))

    manifold = learn_sequences(
        action.training,
        schedule,
        seed,
        hidden,
        latent,
        frames,
        watch=watch,
        network=network,
        show_progress=show_progress,
    )
    return Study(
        action, manifold, Curve(*(np.array(column) for column in zip(*measured, strict=True)))
    )


def discrepancy(z: np.ndarray, rng: np.random.Generator) -> float:
    """The sliced Wasserstein distance of z (N, D) to as many fresh draws of the prior."""
    z = z.astype(np.float64)
    prior = rng.standard_normal(z.shape)
    directions = unit_directions(DIRECTIONS, z.shape[1], rng, np.float64)
    return float(ops.sliced_wasserstein(z, prior, directions)[0])


def between_draws_of_the_prior(latent: int, seed: int = 0) -> float:
    """The same distance between two draws of the prior, each of `DRAWS`: what is left at best."""
    rng = np.random.default_rng(seed)
    return float(
        np.mean([discrepancy(rng.standard_normal((DRAWS, latent)), rng) for _ in range(TURNS)])
    )
