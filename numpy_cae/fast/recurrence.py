"""The steps of a GRU over a clip, in place: `ops.gru_step` without temporary arrays.

A step keeps the factors that its pullback multiplies by and nothing else. With
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

from numpy_cae.fast.aligned import aligned_empty


class Recurrence:
    """The buffers of one GRU for T steps of B clips.

    Attributes
    ----------
    states : (T + 1, H + 1, B) array
        h_0 to h_T, each with a row of ones below, so that U · h + c is one product.
    """

    def __init__(self, hidden: int, batch: int, frames: int, dtype: np.dtype, training: bool):
        self.hidden, self.frames, self.training = hidden, frames, training
        self.states = aligned_empty((frames + 1, hidden + 1, batch), dtype)
        self.states[0] = 0
        self.states[:, hidden] = 1
        factors = aligned_empty((frames if training else 1, 5, hidden, batch), dtype)
        self._factors = [factors[k if training else 0] for k in range(frames)]
        self._h = [state[:hidden] for state in self.states]
        self._half, self._one = np.array(0.5, dtype), np.array(1, dtype)
        self._n, self._d = aligned_empty((2, hidden, batch), dtype)
        self._slope = aligned_empty((2, hidden, batch), dtype)
        self._views = [(each[3:], *each[3:], *each[:3]) for each in self._factors]
        self._pairs = [(each[:2], each[2:4], each[4]) for each in self._factors]

    def step(
        self, k: int, a: tuple[np.ndarray, np.ndarray], s: tuple[np.ndarray, np.ndarray]
    ) -> None:
        """h_(k+1) from h_k; `a` and `s` are ((2, H, B) for reset and update, (H, B) for new)."""
        (a_rz, a_n), (s_rz, s_n) = a, s
        rz, r, z, p_n, p_z, p_r = self._views[k]
        h, h_next, n, d = self._h[k], self._h[k + 1], self._n, self._d
        np.add(a_rz, s_rz, rz)
        np.tanh(rz, rz)
        np.multiply(rz, self._half, rz)
        np.add(rz, self._half, rz)
        np.multiply(r, s_n, n)
        np.add(n, a_n, n)
        np.tanh(n, n)
        np.subtract(h, n, d)
        np.multiply(z, d, h_next)
        np.add(h_next, n, h_next)  # n + z ∘ (h - n) = (1 - z) ∘ n + z ∘ h
        if self.training:
            slope = self._slope
            np.multiply(rz, rz, slope)
            np.subtract(rz, slope, slope)
            np.multiply(slope[1], d, p_z)
            np.multiply(slope[0], s_n, p_r)
            np.multiply(n, n, n)
            np.subtract(self._one, n, n)
            np.multiply(z, n, d)
            np.subtract(n, d, p_n)

    def step_pullback(self, k: int, dh: np.ndarray, gradients: np.ndarray) -> None:
        """Compute the parts of `gradients`, (4, H, B), from dh_(k+1); dh becomes z ∘ dh_(k+1)."""
        of_state, of_new, z = self._pairs[k]
        np.multiply(of_state, dh, gradients[::2])
        np.multiply(of_new, gradients[0], gradients[1::2])
        np.multiply(z, dh, dh)
