"""Networks with half of the paper's filters, trained in seconds, several seeds of each.

They learn from every second training take. Two networks are compared seed by seed: both start from
the same weights and draw the same random numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from numpy_cae.evaluation.baselines import Gaussian, apply_linear_map, fit_gaussian
from numpy_cae.evaluation.tables import Clips, apply_to_real_frames, clips_of
from numpy_cae.fast import FastConvAutoencoder
from numpy_cae.manifold import MotionManifold, learn_manifold
from numpy_cae.training import Schedule, Stage, train_autoencoder, zero_values
from studies.shared.material import Material
from studies.shared.trained import Trainer

FILTERS = (32, 64, 128)
"""Half of the paper's. Each layer halves the frames and doubles the units."""
EPOCHS = 4
"""Of each layer and of fine tuning; the paper has 25."""
SEEDS = 3
P = 0.5
"""Share of the values that are removed."""
TESTING_WINDOWS = 40
"""Errors are measured on at most this many test windows, evenly spaced."""
UNTRAINED = Schedule(Stage(epochs=0), Stage(epochs=0))


class Errors(NamedTuple):
    """Of test windows: reconstruction, and half of the values removed without the mask."""

    reconstruction: float
    repair: float

    HEADER = ("reconstruction, cm", "half removed, cm")


@dataclass(frozen=True, eq=False)
class SmallNetworks:
    """Trains on takes of a material, and measures on its test takes.

    Parameters
    ----------
    takes : sequence of (F, 20, 3) arrays
        For training.
    testing : sequence of (F, 20, 3) arrays
    trainer : Trainer
    seeds : sequence of int
    """

    takes: Sequence[np.ndarray]
    testing: Sequence[np.ndarray]
    trainer: Trainer
    seeds: Sequence[int]

    @classmethod
    def of(
        cls, material: Material, trainer: Trainer | None, seed: int, count: int
    ) -> SmallNetworks:
        """For `count` seeds, from this one on."""
        takes = [take.positions for take in material.training[::2]]
        testing = [take.positions for take in material.testing]
        return cls(takes, testing, trainer or Trainer(), range(seed, seed + count))

    def learn(self, schedule: Schedule, **network: Any) -> list[MotionManifold]:
        """A network of each seed, by `learn_manifold`."""
        settings = {"filters": FILTERS} | network
        return [self.trainer.learn(self.takes, schedule, seed, **settings) for seed in self.seeds]

    def learn_with(
        self, name: str, engine: Callable[[Any], Any], schedule: Schedule, **network: Any
    ) -> list[MotionManifold]:
        """A network of each seed, trained by what `engine` makes of it; the name is the engine's
        in the folder of the trainer."""
        settings = {"filters": FILTERS} | network
        manifolds = []
        for seed in self.seeds:

            def train(seed: int = seed) -> MotionManifold:
                manifold = learn_manifold(self.takes, UNTRAINED, seed, **settings)
                x = clips_of(manifold, self.takes).x
                train_autoencoder(engine(manifold.network), x, schedule, seed)
                return manifold

            key = (*self.takes, schedule, seed, settings, name)
            manifolds.append(self.trainer.keep(train, *key))
        return manifolds

    def clips(self, manifold: MotionManifold) -> Clips:
        """The test windows."""
        return clips_of(manifold, self.testing).pick_evenly(TESTING_WINDOWS)

    def errors(self, manifolds: Sequence[MotionManifold]) -> list[Errors]:
        """The errors of each network; the same values are removed for all."""
        return [self._errors(manifold) for manifold in manifolds]

    def _errors(self, manifold: MotionManifold) -> Errors:
        test = self.clips(manifold)
        damaged = zero_values(test.x, P, np.random.default_rng(0))
        project = manifold.project_windows
        reconstructed = apply_to_real_frames(project, test.real, test.x)
        repaired = apply_to_real_frames(project, test.real, damaged)
        return Errors(test.error(reconstructed), test.error(repaired))

    def completion_errors(self, manifolds: Sequence[MotionManifold]) -> list[float]:
        """The error of each network's completion of the same values, mask given, cm."""
        errors = []
        for manifold in manifolds:
            test = self.clips(manifold)
            damaged = zero_values(test.x, P, np.random.default_rng(0))
            complete = manifold.complete_windows
            completed = apply_to_real_frames(complete, test.real, damaged, damaged != 0)
            errors.append(test.error(completed))
        return errors

    def error_of_linear_map(self) -> float:
        """The error of the linear map of 15 frames, fitted to the same takes, cm."""
        test, damaged = self._damaged()
        fitted = clips_of(test.manifold, self.takes)
        linear = Gaussian(fitted.x, fitted.real).linear_map(P)
        return test.error(apply_linear_map(damaged, linear))

    def error_of_gaussian(self) -> float:
        """The error of the Gaussian of 15 frames that is given the mask, fitted to the same takes,
        cm."""
        test, damaged = self._damaged()
        fitted = clips_of(test.manifold, self.takes)
        gaussian = fit_gaussian(fitted.x, fitted.real, fitted.take)
        known = damaged != 0
        return test.error(apply_to_real_frames(gaussian.complete, test.real, damaged, known))

    def _damaged(self) -> tuple[Clips, np.ndarray]:
        """The test windows, and half of their values removed, as for the networks."""
        test = self.clips(self.learn(UNTRAINED)[0])
        return test, zero_values(test.x, P, np.random.default_rng(0))


class EvenlyUnpooled(FastConvAutoencoder):
    """A network whose layers are trained with even unpooling."""

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> Any:
        """As `ConvAutoencoder.loss_and_gradients`; the masks of random unpooling are not used."""
        return super().loss_and_gradients(x, corrupted, alpha, None, layer)


def mean_and_range(values: Sequence[float]) -> str:
    """The mean over the seeds, ± half of the range."""
    return f"{np.mean(values):.3f} ± {np.ptp(values) / 2:.3f}"
