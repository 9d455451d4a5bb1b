"""The maximum mean discrepancy, another distance between the codes and the prior.

jang2018 cites Tolstikhin et al., "Wasserstein Auto-Encoders" (ICLR 2018) for its regulariser. Their
WAE-MMD, and the authors' later program (github.com/DK-Jang/human_motion_manifold, `trainer.py`,
weight 0.1), have inverse multiquadratic kernels at seven scales:

    k(d) = Σ_s C_s / (C_s + d),   C_s = 2 D s,   d = ‖a - b‖²
    MMD  = Σ_{i≠j} (k(z_i, z_j) + k(p_i, p_j)) / (N (N - 1)) - 2 Σ_{i,j} k(z_i, p_j) / N²

Since dk/da = 2 k'(d) (a - b) with k'(d) = -Σ_s C_s / (C_s + d)²,

    dL/dz_i = 4 Σ_j k'(z_i, z_j) (z_i - z_j) / (N (N - 1)) - 4 Σ_j k'(z_i, p_j) (z_i - p_j) / N²
"""

import numpy as np

from numpy_cae import ops
from numpy_cae.fast.fast_sequential_autoencoder import FastSequentialAutoencoder
from numpy_cae.models.sequential_autoencoder import Losses, Weights
from numpy_cae.ops.shapes import Pullback

SCALES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
"""s of the module's kernel."""


def maximum_mean_discrepancy(z: np.ndarray, prior: np.ndarray) -> tuple[float, Pullback]:
    """MMD of the codes z (N, D) and as many draws of the prior, N at least 2, and its pullback.

    The prior gets no gradient.
    """
    count = len(z)
    inside = count * (count - 1)
    between = count * count
    k_z, slope_z = _kernel(z, z)
    k_prior, _ = _kernel(prior, prior)
    k_both, slope_both = _kernel(z, prior)
    # Each diagonal of k_z and k_prior is the number of scales.
    diagonal = 2 * count * len(SCALES)
    loss = (k_z.sum() + k_prior.sum() - diagonal) / inside - 2 * k_both.sum() / between

    def pullback(dloss: float = 1.0) -> np.ndarray:
        from_codes = slope_z.sum(axis=1, keepdims=True) * z - slope_z @ z
        from_prior = slope_both.sum(axis=1, keepdims=True) * z - slope_both @ prior
        return (dloss * 4 * (from_codes / inside - from_prior / between)).astype(z.dtype)

    return loss.astype(z.dtype), pullback


def _kernel(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """k and k' of all pairs of rows, (N, N)."""
    squared = np.sum((a[:, None] - b[None]) ** 2, axis=-1)[..., None]
    scales = np.array([2 * a.shape[1] * s for s in SCALES], a.dtype)
    share = scales / (scales + squared)
    return share.sum(axis=-1), -(share**2 / scales).sum(axis=-1)


class MmdEngine(FastSequentialAutoencoder):
    """The network of jang2018 with this distance instead of the sliced Wasserstein distance."""

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """As `SequentialAutoencoder.loss_and_gradients`; the directions are not used."""
        z, encode_pullback = self.encode_with_pullback(x)
        x_hat, decode_pullback = self.decode_with_pullback(z, x.shape[1])
        reconstruction, error_pullback = ops.mean_squared_error(x_hat, x)
        discrepancy, prior_pullback = maximum_mean_discrepancy(z, prior)
        dz, of_decoder = decode_pullback(error_pullback())
        gradients = encode_pullback(dz + prior_pullback(weight)) | of_decoder
        total = float(reconstruction + weight * discrepancy)
        return Losses(total, float(reconstruction), float(discrepancy)), gradients
