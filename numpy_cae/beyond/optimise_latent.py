"""Along the manifold downhill: the hidden units whose motion suits a wish, near given ones.

    min_Y   L(Φ†(Y)) + β mean((Y - Y_0)²),   Y within the bound of arctanh

L is a loss of the motion's features with a pullback (`numpy_cae.beyond.constraints`); its
gradient comes down to Y through the decoder. The second term keeps Y where motions are: a decoder
makes something of every Y. Steps are those of L-BFGS (`scipy.optimize`), which learns the
curvature from the gradients as it goes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from numpy_cae.manifold.motion_manifold import MotionManifold

Wish = Callable[[np.ndarray], tuple[float, np.ndarray]]
"""From features (F, 63) to a loss and its gradient for them."""


def descend_to(
    manifold: MotionManifold, start: np.ndarray, frames: int, wish: Wish, near: float, steps: int
) -> np.ndarray:
    """The hidden units of a motion that suits the wish.

    Parameters
    ----------
    manifold : MotionManifold
    start : (units, 256) array of float
        Y_0, as `manifold.encode` gives it for a clip of so many frames.
    frames : int
    wish : function, features (frames, 63) -> (loss, gradient)
    near : float
        β.
    steps : int
        At most so many.

    Returns
    -------
    (units, 256) array of float
    """
    network = manifold.network
    own = slice(manifold.reach, manifold.reach + frames)
    bound = network.layers[-1].bound
    start = np.clip(start, -bound, bound)

    def of_units(flat: np.ndarray) -> tuple[float, np.ndarray]:
        y = flat.reshape(start.shape)
        x_hat, decode_pullback = network.decode_with_pullback(y[None].astype(start.dtype))
        loss, d_features = wish(manifold.denormalise(x_hat[0])[own])
        dx_hat = np.zeros_like(x_hat)
        dx_hat[0, own] = d_features / manifold.scale
        dy = decode_pullback(dx_hat)
        away = y - start
        loss += near * np.mean(away**2)
        return loss, (dy[0] + 2 * near / away.size * away).ravel().astype(np.float64)

    found = minimize(
        of_units,
        start.ravel().astype(np.float64),
        jac=True,
        method="L-BFGS-B",
        bounds=[(-bound, bound)] * start.size,
        options={"maxiter": steps, "maxfun": 2 * steps},
    )
    return found.x.reshape(start.shape).astype(start.dtype)
