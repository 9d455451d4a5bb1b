"""One step of training of each network: holden2015, section 6, and jang2018.

All that is random in a step is drawn here: the corruption and the unpooling of holden2015, the
prior and the directions of jang2018.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.models import ConvAutoencoder, ConvLayer, Losses, SequentialAutoencoder
from numpy_cae.training.corruption import damage_stretches
from numpy_cae.training.optimisers import Adam, Sgd, clip_norm
from numpy_cae.training.schedule import SequenceSchedule, Stage

Masks = Sequence[np.ndarray]
"""The masks of `ops.unpool_random`, one for each layer that is trained."""


def drawn_inputs(
    x: np.ndarray, layer: ConvLayer | None, stage: Stage, rng: np.random.Generator
) -> tuple[np.ndarray, Masks | None]:
    """X_c of the windows x, and how the decoder unpools.

    The paper unpools at random while one `layer` is trained, and evenly (None) while all are.
    """
    corrupted = corrupted_copy(x, stage, rng)
    if layer is None:
        return corrupted, None
    return corrupted, [unpooling_mask(x, layer.b.size, rng)]


def denoising_step(
    model: ConvAutoencoder,
    x: np.ndarray,
    corrupted: np.ndarray,
    first: Masks | None,
    stage: Stage,
    rate: float,
    optimiser: Sgd | Adam,
    layer: int | None = None,
) -> float:
    """Compute the loss of restoring x from X_c and its gradients, and update the weights.

    x : (B, T, C) are clean windows or, when one layer is trained, the output of the layers below
    it; `corrupted` is X_c and `first` how to unpool, see `drawn_inputs`. `layer` is the index of
    the layer to train (0 is the lowest), or None for the whole stack. Returns the loss of
    equation 3 before the step; if it is not finite, no weight is changed.
    """
    loss, gradients = model.loss_and_gradients(x, corrupted, stage.alpha, first, layer)
    if np.isfinite(loss):
        # dw1, db1, dw2, db2, …: the order of `model.parameters`, and of `layer.parameters`.
        flat = [gradient for of_layer in gradients for gradient in of_layer]
        if stage.norm is not None:
            clip_norm(flat, stage.norm)
        optimiser.update(flat, rate)
    return loss


def sequence_step(
    model: SequentialAutoencoder,
    x: np.ndarray,
    schedule: SequenceSchedule,
    rate: float,
    rng: np.random.Generator,
    optimiser: Sgd | Adam,
) -> Losses:
    """Draw from the prior, compute the loss and its gradients, update the weights: jang2018.

    x : (B, T, features) are normalised clips. Returns the losses before the step; if the total
    is not finite, no weight is changed.
    """
    prior = rng.standard_normal((len(x), model.latent)).astype(x.dtype)
    directions = unit_directions(schedule.directions, model.latent, rng, x.dtype)
    losses, gradients = model.loss_and_gradients(x, prior, directions, schedule.weight)
    if np.isfinite(losses.total):
        clip_norm(list(gradients.values()), schedule.norm)
        optimiser.update(gradients.values(), rate)
    return losses


def corrupted_copy(x: np.ndarray, stage: Stage, rng: np.random.Generator) -> np.ndarray:
    """X_c of a batch of windows (B, T, C), with all the corruption of a stage of training.

        X_c = zero_values(X, p),   p ~ U(zeroed),   and where rescaled   X_c / (1 - p)

    `stage.zeroed` is p, or the two numbers between which each window's p is drawn; below 1 if
    `stage.rescaled`. Zeroing values with probability p multiplies their expected sum by 1 - p.
    Dividing by 1 - p restores the sum for every p, so the filters are not fitted to one p.
    """
    p: float | np.ndarray
    if isinstance(stage.zeroed, tuple):
        p = rng.uniform(*stage.zeroed, size=(len(x), 1, 1)).astype(x.dtype)
    else:
        p = stage.zeroed
    corrupted = zero_values(x, p, rng)
    if stage.rescaled:
        corrupted = corrupted / (1 - p)
    if stage.displacement:
        corrupted = damage_stretches(corrupted, stage.chains, stage.displacement, rng)
    if stage.noise:
        deviation = stage.noise * rng.random((len(x), 1, 1), dtype=x.dtype)
        corrupted = corrupted + deviation * rng.standard_normal(x.shape, dtype=x.dtype)
    return corrupted


def zero_values(x: np.ndarray, p: float | np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """X_c: each value of x set to zero with probability p, independently; zero is the mean pose.

    Parameters
    ----------
    x : array of float, any shape
    p : float or array
        Between 0 and 1; an array must broadcast to x.
    rng : numpy.random.Generator

    Returns
    -------
    corrupted : array of the same shape

    Raises
    ------
    ValueError
        If p is not a probability.

    References
    ----------
    holden2015, section 6: the corruption of denoising autoencoding.

    Examples
    --------
    >>> x = np.ones((1, 1000, 5), np.float32)
    >>> corrupted = zero_values(x, 0.1, np.random.default_rng(0))
    >>> round(float(corrupted.mean()), 1)
    0.9
    """
    if not np.all((0 <= np.asarray(p)) & (np.asarray(p) <= 1)):
        raise ValueError(f"p is {p}, expected a probability between 0 and 1")
    return x * (rng.random(x.shape, dtype=np.float32) >= p)


def unpooling_mask(x: np.ndarray, filters: int, rng: np.random.Generator) -> np.ndarray:
    """The mask of `ops.unpool_random` for a layer whose input is x, (B, T, C): (B, T/2, D).

    True (with probability 1/2) puts the unpooled value on the first frame of its pair, False on
    the second.
    """
    batch, frames, _ = x.shape
    return rng.random((batch, frames // 2, filters), dtype=np.float32) < 0.5


def unit_directions(
    count: int, dimensions: int, rng: np.random.Generator, dtype: np.dtype | type = np.float32
) -> np.ndarray:
    """Random directions, uniformly distributed: those of vectors of independent normal numbers.

    Parameters
    ----------
    count, dimensions : int
    rng : numpy.random.Generator
    dtype : float32 or float64

    Returns
    -------
    directions : (count, dimensions) array
        Rows of length 1.

    Examples
    --------
    >>> directions = unit_directions(4, 3, np.random.default_rng(0))
    >>> np.linalg.norm(directions, axis=1).round(5)
    array([1., 1., 1., 1.], dtype=float32)
    """
    drawn = rng.standard_normal((count, dimensions))
    return (drawn / np.linalg.norm(drawn, axis=1, keepdims=True)).astype(dtype)
