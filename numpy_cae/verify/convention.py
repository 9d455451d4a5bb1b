"""Other conventions of an operation: right in their own way, but not what the contract says.

The contract is that of `numpy_cae.ops`. A report that is asked to allow other conventions says
which one a function has, and tests it by the definition in that convention.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product

import numpy as np

from numpy_cae import ops
from numpy_cae.ops import gru_step, linear, sigmoid

OURS = ("reset", "update", "new")
ORDERS = (OURS, ("update", "reset", "new"))


@dataclass(frozen=True)
class Variant:
    """One operation in another convention: what differs, and its value and pullback."""

    sentence: str
    reference: Callable = field(repr=False)
    without: tuple[str, ...] = ()  # the properties that only the contract has


@dataclass(frozen=True)
class Convention:
    """What may differ between two right GRUs."""

    reset_after: bool = True  # r ∘ (h · Un + cn), else (r ∘ h) · Un + cn as in Cho et al. 2014
    update_keeps: bool = True  # h' = (1 - z) ∘ n + z ∘ h, else h' = z ∘ n + (1 - z) ∘ h
    order: tuple[str, str, str] = OURS  # of the gates in the columns of w, u, b and c

    def __str__(self) -> str:
        parts = [
            "" if self.reset_after else "the reset gate acts before the product, (r ∘ h) · Un",
            "" if self.update_keeps else "z and 1 - z are exchanged, h' = z ∘ n + (1 - z) ∘ h",
            "" if self.order == OURS else f"the gates are in the order {', '.join(self.order)}",
        ]
        return "; ".join(filter(None, parts)) or "that of PyTorch and cuDNN"


PYTORCH = Convention()


def other_conventions() -> list[Convention]:
    """Every convention of the GRU but ours, those that differ least first."""
    conventions = [Convention(*flags) for flags in product((True, False), (True, False), ORDERS)]
    return sorted(conventions, key=lambda c: str(c).count(";") + (c != PYTORCH))[1:]


def gru_step_in(convention: Convention) -> Callable:
    """`gru_step` in another convention, with its pullback, computed by ours.

    The gates change places with the columns; z becomes 1 - z when its columns change sign.
    """
    step = gru_step if convention.reset_after else _step_reset_before

    def translated(weights: np.ndarray, order=convention.order, into=OURS) -> np.ndarray:
        parts = dict(zip(order, np.split(weights, 3, axis=-1), strict=True))
        if not convention.update_keeps:
            parts["update"] = -parts["update"]
        return np.concatenate([parts[gate] for gate in into], axis=-1)

    def step_in_convention(x, h, w, u, b, c):
        h_next, step_pullback = step(x, h, *map(translated, (w, u, b, c)))

        def pullback(dh_next):
            dx, dh, *of_weights = step_pullback(dh_next)
            return dx, dh, *(translated(g, OURS, convention.order) for g in of_weights)

        return h_next, pullback

    return step_in_convention


def gru_in(convention: Convention) -> Callable:
    """`gru` in another convention: its step, repeated."""
    step = gru_step_in(convention)

    def gru_in_convention(x, h0, w, u, b, c):
        h, states, pullbacks = h0, [], []
        for frame in np.moveaxis(x, 1, 0):
            h, step_pullback = step(frame, h, w, u, b, c)
            states.append(h)
            pullbacks.append(step_pullback)

        def pullback(dy):
            dh, dx = np.zeros_like(h0), np.empty_like(x)
            sums = [np.zeros_like(weights) for weights in (w, u, b, c)]
            for t in reversed(range(len(pullbacks))):
                dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
                sums = [total + term for total, term in zip(sums, terms, strict=True)]
            return dx, dh, *sums

        return np.stack(states, axis=1), pullback

    return gru_in_convention


def _step_reset_before(x, h, w, u, b, c):
    """n = tanh(x · Wn + bn + (r ∘ h) · Un + cn), the rest as in `numpy_cae.ops.gru_step`."""
    hidden = h.shape[1]
    gates, new = slice(None, 2 * hidden), slice(2 * hidden, None)
    a, a_pullback = linear(x, w, b)
    s, s_pullback = linear(h, u[:, gates], c[gates])
    r, z = np.split(sigmoid(a[:, gates] + s)[0], 2, axis=-1)
    s_n, s_n_pullback = linear(r * h, u[:, new], c[new])
    n = np.tanh(a[:, new] + s_n)
    h_next = (1 - z) * n + z * h

    def pullback(dh_next):
        da_n = dh_next * (1 - z) * (1 - n * n)
        drh, du_n, dc_n = s_n_pullback(da_n)
        da_r = drh * h * r * (1 - r)
        da_z = dh_next * (h - n) * z * (1 - z)
        ds = np.concatenate([da_r, da_z], axis=-1)
        dx, dw, db = a_pullback(np.concatenate([ds, da_n], axis=-1))
        dh_through_s, du_gates, dc_gates = s_pullback(ds)
        dh = dh_next * z + drh * r + dh_through_s
        du = np.concatenate([du_gates, du_n], axis=-1)
        return dx, dh, dw, du, db, np.concatenate([dc_gates, dc_n])

    return h_next, pullback


def _scaled(operation: Callable, factor: Callable[..., float]) -> Callable:
    """The operation times a factor that depends on its first argument."""

    def scaled(x, *others):
        value, pullback = operation(x, *others)
        return value * factor(x), lambda *dy: pullback(*dy) * factor(x)

    return scaled


def _tie_to_the_later(x):
    y, pullback = ops.max_pool(_pairs_exchanged(x))
    return y, lambda dy: _pairs_exchanged(pullback(dy))


def _tie_to_both(x):
    y, to_earlier = ops.max_pool(x)
    _, to_later = _tie_to_the_later(x)
    return y, lambda dy: (to_earlier(dy) + to_later(dy)) / 2


def _pairs_exchanged(x):
    return np.stack([x[:, 1::2], x[:, 0::2]], axis=2).reshape(x.shape)


def _filters_flipped(x, w, b):
    y, pullback = ops.conv1d(x, w[::-1], b)

    def flipped(dy):
        dx, dw, db = pullback(dy)
        return dx, dw[::-1], db

    return y, flipped


_LOSSES = (
    ("half the mean, so that the derivative has no 2", lambda x: 0.5),
    ("a sum over all elements where the contract says the mean", lambda x: x.size),
    ("half the sum over all elements", lambda x: x.size / 2),
    ("a sum over frames and features, a mean over windows", lambda x: x.size / len(x)),
)


def _losses(operation: Callable, *numbers: int) -> tuple[Variant, ...]:
    chosen = (_LOSSES[number] for number in numbers)
    return tuple(Variant(sentence, _scaled(operation, factor)) for sentence, factor in chosen)


VARIANTS: dict[str, tuple[Variant, ...]] = {
    "gru_step": tuple(Variant(str(c), gru_step_in(c)) for c in other_conventions()),
    "gru": tuple(Variant(str(c), gru_in(c)) for c in other_conventions()),
    "conv1d": (Variant("the filters are flipped in time, a true convolution", _filters_flipped),),
    "max_pool": (
        Variant("a tie goes to the later frame", _tie_to_the_later),
        Variant("of a tie both frames get half the gradient", _tie_to_both),
    ),
    "unpool_even": (
        Variant(
            "both frames get the whole value",
            _scaled(ops.unpool_even, lambda y: 2),
            ("pair sums",),
        ),
    ),
    "mean_squared_error": _losses(ops.mean_squared_error, 0, 1, 2, 3),
    "mean_absolute": _losses(ops.mean_absolute, 1, 3),
    "sliced_wasserstein": (
        Variant(
            "a sum over the points where the contract says the mean",
            _scaled(ops.sliced_wasserstein, len),
            ("optimal assignment",),
        ),
    ),
}
"""By operation, the documented conventions other than ours."""
