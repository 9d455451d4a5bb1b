"""How long and how fast: the numbers of holden2015, section 6, as defaults."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

RANDOM, EVEN = "random", "even"


@dataclass(frozen=True)
class Stage:
    """One stage of training.

    Parameters
    ----------
    epochs : int
        How often every window is shown.
    rate : float
        The learning rate of the first epoch.
    decay : float
        What the rate is multiplied by after each epoch.
    alpha : float
        Weight of the sparsity term of equation 3.
    batch : int
        Windows in one step of descent; 1 is "iteratively input each data point".
    zeroed : float or (float, float)
        The probability p with which a value of the input is set to zero; two, and p is drawn
        between them, anew for each window in each step.
    rescaled : bool
        Whether the corrupted input is divided by 1 - p: see `training.corruption`.
    momentum : float
        μ of `training.descend_with_momentum`, at least 0 and below 1; the paper's descent has none.
    unpooling : "random", "even" or None
        None is the paper's: at random while a layer is trained by itself, evenly for all together.
    """

    epochs: int = 25
    rate: float = 0.5
    decay: float = 0.9
    alpha: float = 0.01
    batch: int = 1
    zeroed: float | tuple[float, float] = 0.1
    rescaled: bool = False
    momentum: float = 0.0
    unpooling: Literal["random", "even"] | None = None


@dataclass(frozen=True)
class Schedule:
    """The whole training: each layer by itself, then all of them together.

    Parameters
    ----------
    layer : Stage
        For each layer in turn, unpooling at random.
    fine_tuning : Stage
        For the whole stack, unpooling evenly. The paper does not state its epochs; we take as
        many as for a layer.
    """

    layer: Stage = field(default_factory=Stage)
    fine_tuning: Stage = field(default_factory=lambda: Stage(rate=0.01, alpha=0.0))


@dataclass(frozen=True)
class SequenceSchedule:
    """The training of jang2018's network; the paper states none of these numbers.

    Parameters
    ----------
    epochs, steps : int
        Steps of descent in an epoch; an epoch is no more than what the rate decays by, since the
        clips are drawn anew at every step.
    rate : float
        The learning rate of the first epoch.
    decay : float
        What the rate is multiplied by after each epoch.
    batch : int
        Clips in one step. The distance between two draws of the prior itself falls with their size
        (2.1 for one point, 0.28 for 16, 0.08 for 64), so below 64 the regulariser sees mostly that.
    weight : float
        λ of the sliced Wasserstein distance.
    directions : int
        That it projects on, drawn anew at every step.
    norm : float
        The bound on the gradient's norm.
    momentum : float
        μ of `training.descend_with_momentum`, at least 0 and below 1.
    posture : float
        Each clip gets a constant added to each of its numbers, drawn anew, normal with this many
        deviations. Few motions are few people, and each holds itself in its own way: so the network
        learns to encode how somebody stands.
    """

    epochs: int = 40
    steps: int = 65
    rate: float = 0.3
    decay: float = 0.93
    batch: int = 128
    weight: float = 1.0
    directions: int = 64
    norm: float = 1.0
    momentum: float = 0.9
    posture: float = 0.0
