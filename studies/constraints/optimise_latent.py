"""Minimise a loss of the decoded motion over the latent code.

    min_Y   L(Φ†(Y)) + β mean((Y - Y_0)²),   Y within the bound of arctanh

L is a loss of the motion's features with its gradient (`studies.constraints.constraints`); the
gradient with respect to Y is computed by the pullback of the decoder. The decoder accepts any Y;
the second term keeps Y near the codes of real motion. The method is L-BFGS-B (`scipy.optimize`).
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from numpy_cae.manifold.motion_manifold import MotionManifold

Objective = Callable[[np.ndarray], tuple[float, np.ndarray]]
"""From features (F, 63) to a loss and its gradient for them."""


def optimise_latent(
    manifold: MotionManifold,
    start: np.ndarray,
    frames: int,
    objective: Objective,
    beta: float,
    steps: int,
) -> np.ndarray:
    """The hidden units of a motion with a small loss.

    Parameters
    ----------
    manifold : MotionManifold
    start : (units, 256) array of float
        Y_0, as `manifold.encode` returns it for a clip of `frames` frames.
    frames : int
    objective : Objective
    beta : float
        β.
    steps : int
        Largest number of iterations.

    Returns
    -------
    (units, 256) array of float
    """
    network = manifold.network
    clip = slice(manifold.receptive_radius, manifold.receptive_radius + frames)
    bound = network.layers[-1].bound
    start = np.clip(start, -bound, bound)

    def total(flat: np.ndarray) -> tuple[float, np.ndarray]:
        y = flat.reshape(start.shape)
        x_hat, pullback = network.decode_with_pullback(y[None].astype(start.dtype))
        loss, d_features = objective(manifold.denormalise(x_hat[0])[clip])
        dx_hat = np.zeros_like(x_hat)
        dx_hat[0, clip] = d_features / manifold.scale
        difference = y - start
        dy = pullback(dx_hat)[0] + 2 * beta / difference.size * difference
        loss += beta * np.mean(difference**2)
        return loss, dy.ravel().astype(np.float64)

    result = minimize(
        total,
        start.ravel().astype(np.float64),
        jac=True,
        method="L-BFGS-B",
        bounds=[(-bound, bound)] * start.size,
        options={"maxiter": steps, "maxfun": 2 * steps},
    )
    return result.x.reshape(start.shape).astype(start.dtype)
