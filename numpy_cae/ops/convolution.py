"""Convolution over time, used by both the encoder and the decoder of holden2015.

`conv1d` is the * of equation 1; `transpose_filters` makes the W̃ of equation 2. Convolving with W̃
is exactly the adjoint of convolving with W, so the convolution of a decoding layer is the transpose
of that of the encoding layer, and the gradient of `conv1d` for its input is again a convolution.
"""

from collections.abc import Callable

import numpy as np

from numpy_cae.ops.shapes import Pullback, require_shape


def conv1d(x: np.ndarray, w: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """y[t] = Σ_k x[t + k - K//2] · w[k] + b, with zeros beyond both ends of x.

    As usual in deep learning, w is not flipped (a cross-correlation in signal processing).

    Tap k takes frame t + k - K//2 to frame t, so the gradient takes the way back: from frame t to
    frame t + k - K//2. That is a convolution too, with the taps in reverse order and with filters
    and channels exchanged. With dy short for dL/dy, the derivatives are

        dL/dx[t] = Σ_k dy[t + k - K//2] · w̃[k]        the same convolution, with W̃
        dL/dw[k] = Σ_windows Σ_t x[t + k - K//2]ᵀ · dy[t]
        dL/db    = Σ_windows Σ_t dy[t]

    Parameters
    ----------
    x : (B, T, C) array of float
        B windows of T frames of C channels.
    w : (K, C, D) array of float
        D filters of K taps over C channels; K is odd, so that a filter has a centre.
    b : (D,) array of float
        A bias for each filter.

    Returns
    -------
    y : (B, T, D) array
        The same number of frames as x ("same" padding).
    pullback : dy -> (dx, dw, db)

    Raises
    ------
    ValueError
        If a shape does not fit or K is even.

    See Also
    --------
    transpose_filters : The filters with which a convolution is decoded.

    References
    ----------
    holden2015, section 5, equation 1 (X * W_k + b_k).

    Examples
    --------
    >>> x = np.array([0.0, 1.0, 0.0, 0.0]).reshape(1, 4, 1)
    >>> w = np.array([1.0, 2.0, 3.0]).reshape(3, 1, 1)
    >>> y, pullback = conv1d(x, w, np.zeros(1))
    >>> y.ravel()  # an impulse shows the taps in reverse order
    array([3., 2., 1., 0.])
    >>> dx, dw, db = pullback(x)  # the gradient of the second frame reaches its three inputs
    >>> dx.ravel()
    array([1., 2., 3., 0.])
    """
    require_shape("w", w, ("taps", "in", "out"))
    taps, channels, filters = w.shape
    require_shape("x", x, ("batch", "frames", channels))
    require_shape("b", b, (filters,))
    if taps % 2 == 0:
        raise ValueError(f"w has shape {w.shape}: the number of taps must be odd, got {taps}")

    margin = taps // 2
    padded = np.pad(x, ((0, 0), (margin, margin), (0, 0)))
    x_rows = unfold(padded, taps)
    y = (x_rows @ w.reshape(-1, filters)).reshape(*x.shape[:2], filters) + b

    def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        require_shape("dy", dy, y.shape)
        w_tilde, _ = transpose_filters(w)
        dy_padded = np.pad(dy, ((0, 0), (margin, margin), (0, 0)))
        dx = (unfold(dy_padded, taps) @ w_tilde.reshape(-1, channels)).reshape(x.shape)
        dy_rows = dy.reshape(-1, filters)
        dw = (x_rows.T @ dy_rows).reshape(w.shape)
        db = dy_rows.sum(axis=0)
        return dx, dw, db

    return y, pullback


def unfold(padded: np.ndarray, taps: int) -> np.ndarray:
    """The frames that each frame of a convolution reads, side by side, for one matrix product.

    padded : (B, T + K - 1, C); returns (B·T, K·C), in row t of a window its frames t to t + K - 1.
    """
    frames = padded.shape[1] - taps + 1
    shifted = [padded[:, k : k + frames] for k in range(taps)]
    return np.concatenate(shifted, axis=-1).reshape(-1, taps * padded.shape[2])


def transpose_filters(w: np.ndarray) -> tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]:
    """W̃[k] = W[K - 1 - k]ᵀ: flipped in time, with filters and channels exchanged.

    Convolving with W̃ is the transpose of convolving with W, which is why a decoder with W̃ needs no
    filters of its own. The flip and the exchange are their own inverses, so the pullback is the
    same map.

    Parameters
    ----------
    w : (K, C, D) array of float

    Returns
    -------
    w_tilde : (K, D, C) array
    pullback : dw_tilde (K, D, C) -> dw (K, C, D)

    Raises
    ------
    ValueError
        If w does not have three axes.

    See Also
    --------
    conv1d : The convolution that encodes with w and decodes with W̃.

    References
    ----------
    holden2015, section 5, the W̃ of equation 2.

    Examples
    --------
    >>> w = np.arange(6.0).reshape(3, 2, 1)
    >>> w_tilde, _ = transpose_filters(w)
    >>> w_tilde.shape, w_tilde[0].ravel()
    ((3, 1, 2), array([4., 5.]))
    """
    require_shape("w", w, ("taps", "in", "out"))
    w_tilde = w[::-1].transpose(0, 2, 1)

    def pullback(dw_tilde: np.ndarray) -> np.ndarray:
        require_shape("dw_tilde", dw_tilde, w_tilde.shape)
        return dw_tilde[::-1].transpose(0, 2, 1)

    return w_tilde, pullback
