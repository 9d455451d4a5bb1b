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
    layers, dtype = model.layers, model.layers[0].w.dtype
    for index in (*range(len(layers)), None):
        used = layers if index is None else [layers[index]]
        frames = FRAMES >> (index or 0)
        x = (0.25 * rng.normal(size=(batch, frames, used[0].w.shape[1]))).astype(dtype)
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
        self.layers = [
            (_parameter(layer.w.transpose(2, 1, 0)), _parameter(layer.b), layer.bound)
            for layer in model.layers
        ]

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

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)) of windows (B, T, C)."""
        with torch.inference_mode():
            y = self.encode(_transposed(x), self.layers)
            projected = self.decode(y, self.layers, [None] * len(self.layers))
        return projected.numpy().transpose(0, 2, 1)

    def function(self, case: Case) -> Callable[[], Any]:
        """The case as a function without arguments; its windows are transposed beforehand."""
        x, corrupted = _transposed(case.x), _transposed(case.corrupted)
        layers = self.layers if case.layer is None else [self.layers[case.layer]]
        masks = [None] * len(layers) if case.first is None else list(map(_transposed, case.first))

        def step():
            for w, b, _ in layers:
                w.grad = b.grad = None
            y = self.encode(corrupted, layers)
            loss = ((self.decode(y, layers, masks) - x) ** 2).mean()
            if case.alpha:
                loss = loss + case.alpha * y.abs().mean()
            loss.backward()
            return loss.detach(), [(w.grad, b.grad) for w, b, _ in layers]

        if case.kind == "step":
            return step

        def infer():
            y = self.encode(x, layers)
            return y if case.kind == "encode" else self.decode(y, layers, masks)

        return torch.inference_mode()(infer)

    def arrays(self, case: Case) -> list[np.ndarray]:
        """The results of the case, in the order of `arrays_of`."""
        result = self.function(case)()
        if case.kind != "step":
            return [result.numpy().transpose(0, 2, 1)]
        loss, gradients = result
        both = [(w.numpy().transpose(2, 1, 0), b.numpy()) for w, b in gradients]
        return [loss.numpy(), *(array for pair in both for array in pair)]


def arrays_of(model: ConvAutoencoder, case: Case) -> list[np.ndarray]:
    """The results of the case: an array, or the loss and the gradients."""
    result = case.function(model)()
    if case.kind != "step":
        return [result]
    loss, gradients = result
    return [np.asarray(loss), *(array for pair in gradients for array in pair)]


def require_agreement(name: str, ours: list[np.ndarray], theirs: list[np.ndarray]) -> None:
    """Raise ArithmeticError unless both are equal but for rounding, in float64.

    In float32 a value next to the bound of arctanh, or two nearly equal ones in a pair, may be
    rounded to either side, and both would be right.
    """
    for a, b in zip(ours, theirs, strict=True):
        difference = np.abs(a - b).max() / max(1.0, np.abs(a).max())
        if not difference <= 1e-9:
            raise ArithmeticError(
                f"PyTorch's result differs in {name!r} by {difference:.1e}, so the times would "
                "compare two different computations"
            )


def _parameter(array: np.ndarray):
    return torch.tensor(np.ascontiguousarray(array), requires_grad=True)


def _transposed(x: np.ndarray):
    """(B, T, C) as a tensor (B, C, T)."""
    return torch.tensor(np.ascontiguousarray(x.transpose(0, 2, 1)))
