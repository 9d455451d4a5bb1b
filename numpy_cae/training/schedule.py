"""How long and how fast to train; the defaults are those of holden2015, section 6. At the end the
learning rate of a step."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, is_dataclass, replace
from typing import Any, Literal

import numpy as np

Damage = Callable[[np.ndarray, np.random.Generator], np.ndarray]
"""Takes windows (B, T, C) and a generator, and returns damaged copies."""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """One stage of training; the defaults are the paper's for one layer.

    Examples
    --------
    >>> Stage().rate, Stage(rate=0.1, momentum=0.9).epochs
    (0.5, 25)
    """

    epochs: int = 25  # times that every window is used
    rate: float = 0.5  # learning rate of the first epoch; the peak of "one-cycle"
    decay: float = 0.9  # factor applied to the rate after each epoch
    alpha: float = 0.01  # weight of the sparsity term of equation 3
    batch: int = 1  # windows in a step: "iteratively input each data point"
    zeroed: float | tuple[float, float] = 0.1  # p of `zero_values`, or bounds of each window's p
    rescaled: bool = False  # whether X_c is divided by 1 - p
    momentum: float = 0.0  # μ of `descend_with_momentum`, at least 0 and below 1
    norm: float | None = None  # bound on the gradient's norm; the paper has none
    optimiser: Literal["sgd", "adam"] = "sgd"
    rate_schedule: Literal["decay", "one-cycle"] = "decay"
    damage: Damage | None = None  # further corruption, such as `manifold.augmentation.FileDamage`

    def __post_init__(self) -> None:
        _require_at_least(self, {"epochs": 0, "batch": 1, "rate": 0})
        # A checkpoint and a model file say by which settings a network was trained.
        if self.damage is not None and not is_dataclass(self.damage):
            raise ValueError(
                f"damage is {self.damage!r}, expected a dataclass with a method __call__, whose "
                "fields are the settings"
            )


@dataclass(frozen=True)
class Schedule:
    """Training of the convolutional autoencoder: each layer by itself, then all of them together.

    With 0 epochs for the layers, training is end to end. The paper does not state the epochs of
    fine tuning; we take as many as for one layer. By the minutes of its section 7, 43 + 51 + 77 for
    25 epochs of the three layers and 133 for fine tuning, it has about 19.

    Parameters
    ----------
    layer, fine_tuning : Stage
    initial : {"random", "passing"}
        The initial weights, as in `ConvAutoencoder`.
    rms : float
        The root mean square to which positions, velocities and turns are each scaled before
        training. The paper does not state it; at a rate of 0.5, much smaller values hardly learn
        and much larger ones diverge (docs/lab_book/equations.md).

    Examples
    --------
    >>> Schedule().layer.rate, Schedule().fine_tuning.rate
    (0.5, 0.01)
    """

    layer: Stage = field(default_factory=Stage)
    fine_tuning: Stage = field(default_factory=lambda: Stage(rate=0.01, alpha=0.0))
    initial: Literal["random", "passing"] = "random"
    rms: float = 0.25


@dataclass(frozen=True, kw_only=True)
class SequenceSchedule:
    """Training of jang2018's network; the paper states none of these numbers.

    The squared sliced Wasserstein distance between two random samples of the prior is on average
    2 for samples of 1 point, 0.28 for 16 points and 0.08 for 64: with a batch below
    64 this noise dominates the regulariser.

    Examples
    --------
    >>> schedule = SequenceSchedule(epochs=10, weight=0.5)
    >>> schedule.epochs * schedule.steps
    650
    """

    epochs: int = 40  # every step draws new clips, so an epoch is only the period of the decay
    steps: int = 65  # steps in an epoch
    rate: float = 0.3  # as in `Stage`
    decay: float = 0.93
    batch: int = 128  # clips in a step
    weight: float = 1.0  # λ of the sliced Wasserstein distance
    directions: int = 64  # on which the distance projects
    norm: float = 1.0  # bound on the gradient's norm
    momentum: float = 0.9
    optimiser: Literal["sgd", "adam"] = "sgd"
    rate_schedule: Literal["decay", "one-cycle"] = "decay"

    def __post_init__(self) -> None:
        _require_at_least(self, {"epochs": 0, "steps": 1, "batch": 1, "directions": 1, "rate": 0})


def _require_at_least(settings: Stage | SequenceSchedule, least: Mapping[str, int]) -> None:
    """Raise ValueError unless the named settings are finite and as large as these numbers."""
    for name, smallest in least.items():
        value = getattr(settings, name)
        if not smallest <= value < math.inf:
            raise ValueError(f"{name} is {value}, expected a finite number of {smallest} or more")


_BEST = Stage(
    epochs=130,
    rate=0.0015,
    alpha=0.0,
    batch=16,
    zeroed=(0.1, 0.8),
    rescaled=True,
    norm=0.03,
    optimiser="adam",
    rate_schedule="one-cycle",
)
_FAST = replace(_BEST, epochs=40, rate=0.0008, norm=0.007)
RECIPES = {
    "paper": Schedule(),
    "fast": Schedule(Stage(epochs=0), _FAST, initial="passing", rms=0.12),
    "best": Schedule(Stage(epochs=0), _BEST),
}
"""Schedules by name: "paper" as published, "fast" and "best" with Adam and all layers at once.

