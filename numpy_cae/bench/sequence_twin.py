"""jang2018's network written in PyTorch as one writes it there, and the proof that it is the same.

The encoder is `nn.GRU`, the fastest that PyTorch has; the decoder, whose every input is its own
last output, is a loop over `nn.GRUCell`, since no fused layer can feed itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from numpy_cae.bench.torch_twin import torch
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import unit_directions

FRAMES = 50
LATENT = 32
DIRECTIONS = 64
WEIGHT = 0.1
"""λ."""


@dataclass(frozen=True)
class SequenceCase:
    """What one step of training is given.

    Parameters
    ----------
    x : (B, 50, features) array
    prior : (B, latent) array
    directions : (64, latent) array
    """

    x: np.ndarray
    prior: np.ndarray
    directions: np.ndarray

    @classmethod
    def drawn(cls, model: SequentialAutoencoder, batch: int, seed: int = 0) -> SequenceCase:
        """Random numbers of the size that training sees, in the dtype of the model."""
        rng = np.random.default_rng(seed)
        dtype = model.weights["state_w"].dtype
        return cls(
            rng.standard_normal((batch, FRAMES, model.features)).astype(dtype),
            rng.standard_normal((batch, model.latent)).astype(dtype),
            unit_directions(DIRECTIONS, model.latent, rng, dtype),
        )

    def ours(self, model: SequentialAutoencoder) -> Callable[[], object]:
        """The step as a function without arguments."""
        return lambda: model.loss_and_gradients(self.x, self.prior, self.directions, WEIGHT)


class SequenceTwin:
    """The weights of a `SequentialAutoencoder` in PyTorch's layers.

    Parameters
    ----------
    model : SequentialAutoencoder
    """

    def __init__(self, model: SequentialAutoencoder):
        features, hidden, latent = model.features, model.hidden, model.latent
        self.encoder = torch.nn.GRU(features, hidden, batch_first=True)
        self.latent = torch.nn.Linear(hidden, latent)
        self.state = torch.nn.Linear(latent, hidden)
        self.decoder = torch.nn.GRUCell(features, hidden)
        self.frame = torch.nn.Linear(hidden, features)
        self.parameters = {}
        theirs = {"w": "weight_ih", "u": "weight_hh", "b": "bias_ih", "c": "bias_hh"}
        for letter, name in theirs.items():
            self.parameters[f"encoder_{letter}"] = getattr(self.encoder, f"{name}_l0")
            self.parameters[f"decoder_{letter}"] = getattr(self.decoder, name)
        for name, layer in (("latent", self.latent), ("state", self.state), ("frame", self.frame)):
            self.parameters |= {f"{name}_w": layer.weight, f"{name}_b": layer.bias}
        for name, parameter in self.parameters.items():
            parameter.data = torch.tensor(np.ascontiguousarray(model.weights[name].T))

    def reconstruct(self, x):
        """z, and the clip that is written from it."""
        _, last = self.encoder(x)
        z = self.latent(last[0])
        h, y, written = self.state(z), torch.zeros_like(x[:, 0]), []
        for _ in range(x.shape[1]):
            h = self.decoder(y, h)
            y = self.frame(h)
            written.append(y)
        return z, torch.stack(written[::-1], dim=1)

    def theirs(self, case: SequenceCase) -> Callable[[], object]:
        """The step as a function without arguments."""
        x, prior, directions = map(torch.tensor, (case.x, case.prior, case.directions))

        def step():
            for parameter in self.parameters.values():
                parameter.grad = None
            z, x_hat = self.reconstruct(x)
            encoded, drawn = (torch.sort(each @ directions.T, dim=0)[0] for each in (z, prior))
            gap = encoded - drawn
            loss = ((x_hat - x) ** 2).mean() + WEIGHT * (gap * gap).mean()
            loss.backward()
            return loss.detach(), {name: each.grad for name, each in self.parameters.items()}

        return step


def require_agreement(
    model: SequentialAutoencoder, case: SequenceCase, tolerance: float = 1e-9
) -> None:
    """Raise unless PyTorch computes what we compute, both in float64.

    Raises
    ------
    ArithmeticError
        Naming the largest difference and the weight whose gradient it is in.
    """
    losses, gradients = case.ours(model)()
    loss, theirs = SequenceTwin(model).theirs(case)()
    pairs = {"the loss": (np.float64(losses.total), loss.numpy())}
    pairs |= {name: (each, theirs[name].numpy().T) for name, each in gradients.items()}
    for name, (a, b) in pairs.items():
        difference = np.abs(a - b).max() / max(1.0, np.abs(a).max())
        if not difference <= tolerance:
            raise ArithmeticError(
                f"PyTorch and we differ in {name!r} by {difference:.1e}: "
                "their times would compare two different things"
            )
