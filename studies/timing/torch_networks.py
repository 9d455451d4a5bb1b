"""Both networks written in PyTorch as is usual there, and the timed cases of ours and of these.

The encoder of the sequential network is `nn.GRU`, the fastest of PyTorch; the decoder, whose input
is its own last output, is a loop over `nn.GRUCell`. PyTorch is optional: without it `torch` is None
and the table has no column for it.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import unit_directions

try:
    import torch
    import torch.nn.functional as F
except ImportError:
    torch = None

FRAMES = 160


@dataclass(frozen=True, eq=False)
class Case:
    """A training step ("step"), an encoding ("encode") or a projection ("project") of windows."""

    name: str
    kind: str
    x: np.ndarray
    corrupted: np.ndarray
    first: list[np.ndarray] | None
    layer: int | None
    alpha: float = 0.0

    def function(self, model: ConvAutoencoder) -> Callable[[], Any]:
        """The case as a function without arguments."""
        if self.kind != "step":
            return partial(getattr(model, self.kind), self.x)
        arguments = self.x, self.corrupted, self.alpha, self.first, self.layer
        return partial(model.loss_and_gradients, *arguments)


def cases(model: ConvAutoencoder, batch: int, seed: int = 0) -> Iterator[Case]:
    """Every case for one batch size, of random numbers as large as those of training."""
    rng = np.random.default_rng(seed)
    layers = model.layers
    for index in (*range(len(layers)), None):
        used = layers if index is None else [layers[index]]
        frames = FRAMES >> (index or 0)
        x = (0.25 * rng.normal(size=(batch, frames, used[0].w.shape[1]))).astype(used[0].w.dtype)
        corrupted = x * (rng.random(x.shape) >= 0.1)
        masks = [
            rng.random((batch, frames >> (k + 1), layer.b.size)) < 0.5
            for k, layer in enumerate(used)
        ]
        if index is None:
            name = "whole"
            alpha = 0.0
        else:
            name = f"layer {index + 1}"
            alpha = 0.01
        for unpooling, first in (("random", masks), ("even", None)):
            yield Case(f"{name}, {unpooling}", "step", x, corrupted, first, index, alpha)
    yield Case("encode", "encode", x, x, None, None)
    yield Case("encode + decode", "project", x, x, None, None)


class TorchModel:
    """The layers of a `ConvAutoencoder` in PyTorch, where windows are (B, C, T)."""

    def __init__(self, model: ConvAutoencoder):
        self.layers = [(_tensor(layer.w), _tensor(layer.b), layer.bound) for layer in model.layers]
        self.parameters = []
        for w, b, _ in self.layers:
            self.parameters += [w, b]
        for parameter in self.parameters:
            parameter.requires_grad_()

    def encode(self, x, layers):
        """Equation 1 for each of the layers."""
        for w, b, _ in layers:
            x = torch.tanh(F.max_pool1d(F.conv1d(x, w, b, padding=w.shape[-1] // 2), 2))
        return x

    def decode(self, y, layers, masks):
        """Equation 2 for each of the layers, from the top."""
        for (w, b, bound), first in zip(reversed(layers), reversed(masks), strict=True):
            y = torch.atanh(torch.clamp(y, -bound, bound))
            if first is None:
                y = torch.repeat_interleave(y / 2, 2, dim=2)
            else:
                y = torch.stack((y * first, y * ~first), dim=3).flatten(2)
            y = F.conv_transpose1d(y - b[:, None], w, padding=w.shape[-1] // 2)
        return y

    def loss(self, x, corrupted, masks, layers, alpha=0.0):
        """Equation 3 of one batch."""
        y = self.encode(corrupted, layers)
        loss = ((self.decode(y, layers, masks) - x) ** 2).mean()
        return loss + alpha * y.abs().mean() if alpha else loss

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)) of windows (B, T, C)."""
        return self.function(Case("", "project", x, x, None, None))().numpy()

    def function(self, case: Case) -> Callable[[], Any]:
        """The case as a function without arguments; its windows are transposed beforehand."""
        x, corrupted = map(windows, (case.x, case.corrupted))
        layers = self.layers if case.layer is None else [self.layers[case.layer]]
        masks = [None] * len(layers) if case.first is None else list(map(windows, case.first))

        def step():
            for parameter in self.parameters:
                parameter.grad = None
            loss = self.loss(x, corrupted, masks, layers, case.alpha)
            loss.backward()
            return loss.detach(), [(w.grad.permute(2, 1, 0), b.grad) for w, b, _ in layers]

        @torch.inference_mode()
        def infer():
            y = self.encode(x, layers)
            y = y if case.kind == "encode" else self.decode(y, layers, masks)
            return y.transpose(1, 2)

        return step if case.kind == "step" else infer


