"""Training that diverges: how it is noticed, and what its message says."""

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.training.checkpoint import Checkpoint
from numpy_cae.training.state import TrainingState

ADVICE = "a lower rate (--rate) or, in Python, a bound on the norm (`Stage.norm`) may help"


LARGEST_WEIGHT = 1e6
"""Training with a larger weight has diverged, although its loss may be finite. A model file with a
larger number is refused."""


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss or weights are no longer finite, or are too large to be of any use."""


def require_finite(
    loss: float,
    weights: dict[str, np.ndarray],
    x: np.ndarray,
    rate: float,
    state: TrainingState,
    checkpoint: Checkpoint | None,
) -> None:
    """Raise DivergedError if the loss of a step is not finite or, since a finite loss can precede
    infinite weights, if a weight is above `LARGEST_WEIGHT` or not finite at the end of an epoch.

    The step is not counted in `state` yet. The message names the first array, from the step's input
    x on, that is not finite, and where the last good state is.
    """
    ends_epoch = state.step + 1 == state.steps
    too_large = names_of_too_large(weights) if ends_epoch else []
    if np.isfinite(loss) and not too_large:
        return
    parts = names_of_nonfinite({"the input": x} | weights)
    if np.isfinite(loss) and not parts:
        reason = f"{too_large[0]} has numbers above {LARGEST_WEIGHT:g}"
    else:
        reason = f"not finite: {parts[0] if parts else f'the output of {state.name}'}"
    where = f"{state.name}, epoch {state.epoch + 1}, step {state.step + 1}"
    problem = f"the loss is {loss:.4g} at rate {rate:.4g}; {reason}"
    saved = checkpoint.status() if checkpoint is not None else "there is no checkpoint"
    raise DivergedError(f"{where}: {problem}; {saved}; {ADVICE}")


def names_of_nonfinite(arrays: dict[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold a number that is not finite."""
    return [name for name, array in arrays.items() if not np.isfinite(array).all()]


def names_of_too_large(weights: dict[str, np.ndarray]) -> list[str]:
    """The names of the weights that hold a number above `LARGEST_WEIGHT` or NaN."""
    names = []
    for name, weight in weights.items():
        if weight.size and not np.abs(weight).max() <= LARGEST_WEIGHT:
            names.append(name)
    return names
