"""The timed cases of `ConvAutoencoder`, here and written in PyTorch as is usual there.

PyTorch is optional: without it `torch` is None and the table has no column for it.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from numpy_cae.models import ConvAutoencoder

try:
    import torch
    import torch.nn.functional as F
except ImportError:
    torch = None

FRAMES = 160


@dataclass(frozen=True)
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
        name, alpha = ("whole", 0.0) if index is None else (f"layer {index + 1}", 0.01)
        for unpooling, first in (("random", masks), ("even", None)):
            yield Case(f"{name}, {unpooling}", "step", x, corrupted, first, index, alpha)
    yield Case("encode", "encode", x, x, None, None)
    yield Case("encode + decode", "project", x, x, None, None)


class TorchModel:
    """The layers of a `ConvAutoencoder` in PyTorch, where windows are (B, C, T)."""

    def __init__(self, model: ConvAutoencoder):
        self.layers = [(_tensor(layer.w), _tensor(layer.b), layer.bound) for layer in model.layers]
        self.parameters = [parameter for w, b, _ in self.layers for parameter in (w, b)]
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
        return [array for each in result for array in arrays_in(each)]
    return [np.asarray(result)]


def windows(x: np.ndarray):
    """(B, T, C) as a tensor (B, C, T)."""
    return torch.tensor(np.ascontiguousarray(x.transpose(0, 2, 1)))


def _tensor(weights: np.ndarray):
    """(K, C, D) as a tensor (D, C, K), or (D,)."""
    return torch.tensor(np.ascontiguousarray(weights.T))
