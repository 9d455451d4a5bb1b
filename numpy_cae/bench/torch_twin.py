"""The same network written in PyTorch as one writes it there, and the proof that it is the same.

PyTorch is no dependency: where it is missing, `torch` is None and the table has no column for it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae.bench.cases import Case, alpha
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder

try:
    import torch
    import torch.nn.functional as F
except ImportError:
    torch = None


class TorchTwin:
    """The layers of a `ConvAutoencoder` as PyTorch parameters; windows are (B, C, T) there.

    Parameters
    ----------
    model : ConvAutoencoder
    """

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

    def theirs(self, case: Case) -> Callable[[], object]:
        """The case as a function without arguments, its windows turned beforehand."""
        x, corrupted = _turned(case.x), _turned(case.corrupted)
        layers = self.layers if case.layer is None else [self.layers[case.layer]]
        masks = [None] * len(layers) if case.first is None else [_turned(m) for m in case.first]

        def step():
            for w, b, _ in layers:
                w.grad = b.grad = None
            y = self.encode(corrupted, layers)
            loss = ((self.decode(y, layers, masks) - x) ** 2).mean()
            if alpha(case):
                loss = loss + alpha(case) * y.abs().mean()
            loss.backward()
            return loss.detach(), [(w.grad, b.grad) for w, b, _ in layers]

        @torch.inference_mode()
        def encode():
            return self.encode(x, layers)

        @torch.inference_mode()
        def project():
            return self.decode(self.encode(x, layers), layers, masks)

        return {"step": step, "encode": encode, "project": project}[case.kind]


def require_agreement(model: ConvAutoencoder, case: Case, tolerance: float = 1e-9) -> None:
    """Raise unless PyTorch computes what we compute, both in float64.

    In float32 a value next to the bound of arctanh, or two nearly equal ones in a pair, may fall to
    either side, and both would be right.

    Raises
    ------
    ArithmeticError
        Naming the case and the largest difference.
    """
    ours = _flat_ours(case, case.ours(accelerate(model))())
    theirs = _flat_theirs(case, TorchTwin(model).theirs(case)())
    for a, b in zip(ours, theirs, strict=True):
        difference = np.abs(a - b).max() / max(1.0, np.abs(a).max())
        if not difference <= tolerance:
            raise ArithmeticError(
                f"PyTorch and we differ in {case.name!r} by {difference:.1e}: "
                "their times would compare two different things"
            )


def _flat_ours(case: Case, result) -> list[np.ndarray]:
    if case.kind != "step":
        return [result]
    loss, gradients = result
    return [np.asarray(loss), *(array for pair in gradients for array in pair)]


def _flat_theirs(case: Case, result) -> list[np.ndarray]:
    if case.kind != "step":
        return [result.numpy().transpose(0, 2, 1)]
    loss, gradients = result
    return [
        loss.numpy(),
        *(each for w, b in gradients for each in (w.numpy().transpose(2, 1, 0), b.numpy())),
    ]


def _parameter(array: np.ndarray):
    return torch.tensor(np.ascontiguousarray(array), requires_grad=True)


def _turned(x: np.ndarray):
    """(B, T, C) as (B, C, T)."""
    return torch.tensor(np.ascontiguousarray(x.transpose(0, 2, 1)))
