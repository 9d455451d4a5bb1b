"""The rows of the ablation: one choice of holden2015 varied at a time.

All networks share the schedule of the first row, except for what a row is named after. The lab book
has the figures of further rows, most of which changed little.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import FEATURES
from numpy_cae.training import Schedule, Stage
from numpy_cae.training.schedule import EVEN

TAPS = 15
LAYER_EPOCHS, FINE_EPOCHS = 4, 12
"""Epochs of each layer and of fine tuning."""
WIDTH = 32
"""Filters of the lowest of three layers; the paper has 64."""
SEEDS = 5
ADAM_RATE = 0.004
"""Peak of the one-cycle schedule of the rows with Adam, the best of 0.001 to 0.008 on takes that
are not the test takes (lab book)."""
PAPER = "as holden2015, smaller"
ONE_LAYER, TWO_LAYERS = "one layer, equal parameters", "two layers, equal parameters"
EVEN_UNPOOLING = "even unpooling from the start"
NOTHING_REMOVED, WIDE_P = "no values removed", "p from 0.1 to 0.8, X_c / (1 - p)"
LAYERS_ALONE, END_TO_END = "layers alone, no fine tuning", "end to end, no layers before"
ADAM_LAYERS, ADAM_END_TO_END = "Adam, layer by layer", "Adam, end to end"


@dataclass(frozen=True)
class Choice:
    """A network and its training."""

    name: str
    filters: tuple[int, ...]
    schedule: Schedule

    @property
    def parameters(self) -> int:
        """Number of learned values."""
        return parameters_of(self.filters)

    def network(self, rng: np.random.Generator) -> ConvAutoencoder:
        """The untrained network, accelerated."""
        return accelerate(ConvAutoencoder(filters=self.filters, taps=TAPS, rng=rng))


def parameters_of(filters: tuple[int, ...]) -> int:
    """Number of values in W and b of a stack of layers."""
    return sum(TAPS * below * above + above for below, above in pairwise((FEATURES, *filters)))


def doubling(width: int, depth: int) -> tuple[int, ...]:
    """Filters that double with each layer, as in the paper."""
    return tuple(width << layer for layer in range(depth))


def as_large_as(filters: tuple[int, ...], depth: int) -> tuple[int, ...]:
    """The doubling stack of this depth with the number of parameters nearest to another's."""
    target = parameters_of(filters)
    return min(
        (doubling(width, depth) for width in range(1, target // (TAPS * FEATURES) + 2)),
        key=lambda stack: abs(parameters_of(stack) - target),
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
    layer = Stage(epochs=layer_epochs, rate=0.5, decay=_decay(layer_epochs), batch=8, momentum=0.9)
    fine = replace(layer, epochs=fine_epochs, rate=0.3, decay=_decay(fine_epochs), alpha=0.0)

    def varied(
        name: str,
        of_layer: dict | None = None,
        of_fine: dict | None = None,
        filters: tuple[int, ...] = three,
    ) -> Choice:
        schedule = Schedule(replace(layer, **of_layer or {}), replace(fine, **of_fine or {}))
        return Choice(name, filters, schedule)

    nothing, wide = {"zeroed": 0.0}, {"zeroed": (0.1, 0.8), "rescaled": True}
    all_epochs = layer_epochs + fine_epochs
    no_layers, end_to_end = {"epochs": 0}, {"epochs": all_epochs, "decay": _decay(all_epochs)}
    adam = {"optimiser": "adam", "rate_schedule": "one-cycle", "rate": ADAM_RATE, "norm": 0.05}
    return [
        varied(f"{PAPER}: {'-'.join(map(str, three))} filters"),
        varied(ONE_LAYER, filters=as_large_as(three, 1)),
        varied(TWO_LAYERS, filters=as_large_as(three, 2)),
        varied(EVEN_UNPOOLING, {"unpooling": EVEN}),
        varied(NOTHING_REMOVED, nothing, nothing),
        varied(WIDE_P, wide, wide),
        varied(LAYERS_ALONE, of_fine={"epochs": 0}),
        varied(END_TO_END, no_layers, end_to_end),
        varied(ADAM_LAYERS, adam, adam),
        varied(ADAM_END_TO_END, no_layers, adam | end_to_end),
    ]


def _decay(epochs: int) -> float:
    return 0.1 ** (1 / max(epochs, 1))
