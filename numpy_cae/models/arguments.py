"""Checks of the arguments of the two networks; each raises ValueError and names the argument."""

from collections.abc import Sequence

import numpy as np

from numpy_cae.models.conv_layer import ConvLayer
from numpy_cae.ops.shapes import require_shape


def require_windows(name: str, x: np.ndarray, layers: Sequence[ConvLayer]) -> None:
    """Raise ValueError unless the layers can encode x."""
    require_shape(name, x, ("batch", "frames", layers[0].w.shape[1]))
    if x.shape[1] % 2 ** len(layers):
        raise ValueError(
            f"{name} has shape {x.shape}: pooling {len(layers)} times needs an even number of "
            f"frames each time, so expected a multiple of {2 ** len(layers)} frames"
        )


def require_denoising_arguments(
    layers: Sequence[ConvLayer],
    x: np.ndarray,
    corrupted: np.ndarray,
    first: Sequence[np.ndarray | None] | None,
) -> None:
    """Raise ValueError unless the arguments of `ConvAutoencoder.loss_and_gradients` fit."""
    require_windows("x", x, layers)
    require_shape("corrupted", corrupted, x.shape)
    if x.size == 0:
        raise ValueError(f"x has shape {x.shape}: there is nothing to compare")
    if first is None:
        return
    if len(first) != len(layers):
        raise ValueError(f"first has {len(first)} masks, expected {len(layers)}, one for a layer")
    batch, frames, _ = x.shape
    for k, (mask, layer) in enumerate(zip(first, layers, strict=True)):
        if mask is None:
            continue
        require_shape(f"first[{k}]", mask, (batch, frames >> (k + 1), layer.b.size))
        if np.asarray(mask).dtype != bool:
            raise ValueError(f"first[{k}] has dtype {np.asarray(mask).dtype}, expected bool")


def require_clips(name: str, x: np.ndarray, weights: dict[str, np.ndarray]) -> None:
    """Raise ValueError unless the encoder can read x."""
    require_shape(name, x, ("batch", "frames", len(weights["encoder_w"])))
    if x.shape[1] == 0:
        raise ValueError(f"{name} has shape {x.shape}: a clip has at least one frame")


def require_latent(z: np.ndarray, frames: int, weights: dict[str, np.ndarray]) -> None:
    """Raise ValueError unless the decoder can write this number of frames from z."""
    require_shape("z", z, ("batch", len(weights["state_w"])))
    if frames < 1:
        raise ValueError(f"frames is {frames}, expected at least 1")


def require_sequence_arguments(
    x: np.ndarray, prior: np.ndarray, weights: dict[str, np.ndarray]
) -> None:
    """Raise ValueError unless the arguments of `SequentialAutoencoder.loss_and_gradients` fit."""
    require_clips("x", x, weights)
    if len(x) == 0:
        raise ValueError(f"x has shape {x.shape}: there is nothing to compare")
    require_shape("prior", prior, (len(x), weights["latent_b"].size))
