"""How long and how fast to train; the defaults are those of holden2015, section 6."""

from dataclasses import dataclass, field, replace
from typing import Literal


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
    displacement: float = 0.0  # `size` of `damage_stretches`, which is not used where it is 0
    chains: tuple[tuple[int, ...], ...] = ()  # of that damage; `learn_manifold` sets them
    noise: float = 0.0  # largest standard deviation of the noise that is added to a window


@dataclass(frozen=True)
class Schedule:
    """Training of the convolutional autoencoder: each layer by itself, then all of them together.

    With 0 epochs for the layers, training is end to end. The paper does not state the epochs of
    fine tuning; we take as many as for one layer.

    Parameters
    ----------
    layer, fine_tuning : Stage
    initial : {"random", "passing"}
        The initial weights, as in `ConvAutoencoder`.
    rms : float
        The root mean square to which positions, velocities and turns are each scaled before
        training. The paper does not state it; at a rate of 0.5, much smaller values hardly learn
        and much larger ones diverge (docs/lab_book/input_scale.md).

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
of seed 5 (docs/lab_book/sequence_recipe.md)."""


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
