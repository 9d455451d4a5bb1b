"""The conventions of the GRU: equal networks whose weights have different meanings.

`numpy_cae.ops` follows PyTorch and cuDNN. A GRU in another convention has other values but is not
wrong; a report says which convention it is and tests it by the definition in that convention.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from numpy_cae.ops import gru_step, linear, sigmoid

OURS = ("reset", "update", "new")
ORDERS = (OURS, ("update", "reset", "new"))


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


def other_conventions() -> Iterator[Convention]:
    """Every convention but ours."""
    for flags in product((True, False), (True, False), ORDERS):
        if Convention(*flags) != PYTORCH:
            yield Convention(*flags)


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
