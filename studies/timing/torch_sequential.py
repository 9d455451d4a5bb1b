"""A training step of `SequentialAutoencoder`, here and written in PyTorch as is usual there.

The encoder is `nn.GRU`, the fastest of PyTorch; the decoder, whose input is its own last output, is
a loop over `nn.GRUCell`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import unit_directions
from studies.timing.torch_convolutional import torch

FRAMES, LATENT, DIRECTIONS = 50, 32, 64
WEIGHT = 0.1
"""λ."""
OF_GRU = {"w": "weight_ih", "u": "weight_hh", "b": "bias_ih", "c": "bias_hh"}
"""Our names of a GRU's weights to PyTorch's."""


@dataclass(frozen=True)
class SequenceCase:
    """The arguments of one training step."""

    x: np.ndarray
    prior: np.ndarray
    directions: np.ndarray

    @classmethod
    def drawn(cls, model: SequentialAutoencoder, batch: int, seed: int = 0) -> SequenceCase:
        """Random numbers as large as those of training, in the dtype of the model."""
        rng, dtype = np.random.default_rng(seed), model.weights["state_w"].dtype
        return cls(
            rng.standard_normal((batch, FRAMES, model.features)).astype(dtype),
            rng.standard_normal((batch, model.latent)).astype(dtype),
            unit_directions(DIRECTIONS, model.latent, rng, dtype),
        )

    def function(self, model: SequentialAutoencoder) -> Callable[[], Any]:
        """The step as a function without arguments."""

        def step():
            losses, gradients = model.loss_and_gradients(
                self.x, self.prior, self.directions, WEIGHT
            )
            return losses.total, list(gradients.values())

        return step


class TorchSequenceModel:
    """The weights of a `SequentialAutoencoder` in PyTorch's layers."""

    def __init__(self, model: SequentialAutoencoder):
        features, hidden, latent = model.features, model.hidden, model.latent
        self.burn_in = model.burn_in
        self.encoder = torch.nn.GRU(features, hidden, batch_first=True)
        self.decoder = torch.nn.GRUCell(features, hidden)
        self.latent = torch.nn.Linear(hidden, latent)
        self.state = torch.nn.Linear(latent, hidden)
        self.frame = torch.nn.Linear(hidden, features)
        self.parameters = [self._parameter(*name.split("_")) for name in model.weights]
        for parameter, weight in zip(self.parameters, model.weights.values(), strict=True):
            parameter.data = torch.tensor(np.ascontiguousarray(weight.T))

    def _parameter(self, layer: str, letter: str):
        if layer in ("encoder", "decoder"):
            return getattr(getattr(self, layer), OF_GRU[letter] + "_l0" * (layer == "encoder"))
        return getattr(getattr(self, layer), {"w": "weight", "b": "bias"}[letter])

    def reconstruct(self, x):
        """z, and the clip that is written from it."""
        _, last = self.encoder(x)
        z = self.latent(last[0])
        h, y, written = self.state(z), torch.zeros_like(x[:, 0]), []
        for _ in range(self.burn_in + x.shape[1]):
            h = self.decoder(y, h)
            y = self.frame(h)
            written.append(y)
        return z, torch.stack(written[: -x.shape[1] - 1 : -1], dim=1)

    def denoise(self, x: np.ndarray) -> np.ndarray:
        """Clips (B, T, features) on the manifold."""
        with torch.inference_mode():
            return self.reconstruct(torch.tensor(x))[1].numpy()

    def function(self, case: SequenceCase, weight: float = WEIGHT) -> Callable[[], Any]:
        """The step as a function without arguments."""
        x, prior, directions = map(torch.tensor, (case.x, case.prior, case.directions))

        def step():
            for parameter in self.parameters:
                parameter.grad = None
            z, x_hat = self.reconstruct(x)
            encoded, drawn = (torch.sort(each @ directions.T, dim=0)[0] for each in (z, prior))
            gap = encoded - drawn
            loss = ((x_hat - x) ** 2).mean() + weight * (gap * gap).mean()
            loss.backward()
            return loss.detach(), [parameter.grad.t() for parameter in self.parameters]

        return step
