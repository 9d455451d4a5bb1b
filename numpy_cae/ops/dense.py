"""The affine map along the last axis, used inside a GRU and for its input and output."""

import numpy as np

from numpy_cae.ops.shapes import Pullback, require_shape


def linear(x: np.ndarray, w: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """y = x · W + b along the last axis.

    Every row uses the same W and b, so their gradients are sums over the rows. With dy short for
    dL/dy, and all axes but the last taken as rows,

        dL/dx = dy · Wᵀ
        dL/dW = Σ_rows xᵀ · dy
        dL/db = Σ_rows dy

    Parameters
    ----------
    x : (…, C) array of float
    w : (C, D) array of float
    b : (D,) array of float

    Returns
    -------
    y : (…, D) array
    pullback : dy -> (dx, dw, db)

    Raises
    ------
    ValueError
        If a shape does not fit.

    Examples
    --------
    >>> y, pullback = linear(np.array([[1.0, 2.0]]), np.array([[3.0], [4.0]]), np.array([0.5]))
    >>> y
    array([[11.5]])
    >>> dx, dw, db = pullback(np.array([[1.0]]))
    >>> dx, dw.ravel()  # W is the gradient for x, x is that for W
    (array([[3., 4.]]), array([1., 2.]))
    """
    require_shape("w", w, ("in", "out"))
    channels, features = w.shape
    require_shape("x", x, (*np.shape(x)[:-1], channels))
    require_shape("b", b, (features,))
    y = x @ w + b

    def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        require_shape("dy", dy, y.shape)
        dy_rows = dy.reshape(-1, features)
        dx = dy @ w.T
        dw = x.reshape(-1, channels).T @ dy_rows
        db = dy_rows.sum(axis=0)
        return dx, dw, db

    return y, pullback
