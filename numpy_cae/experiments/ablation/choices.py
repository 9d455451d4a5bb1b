"""The rows of the ablation: one choice of holden2015 varied at a time.

All networks share the schedule of the first row, except for what a row is named after. The rate of
the untied network is halved: at the common rate it diverged from one of five seeds.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from numpy_cae.experiments.ablation.variant import average_autoencoder, untied_autoencoder
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import FEATURES
from numpy_cae.motion.windows import LENGTH
from numpy_cae.training import Schedule, Stage
from numpy_cae.training.schedule import EVEN, RANDOM

TAPS = 15
LAYER_EPOCHS, FINE_EPOCHS, WIDTH, SEEDS = 4, 12, 32, 5
"""Epochs of a layer and of fine tuning; filters of the lowest of three layers, half the paper's;
and the number of seeds."""
ADAM_RATE = 0.004
"""Peak of the one-cycle schedule of the rows with Adam, the best of 0.001 to 0.008 on takes that
are not the test takes (docs/lab_book/ablation.md)."""
PAPER = "as holden2015, smaller"
LATENT, PARAMETERS = "equal latent size", "equal parameters"
NO_SPARSITY, UNTIED, AVERAGE = "α = 0", "weights untied, half the rate", "average pooling"
EVENLY, RANDOMLY = "even unpooling from the start", "random unpooling to the end"
WHOLE, WIDE_P = "nothing zeroed", "p from 0.1 to 0.8, X_c / (1 - p)"
LAYERS_ALONE, AT_ONCE = "layers alone, no fine tuning", "end to end, no layers before"
ADAM_LAYERS, ADAM_AT_ONCE = "Adam, layer by layer", "Adam, end to end"


@dataclass(frozen=True)
class Choice:
    """A network and its training."""

    name: str
    filters: tuple[int, ...]
    schedule: Schedule
    tied: bool = True
    average: bool = False

    @property
    def parameters(self) -> int:
        """Number of learned values."""
        return parameters_of(self.filters) * (1 if self.tied else 2)

    @property
    def latent(self) -> int:
        """Hidden units of a window of `LENGTH` frames."""
        return (LENGTH >> len(self.filters)) * self.filters[-1]

    def network(self, rng: np.random.Generator) -> ConvAutoencoder:
        """The untrained network, accelerated if it is the paper's."""
        kind = average_autoencoder if self.average else ConvAutoencoder
        kind = kind if self.tied else untied_autoencoder
        return accelerate(kind(filters=self.filters, taps=TAPS, rng=rng))


def parameters_of(filters: tuple[int, ...]) -> int:
    """Number of values in W and b of a stack with tied weights."""
    return sum(TAPS * below * above + above for below, above in pairwise((FEATURES, *filters)))


def doubling(width: int, depth: int) -> tuple[int, ...]:
    """Filters that double with each layer, as in the paper. Pooling halves the frames, so every
    depth n has as many hidden units for a window: T / 2^n · 2^(n-1) width.
    """
    return tuple(width << layer for layer in range(depth))


def as_large_as(filters: tuple[int, ...], depth: int) -> tuple[int, ...]:
    """The doubling stack of this depth with the number of parameters nearest to another's."""
    target = parameters_of(filters)
    return min(
        (doubling(width, depth) for width in range(1, target // (TAPS * FEATURES) + 2)),
        key=lambda each: abs(parameters_of(each) - target),
    )


def choices(
    width: int = WIDTH, layer_epochs: int = LAYER_EPOCHS, fine_epochs: int = FINE_EPOCHS
) -> list[Choice]:
    """Every network of the table, the paper's first.

    `width` filters are in the lowest of three layers. Steps average over eight windows and have
    momentum, to train quickly; the rate falls to a tenth over each stage. α, corruption and
    unpooling are the paper's.
    """
    three = doubling(width, 3)
    layer = Stage(layer_epochs, 0.5, _decay(layer_epochs), batch=8, momentum=0.9)
    fine = Stage(fine_epochs, 0.3, _decay(fine_epochs), alpha=0.0, batch=8, momentum=0.9)

    def varied(
        name: str, of_layer: dict | None = None, of_fine: dict | None = None, **network
    ) -> Choice:
        schedule = Schedule(replace(layer, **of_layer or {}), replace(fine, **of_fine or {}))
        return Choice(name, **{"filters": three, "schedule": schedule} | network)

    stacks = {
        f"depth {depth}, {same}": filters
        for same in (LATENT, PARAMETERS)
        for depth in (1, 2)
        for filters in [doubling(width, depth) if same == LATENT else as_large_as(three, depth)]
    }
    no_zeros, wide = {"zeroed": 0.0}, {"zeroed": (0.1, 0.8), "rescaled": True}
    all_epochs = layer_epochs + fine_epochs
    end_to_end = {"epochs": all_epochs, "decay": _decay(all_epochs)}
    adam = {"optimiser": "adam", "rate_schedule": "one-cycle", "rate": ADAM_RATE, "norm": 0.05}
    half_rates = {"rate": layer.rate / 2}, {"rate": fine.rate / 2}
    return [
        varied(f"{PAPER}: {'-'.join(map(str, three))} filters"),
        *(varied(name, filters=filters) for name, filters in stacks.items()),
        varied(NO_SPARSITY, {"alpha": 0.0}),
        *(varied(f"α = {a}", {"alpha": a}) for a in (0.1, 1.0)),
        *(
            varied(f"α = {a}, in fine tuning too", {"alpha": a}, {"alpha": a})
            for a in (0.01, 0.1, 1.0)
        ),
        varied(UNTIED, *half_rates, tied=False),
        varied(AVERAGE, average=True),
        varied(EVENLY, {"unpooling": EVEN}),
        varied(RANDOMLY, {"unpooling": RANDOM}, {"unpooling": RANDOM}),
        varied(WHOLE, no_zeros, no_zeros),
        varied(WIDE_P, wide, wide),
        varied(LAYERS_ALONE, of_fine={"epochs": 0}),
        varied(AT_ONCE, {"epochs": 0}, end_to_end),
        varied(ADAM_LAYERS, adam, adam),
        varied(ADAM_AT_ONCE, {"epochs": 0}, adam | end_to_end),
    ]


def _decay(epochs: int) -> float:
    return 0.1 ** (1 / max(epochs, 1))
