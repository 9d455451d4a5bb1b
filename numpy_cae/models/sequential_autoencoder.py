"""The sequential autoencoder of jang2018: one GRU reads a clip into z, another writes it from z.

What it computes is written down in `models.composed_sequence`, out of `numpy_cae.ops`. How it
computes it is `models.fast_sequence`: the same numbers, up to rounding, in a fraction of the time.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.fast.sequence_network import FastSequence
from numpy_cae.models.composed_sequence import Losses
from numpy_cae.models.sequence_weights import Weights, initial_weights
from numpy_cae.ops.shapes import require_shape

FRAMES = 50
"""Frames of a clip in the paper."""


class SequentialAutoencoder:
    """Clips of any length to a latent vector z each, and back; z is standard normal.

    Parameters
    ----------
    features : int
        Numbers of a frame, 54 in the paper.
    hidden : int
        Units of each GRU. The paper does not say; MBR17, whose decoder it takes, has 1024.
    latent : int
        Numbers of z. The paper does not say.
    rng : numpy.random.Generator, optional
        For the first weights; seeded with 0 where none is given.
    dtype : float32 (for training) or float64 (for checking gradients)

    Attributes
    ----------
    weights : dict of name to array
        See `models.sequence_weights`; changed in place by training.
    """

    def __init__(
        self,
        features: int = 54,
        hidden: int = 512,
        latent: int = 32,
        rng: np.random.Generator | None = None,
        dtype: np.dtype | type = np.float32,
    ):
        rng = rng or np.random.default_rng(0)
        self.features, self.hidden, self.latent = features, hidden, latent
        self.weights: Weights = initial_weights(features, hidden, latent, rng, dtype)
        self._fast = FastSequence()

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Clips (B, T, features), normalised, in the order of time, to z (B, latent).

        Raises
        ------
        ValueError
            If the features do not fit or there is no frame.
        """
        self._require_clips("x", x)
        return self._fast.encode(self.weights, x)

    def decode(self, z: np.ndarray, frames: int = FRAMES) -> np.ndarray:
        """z (B, latent) to clips (B, frames, features) in the order of time.

        Raises
        ------
        ValueError
            If z does not fit or `frames` is below 1.
        """
        require_shape("z", z, ("batch", self.latent))
        if frames < 1:
            raise ValueError(f"frames is {frames}, expected at least 1")
        return self._fast.decode(self.weights, z, frames)

    def denoise(self, x: np.ndarray) -> np.ndarray:
        """The clip on the manifold that stands for x: (B, T, features) to the same."""
        return self.decode(self.encode(x), x.shape[1])

    def sample(self, n: int, rng: np.random.Generator, frames: int = FRAMES) -> np.ndarray:
        """Clips (n, frames, features) of n draws from the prior, the standard normal."""
        z = rng.standard_normal((n, self.latent)).astype(self.weights["state_w"].dtype)
        return self.decode(z, frames)

    def interpolate(self, x0: np.ndarray, x1: np.ndarray, shares: np.ndarray) -> np.ndarray:
        """Clips on the way from x0 to x1, by z = (1 - share) · z_0 + share · z_1.

        Parameters
        ----------
        x0, x1 : (B, T, features) arrays of float
        shares : (S,) array of float
            0 is x0 as the network has it, 1 is x1.

        Returns
        -------
        (B, S, T, features) array
        """
        require_shape("x1", x1, x0.shape)
        z0, z1 = self.encode(x0)[:, None], self.encode(x1)[:, None]
        share = np.asarray(shares, z0.dtype)[:, None]
        z = (1 - share) * z0 + share * z1
        clips = self.decode(z.reshape(-1, self.latent), x0.shape[1])
        return clips.reshape(*z.shape[:2], *x0.shape[1:])

    def analogy(self, xa: np.ndarray, xb: np.ndarray, xc: np.ndarray) -> np.ndarray:
        """What is to c as a is to b: clips (B, T, features) of z_a - z_b + z_c."""
        require_shape("xb", xb, xa.shape)
        require_shape("xc", xc, xa.shape)
        return self.decode(self.encode(xa) - self.encode(xb) + self.encode(xc), xa.shape[1])

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """mean((x̂ - x)²) + λ · sliced_wasserstein(z, prior, directions), and its derivatives.

        Parameters
        ----------
        x : (B, T, features) array of float
        prior : (B, latent) array of float
            Draws of the prior.
        directions : (L, latent) array of float, rows of length 1
        weight : float
            λ.

        Returns
        -------
        losses : Losses
            `total`, `reconstruction` and `discrepancy`.
        gradients : dict of name to array
            In the order of `weights`.

        Raises
        ------
        ValueError
            If a shape does not fit or there is no clip.

        References
        ----------
        jang2018, "Sequential Auto-Encoders with Wasserstein Regularizer".
        """
        self._require_clips("x", x)
        if len(x) == 0:
            raise ValueError(f"x has shape {x.shape}: there is nothing to compare")
        require_shape("prior", prior, (len(x), self.latent))
        return self._fast.loss_and_gradients(self.weights, x, prior, directions, weight)

    def _require_clips(self, name: str, x: np.ndarray) -> None:
        require_shape(name, x, ("batch", "frames", self.features))
        if x.shape[1] == 0:
            raise ValueError(f"{name} has shape {x.shape}: a clip has at least one frame")
