"""A training step of `SequentialAutoencoder`, here and written in PyTorch as is usual there.

The encoder is `nn.GRU`, the fastest of PyTorch; the decoder, whose input is its own last output, is
a loop over `nn.GRUCell`.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import unit_directions
from studies.timing.torch_convolutional import torch

FRAMES, LATENT, DIRECTIONS, WEIGHT = 50, 32, 64, 0.1
OF_GRU = {"w": "weight_ih", "u": "weight_hh", "b": "bias_ih", "c": "bias_hh"}
"""Our names of a GRU's weights to PyTorch's."""


def step(model: SequentialAutoencoder, batch: int, seed: int = 0) -> tuple[Callable, tuple]:
    """A step without arguments, and its arguments: numbers as large as those of training."""
    rng = np.random.default_rng(seed)
    dtype = model.weights["state_w"].dtype
    x = rng.standard_normal((batch, FRAMES, model.features)).astype(dtype)
    prior = rng.standard_normal((batch, model.latent)).astype(dtype)
    given = x, prior, unit_directions(DIRECTIONS, model.latent, rng, dtype)

    def ours() -> Any:
        losses, gradients = model.loss_and_gradients(*given, WEIGHT)
        return losses.total, list(gradients.values())

    return ours, given


def torch_step(model: SequentialAutoencoder, given: tuple) -> Callable[[], Any]:
    """The same step in PyTorch, from the same weights."""
    layers = {
        "encoder": torch.nn.GRU(model.features, model.hidden, batch_first=True),
        "decoder": torch.nn.GRUCell(model.features, model.hidden),
        "latent": torch.nn.Linear(model.hidden, model.latent),
        "state": torch.nn.Linear(model.latent, model.hidden),
        "frame": torch.nn.Linear(model.hidden, model.features),
    }
    parameters = []
    for name, weight in model.weights.items():
        layer, letter = name.split("_")
        if layer in ("encoder", "decoder"):
            theirs = OF_GRU[letter] + "_l0" * (layer == "encoder")
        else:
            theirs = {"w": "weight", "b": "bias"}[letter]
        parameters.append(getattr(layers[layer], theirs))
        parameters[-1].data = torch.tensor(np.ascontiguousarray(weight.T))
    x, prior, directions = map(torch.tensor, given)

    def theirs() -> Any:
        for parameter in parameters:
            parameter.grad = None
        z = layers["latent"](layers["encoder"](x)[1][0])
        h = layers["state"](z)
        frame, written = torch.zeros_like(x[:, 0]), []
        for _ in range(FRAMES + model.burn_in):
            h = layers["decoder"](frame, h)
            frame = layers["frame"](h)
            written.append(frame)
        x_hat = torch.stack(written[: -FRAMES - 1 : -1], dim=1)
        encoded, drawn = (torch.sort(each @ directions.T, dim=0)[0] for each in (z, prior))
        loss = ((x_hat - x) ** 2).mean() + WEIGHT * ((encoded - drawn) ** 2).mean()
        loss.backward()
        return loss.detach(), [parameter.grad.t() for parameter in parameters]

    return theirs
