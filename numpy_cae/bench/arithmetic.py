"""The operations of the direct form, for the column "of peak" of the table.

A convolution of T frames takes K · C · D multiplications and as many additions a frame. A training
step convolves with each layer's W six times: in the encoder and the decoder, in the pullback of
each, and for the two shares of the gradient for W. The gradient for the lowest layer's input is not
computed. An algorithm that needs fewer operations can exceed 100%.
"""

from __future__ import annotations

from collections.abc import Sequence

from numpy_cae.models import ConvLayer, SequentialAutoencoder


def encoding(layers: Sequence[ConvLayer], frames: int) -> int:
    """Operations of Φ for one window; Φ† takes as many."""
    return sum(_convolution(layer, frames >> k) for k, layer in enumerate(layers))


def training_step(layers: Sequence[ConvLayer], frames: int) -> int:
    """Operations of a loss and its gradients for one window."""
    return 6 * encoding(layers, frames) - _convolution(layers[0], frames)


def _convolution(layer: ConvLayer, frames: int) -> int:
    """Operations of X * W for one window."""
    return 2 * frames * layer.w.size


def sequence_step(model: SequentialAutoencoder, frames: int) -> int:
    """Operations of a loss and its gradients for one clip through both GRUs.

    Every frame is multiplied by each matrix, by its transpose, and for its gradient; the gradient
    for the clip is not computed. The maps to and from z, once a clip, are neglected.
    """
    weights = model.weights
    names = ("encoder_w", "encoder_u", "decoder_w", "decoder_u", "frame_w")
    products = 3 * sum(weights[name].size for name in names) - weights["encoder_w"].size
    return 2 * frames * products