docs/lab_book/end_to_end.md lists the error that each reaches. The settings
were chosen on Bandai's takes *_004 after training on *_001 to *_003, not on the test takes *_005;
those of fast also on sources left out of training (docs/lab_book/other_sources.md)."""
SEQUENCE_RECIPES = {
    "paper": SequenceSchedule(),
    "fast": SequenceSchedule(
        steps=50, rate=0.005, batch=64, optimiser="adam", rate_schedule="one-cycle"
    ),
}
"""Schedules of the sequential network by name. The settings of fast were chosen on synthetic people
of seed 5 (docs/lab_book/sequence_choices.md)."""


def recipe(name: str) -> Schedule:
    """The schedule of that name in `RECIPES`, for the convolutional autoencoder.

    Parameters
    ----------
    name : {"paper", "fast", "best"}
        The schedule of holden2015; all layers at once with Adam for 40 epochs, from weights that
        let motion pass; the same for 130 epochs, from random weights.

    Returns
    -------
    schedule : Schedule

    Raises
    ------
    ValueError
        If there is no such recipe.

    Examples
    --------
    >>> recipe("fast").fine_tuning.optimiser, recipe("fast").layer.epochs
    ('adam', 0)
    """
    if name not in RECIPES:
        raise ValueError(f"there is no recipe {name!r}, expected one of {', '.join(RECIPES)}")
    return RECIPES[name]


def change_schedule(
    schedule: Schedule,
    epochs: int | None = None,
    rate: float | None = None,
    batch: int | None = None,
) -> Schedule:
    """The schedule with other numbers, those that are not None.

    The epochs and the batch are those of every stage that is trained; the rate is that of the
    layers, or of fine tuning where the layers are not trained by themselves.
    """
    numbers = {"epochs": epochs, "rate": rate, "batch": batch}
    changes: dict[str, Any] = {name: n for name, n in numbers.items() if n is not None}
    if schedule.layer.epochs:
        schedule = replace(schedule, layer=replace(schedule.layer, **changes))
        changes.pop("rate", None)
    return replace(schedule, fine_tuning=replace(schedule.fine_tuning, **changes))


WARM_UP = 0.3
"""In this share of a one-cycle schedule the rate rises; then it falls."""
FIRST = 1 / 25
"""A one-cycle schedule starts at this share of its peak rate."""
LAST = 1e-5
"""A one-cycle schedule ends at this share of its peak rate."""


def decayed_rate(initial: float, decay: float, epoch: int) -> float:
    """η_e = η_0 · decay^e: the learning rate of an epoch in holden2015, section 6.

    "initially set to the value of 0.5 and slowly decayed by a factor of 0.9 at each epoch"

    Parameters
    ----------
    initial, decay : float
        η_0 and the factor.
    epoch : int
        e, counted from 0.

    Returns
    -------
    rate : float

    Examples
    --------
    >>> [round(decayed_rate(0.5, 0.9, epoch), 3) for epoch in (0, 1, 24)]
    [0.5, 0.45, 0.04]
    """
    return initial * decay**epoch


def one_cycle(peak: float, share: float) -> float:
    """The learning rate at a point of the training: half a cosine up, then half a cosine down.

    The rate starts at peak / 25, reaches the peak after 30% of the steps and ends near 0. The small
    rates at the start let Adam's estimates settle, those at the end let the weights settle.

    Parameters
    ----------
    peak : float
    share : float
        The steps done, as a share (0 to 1) of all steps.

    Returns
    -------
    rate : float

    References
    ----------
    Smith and Topin, "Super-convergence", 2018, with the cosines of PyTorch's OneCycleLR.

    Examples
    --------
    >>> [round(one_cycle(1.0, share), 3) for share in (0, 0.15, 0.3, 0.65, 1)]
    [0.04, 0.52, 1.0, 0.5, 0.0]
    """
    if share < WARM_UP:
        return peak * _half_cosine(FIRST, 1.0, share / WARM_UP)
    return peak * _half_cosine(1.0, LAST, (share - WARM_UP) / (1 - WARM_UP))


def _half_cosine(start: float, end: float, share: float) -> float:
    return end + (start - end) * (1 + math.cos(math.pi * share)) / 2


def rate_at(stage: Stage | SequenceSchedule, epoch: int, step: int, steps: int) -> float:
    """The learning rate of a step; epochs and the `steps` steps of each count from 0."""
    if stage.rate_schedule == "one-cycle":
        return one_cycle(stage.rate, (epoch * steps + step) / (stage.epochs * steps))
    return decayed_rate(stage.rate, stage.decay, epoch)
