"""One step of training of each network: holden2015, section 6, and jang2018."""

import numpy as np

from numpy_cae.models import ConvAutoencoder, ConvLayer, Losses, SequentialAutoencoder
from numpy_cae.training.adam import Adam
from numpy_cae.training.schedule import SequenceSchedule, Stage
from numpy_cae.training.sgd import Sgd, clip_norm


def denoising_step(
    model: ConvAutoencoder,
    x: np.ndarray,
    corrupted: np.ndarray,
    stage: Stage,
    rate: float,
    rng: np.random.Generator,
    optimiser: Sgd | Adam,
    layer: int | None = None,
) -> float:
    """Compute the loss of restoring x from X_c and its gradients, and update the weights.

    x : (B, T, C) are clean windows or, when one layer is trained, the output of the layers below
    it; `corrupted` is X_c. `layer` is the index of the layer to train (0 is the lowest), or None
    for the whole stack. Returns the loss of equation 3 before the step; if it is not finite, no
    weight is changed.
    """
    layers = model.layers if layer is None else [model.layers[layer]]
    # The paper unpools at random while one layer is trained, and evenly while all are.
    first = None if layer is None else _unpooling_masks(layers, x, rng)
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


def make_optimiser(
    stage: Stage | SequenceSchedule, parameters: dict[str, np.ndarray]
) -> Sgd | Adam:
    """A new optimiser for these parameters, the one that the stage names."""
    return Adam(parameters) if stage.optimiser == "adam" else Sgd(parameters, stage.momentum)


def _unpooling_masks(
    layers: list[ConvLayer], x: np.ndarray, rng: np.random.Generator
) -> list[np.ndarray]:
    """One boolean mask for each layer: True (with probability 1/2) puts the unpooled value on the
    first frame of its pair, False on the second."""
    batch, frames, _ = x.shape
    shapes = [(batch, frames >> (k + 1), trained.b.size) for k, trained in enumerate(layers)]
    return [rng.random(shape, dtype=np.float32) < 0.5 for shape in shapes]
