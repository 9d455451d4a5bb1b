"""What an ablation varies, one choice of holden2015 at a time, as data.

All networks share the schedule of the first, so that a row differs from it in what it is named for
and in nothing else. The rate of the untied network is halved: with the others' it diverged from one
seed of five and ended anywhere from the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from numpy_cae import ops
from numpy_cae.experiments.ablation.average_pool import average_pool
from numpy_cae.experiments.ablation.variant import VariantAutoencoder
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import FEATURES
from numpy_cae.motion.windows import LENGTH
from numpy_cae.training import Schedule, Stage
from numpy_cae.training.schedule import EVEN, RANDOM

TAPS = 15
LAYER_EPOCHS, FINE_EPOCHS, WIDTH = 4, 12, 32
"""Of a layer, of fine tuning; and filters of the lowest of three layers, half of the paper's."""
PAPER = "as holden2015 has it, smaller"
DEPTH, SPARSITY, LAYER, CORRUPTION, TRAINING = (
    "depth",
    "sparsity",
    "what a layer is",
    "denoising",
    "training",
)
LATENT, PARAMETERS = "equal latent size", "equal parameters"
NO_SPARSITY, UNTIED, AVERAGE = "α = 0", "weights untied, half the rate", "average pooling"
EVENLY, RANDOMLY = "even unpooling from the start", "random unpooling to the end"
WHOLE, WIDE_P = "nothing zeroed", "p from 0.1 to 0.8, X_c / (1 - p)"
LAYERS_ALONE, AT_ONCE = "layers alone, no fine tuning", "end to end, no layers before"


@dataclass(frozen=True)
class Choice:
    """A network and how it is trained.

    Parameters
    ----------
    group, name : str
    filters : tuple of int
    schedule : Schedule
    tied : bool
    average : bool
        Pooling by the mean, not the maximum.
    """

    group: str
    name: str
    filters: tuple[int, ...]
    schedule: Schedule
    tied: bool = True
    average: bool = False

    @property
    def parameters(self) -> int:
        """Numbers that are learned."""
        tied = parameters_of(self.filters)
        return tied if self.tied else 2 * tied

    @property
    def latent(self) -> int:
        """Hidden units of a window of `LENGTH` frames."""
        return (LENGTH >> len(self.filters)) * self.filters[-1]

    def network(self, rng: np.random.Generator) -> ConvAutoencoder | VariantAutoencoder:
        """Before it learned anything; the fast one wherever it can be."""
        if self.tied and not self.average:
            return accelerate(ConvAutoencoder(filters=self.filters, taps=TAPS, rng=rng))
        pool = average_pool if self.average else ops.max_pool
        return VariantAutoencoder(
            filters=self.filters, taps=TAPS, rng=rng, tied=self.tied, pool=pool
        )


def parameters_of(filters: tuple[int, ...]) -> int:
    """Numbers in W and b of a stack with tied weights."""
    return sum(TAPS * below * above + above for below, above in pairwise((FEATURES, *filters)))


def doubling(width: int, depth: int) -> tuple[int, ...]:
    """Twice the filters in each layer, as in the paper.

    Pooling halves the frames, so that whatever the depth the hidden units of a window are as many:
    T / 2^n · 2^(n-1) width.
    """
    return tuple(width << layer for layer in range(depth))


def as_large_as(filters: tuple[int, ...], depth: int) -> tuple[int, ...]:
    """The stack of this depth whose parameters are nearest to those of another."""
    wanted = parameters_of(filters)
    return min(
        (doubling(width, depth) for width in range(1, wanted // (TAPS * FEATURES) + 2)),
        key=lambda each: abs(parameters_of(each) - wanted),
    )


def base_schedule(layer_epochs: int = LAYER_EPOCHS, fine_epochs: int = FINE_EPOCHS) -> Schedule:
    """The paper's α, corruption and unpooling; eight windows a step and momentum, to be quick.

    The rate falls to a tenth over each stage, whatever its epochs.
    """
    common = {"batch": 8, "momentum": 0.9}
    return Schedule(
        Stage(layer_epochs, 0.5, _decay(layer_epochs), **common),
        Stage(fine_epochs, 0.3, _decay(fine_epochs), alpha=0.0, **common),
    )


def _decay(epochs: int) -> float:
    return 0.1 ** (1 / max(epochs, 1))


def choices(
    width: int = WIDTH, layer_epochs: int = LAYER_EPOCHS, fine_epochs: int = FINE_EPOCHS
) -> list[Choice]:
    """Every network of the table, the paper's first.

    Parameters
    ----------
    width : int
        Filters of the lowest of three layers; the others have twice and four times as many.
    layer_epochs, fine_epochs : int
    """
    three = doubling(width, 3)
    base = base_schedule(layer_epochs, fine_epochs)

    def varied(
        group: str, name: str, layer: dict | None = None, fine: dict | None = None, **network
    ) -> Choice:
        stages = replace(base.layer, **layer or {}), replace(base.fine_tuning, **fine or {})
        return Choice(group, name, **{"filters": three, "schedule": Schedule(*stages)} | network)

    shallow = [
        varied(DEPTH, f"depth {depth}, {same}", filters=filters)
        for same, filters_of in (
            (LATENT, lambda depth: doubling(width, depth)),
            (PARAMETERS, lambda depth: as_large_as(three, depth)),
        )
        for depth in (1, 2)
        for filters in [filters_of(depth)]
    ]
    no_zeros, wide = {"zeroed": 0.0}, {"zeroed": (0.1, 0.8), "rescaled": True}
    all_epochs = layer_epochs + fine_epochs
    return [
        varied(PAPER, f"depth 3, {'-'.join(map(str, three))} filters"),
        *shallow,
        varied(SPARSITY, NO_SPARSITY, {"alpha": 0.0}),
        *(varied(SPARSITY, f"α = {a}", {"alpha": a}) for a in (0.1, 1.0)),
        *(
            varied(SPARSITY, f"α = {a}, in fine tuning too", {"alpha": a}, {"alpha": a})
            for a in (0.01, 0.1, 1.0)
        ),
        varied(
            LAYER,
            UNTIED,
            {"rate": base.layer.rate / 2},
            {"rate": base.fine_tuning.rate / 2},
            tied=False,
        ),
        varied(LAYER, AVERAGE, average=True),
        varied(LAYER, EVENLY, {"unpooling": EVEN}),
        varied(LAYER, RANDOMLY, {"unpooling": RANDOM}, {"unpooling": RANDOM}),
        varied(CORRUPTION, WHOLE, no_zeros, no_zeros),
        varied(CORRUPTION, WIDE_P, wide, wide),
        varied(TRAINING, LAYERS_ALONE, fine={"epochs": 0}),
        varied(
            TRAINING,
            AT_ONCE,
            {"epochs": 0},
            {"epochs": all_epochs, "decay": _decay(all_epochs)},
        ),
    ]
