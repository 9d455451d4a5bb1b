"""What the direct form would cost: the yardstick of the column "of peak".

A convolution of T frames takes K · C · D multiplications and as many additions a frame. A step goes
through each layer's W six times: up, down, back through both, and two gradients for W. Nobody asks
for the gradient of the lowest layer's input. A form that needs fewer operations passes 100%.
"""

from __future__ import annotations

from collections.abc import Sequence

from numpy_cae.models import ConvLayer, SequentialAutoencoder


def convolution(layer: ConvLayer, frames: int) -> int:
    """Operations of X * W for one window."""
    return 2 * frames * layer.w.size


def training_step(layers: Sequence[ConvLayer], frames: int) -> int:
    """Operations of a loss and its gradients for one window, by the direct form."""
    each = [convolution(layer, frames >> k) for k, layer in enumerate(layers)]
    return 6 * sum(each) - each[0]


def encoding(layers: Sequence[ConvLayer], frames: int) -> int:
    """Operations of Φ for one window, by the direct form; Φ† takes as many."""
    return sum(convolution(layer, frames >> k) for k, layer in enumerate(layers))


def sequence_step(model: SequentialAutoencoder, frames: int) -> int:
    """Operations of a loss and its gradients for one clip through both GRUs.

    Every frame goes through each matrix three times: there, back, and for its gradient. Nobody
    asks for the gradient of the clip itself. The maps to and from z, once a clip, are not counted.
    """
    weights = model.weights
    names = ("encoder_w", "encoder_u", "decoder_w", "decoder_u", "frame_w")
    thrice = 3 * sum(weights[name].size for name in names)
    return 2 * frames * (thrice - weights["encoder_w"].size)
