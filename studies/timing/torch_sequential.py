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

FRAMES = 50
LATENT = 32
DIRECTIONS = 64
WEIGHT = 0.1
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


class TorchSequences:
    """The weights of a `SequentialAutoencoder` in PyTorch's layers."""

    def __init__(self, model: SequentialAutoencoder):
        self.burn_in = model.burn_in
        self.encoder = torch.nn.GRU(model.features, model.hidden, batch_first=True)
        self.decoder = torch.nn.GRUCell(model.features, model.hidden)
        self.latent = torch.nn.Linear(model.hidden, model.latent)
        self.state = torch.nn.Linear(model.latent, model.hidden)
        self.frame = torch.nn.Linear(model.hidden, model.features)
        self.parameters = []
        for name, weight in model.weights.items():
            layer, letter = name.split("_")
            if layer in ("encoder", "decoder"):
                theirs = OF_GRU[letter] + "_l0" * (layer == "encoder")
            else:
                theirs = {"w": "weight", "b": "bias"}[letter]
            parameter = getattr(getattr(self, layer), theirs)
            parameter.data = torch.tensor(np.ascontiguousarray(weight.T))
            self.parameters.append(parameter)

    def reconstruct(self, x):
        """z, and the clips (B, T, features) that are written from it."""
        z = self.latent(self.encoder(x)[1][0])
        h = self.state(z)
        frame = torch.zeros_like(x[:, 0])
        written = []
        for _ in range(x.shape[1] + self.burn_in):
            h = self.decoder(frame, h)
            frame = self.frame(h)
            written.append(frame)
        return z, torch.stack(written[: -x.shape[1] - 1 : -1], dim=1)

    def denoise(self, x: np.ndarray) -> np.ndarray:
        """Clips on the manifold."""
        with torch.inference_mode():
            return self.reconstruct(torch.tensor(x))[1].numpy()

    def loss(self, x, prior, directions, weight=WEIGHT):
        """The loss of jang2018 for one batch."""
        z, x_hat = self.reconstruct(x)
        encoded, drawn = (torch.sort(each @ directions.T, dim=0)[0] for each in (z, prior))
        return ((x_hat - x) ** 2).mean() + weight * ((encoded - drawn) ** 2).mean()


def torch_step(model: SequentialAutoencoder, given: tuple) -> Callable[[], Any]:
    """The same step in PyTorch, from the same weights."""
    network = TorchSequences(model)
    arguments = list(map(torch.tensor, given))

    def theirs() -> Any:
        for parameter in network.parameters:
            parameter.grad = None
        loss = network.loss(*arguments)
        loss.backward()
        return loss.detach(), [parameter.grad.t() for parameter in network.parameters]

    return theirs