def require_agreement(name: str, ours: Any, theirs: Any) -> None:
    """Raise ArithmeticError unless both results are equal but for rounding, in float64.

    In float32 a value next to the bound of arctanh, or two nearly equal ones in a pair, may be
    rounded to either side, and both would be right.
    """
    for a, b in zip(arrays_in(ours), arrays_in(theirs), strict=True):
        difference = np.abs(a - b).max() / max(1.0, np.abs(a).max())
        if not difference <= 1e-9:
            raise ArithmeticError(
                f"PyTorch's result differs in {name!r} by {difference:.1e}, so the times would "
                "compare two different computations"
            )


def arrays_in(result: Any) -> list[np.ndarray]:
    """The arrays of a result, which may be in tuples and lists."""
    if isinstance(result, tuple | list):
        arrays = []
        for part in result:
            arrays += arrays_in(part)
        return arrays
    return [np.asarray(result)]


def windows(x: np.ndarray):
    """(B, T, C) as a tensor (B, C, T)."""
    return torch.tensor(np.ascontiguousarray(x.transpose(0, 2, 1)))


def _tensor(weights: np.ndarray):
    """(K, C, D) as a tensor (D, C, K), or (D,)."""
    return torch.tensor(np.ascontiguousarray(weights.T))


CLIP = 50
LATENT = 32
DIRECTIONS = 64
WEIGHT = 0.1
OF_GRU = {"w": "weight_ih", "u": "weight_hh", "b": "bias_ih", "c": "bias_hh"}
"""Our names of a GRU's weights to PyTorch's."""


def step(model: SequentialAutoencoder, batch: int, seed: int = 0) -> tuple[Callable, tuple]:
    """A step without arguments, and its arguments: numbers as large as those of training."""
    rng = np.random.default_rng(seed)
    dtype = model.weights["state_w"].dtype
    x = rng.standard_normal((batch, CLIP, model.features)).astype(dtype)
    prior = rng.standard_normal((batch, model.latent)).astype(dtype)
    arguments = x, prior, unit_directions(DIRECTIONS, model.latent, rng, dtype)

    def ours() -> Any:
        losses, gradients = model.loss_and_gradients(*arguments, WEIGHT)
        return losses.total, list(gradients.values())

    return ours, arguments


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
                torch_name = OF_GRU[letter]
            else:
                torch_name = {"w": "weight", "b": "bias"}[letter]
            if layer == "encoder":
                torch_name += "_l0"
            parameter = getattr(getattr(self, layer), torch_name)
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
        encoded, _ = torch.sort(z @ directions.T, dim=0)
        drawn, _ = torch.sort(prior @ directions.T, dim=0)
        return ((x_hat - x) ** 2).mean() + weight * ((encoded - drawn) ** 2).mean()


def torch_step(model: SequentialAutoencoder, arguments: tuple) -> Callable[[], Any]:
    """The same step in PyTorch, from the same weights."""
    network = TorchSequences(model)
    tensors = list(map(torch.tensor, arguments))

    def theirs() -> Any:
        for parameter in network.parameters:
            parameter.grad = None
        loss = network.loss(*tensors)
        loss.backward()
        return loss.detach(), [parameter.grad.t() for parameter in network.parameters]

    return theirs
