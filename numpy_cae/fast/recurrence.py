"""The steps of a GRU over a clip, in place: `ops.gru_step` without temporary arrays.

A step keeps only the factors that its pullback multiplies by. With
a = W · x + b, s = U · h + c, d = h - n, and dh the gradient for the state after the step:

    kept:    p_n = (1 - z) ∘ (1 - n²),   p_z = d ∘ z ∘ (1 - z),   p_r = s_n ∘ r ∘ (1 - r),   r,   z

    da_n, da_z = (p_n, p_z) ∘ dh            one call
    da_r, ds_n = (p_r, r) ∘ da_n            likewise
    dh ← z ∘ dh + Uᵀ · (ds_r, ds_z, ds_n)

The gradients of a step are stored in the order da_n, da_r, da_z, ds_n. Since ds_r = da_r and
ds_z = da_z, the first three are da and the last three ds, each one factor of a matrix product. So a
has the order new, reset, update and s the order reset, update, new: see `gru_matrices`.

σ(v) = (1 + tanh(v / 2)) / 2; the factor 1/2 of v is already in the rows of W, U, b and c.
"""

import numpy as np

from numpy_cae.fast.products import aligned_empty


class Recurrence:
    """The buffers of one GRU for T steps of B clips.

    Attributes
    ----------
    states : (2, H + 1, B) array
        h_k is `states[k % 2]`, with a row of ones below, so that U · h + c is one product.
    recorded : (H + 1, T', B) array
        Where a step of training copies h_k to, T' >= T.
    """

    def __init__(self, hidden: int, frames: int, recorded: np.ndarray, training: bool):
        self.training, self.recorded = training, recorded
        batch, dtype = recorded.shape[2], recorded.dtype
        self.states = aligned_empty((2, hidden + 1, batch), dtype)
        self.states[:, hidden] = 1
        factors = list(aligned_empty((frames if training else 1, 5, hidden, batch), dtype))
        factors *= 1 if training else frames
        self._half, self._one = np.array(0.5, dtype), np.array(1, dtype)
        self._n = aligned_empty((hidden, batch), dtype)
        self._rest = aligned_empty((2, hidden, batch), dtype)
        self._views = [(each[3:], each[2:0:-1], *each) for each in factors]
        self._pairs = [(each[:2], each[2:4], each[4]) for each in factors]

    def start(self, h0: np.ndarray | float) -> None:
        """Set h_0, (H, B)."""
        self.states[0, :-1] = h0

    def step(
        self, k: int, a: tuple[np.ndarray, np.ndarray], s: tuple[np.ndarray, np.ndarray]
    ) -> None:
        """h_(k+1) from h_k; `a` and `s` are ((2, H, B) for reset and update, (H, B) for new)."""
        (a_rz, a_n), (s_rz, s_n) = a, s
        rz, p_rz, p_n, p_z, p_r, r, z = self._views[k]
        h, h_next, n = self.states[k % 2, :-1], self.states[1 - k % 2, :-1], self._n
        np.add(a_rz, s_rz, rz)
        np.tanh(rz, rz)
        np.multiply(rz, self._half, rz)
        np.add(rz, self._half, rz)
        np.multiply(r, s_n, p_r)
        np.add(p_r, a_n, n)
        np.tanh(n, n)
        np.subtract(h, n, p_z)
        np.multiply(p_z, z, p_z)
        np.add(p_z, n, h_next)  # n + z ∘ (h - n) = (1 - z) ∘ n + z ∘ h
        if self.training:
            self.recorded[:-1, k] = h
            rest = self._rest
            np.subtract(self._one, rz, rest)
            np.multiply(p_rz, rest, p_rz)
            np.multiply(n, n, n)
            np.subtract(self._one, n, n)
            np.multiply(n, rest[1], p_n)

    def step_pullback(self, k: int, dh: np.ndarray, gradients: np.ndarray) -> None:
        """Compute the parts of `gradients`, (4, H, B), from dh_(k+1); dh becomes z ∘ dh_(k+1)."""
        of_state, of_new, z = self._pairs[k]
        np.multiply(of_state, dh, gradients[::2])
        np.multiply(of_new, gradients[0], gradients[1::2])
        np.multiply(z, dh, dh)
