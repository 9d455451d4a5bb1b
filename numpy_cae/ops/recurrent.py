"""The gated recurrent unit of jang2018's encoder and decoders, one step and a whole sequence.

Conventions differ in where the reset gate acts and whether z or 1 - z multiplies h. This is that of
PyTorch and cuDNN: r multiplies the product h · U_n, and z multiplies h. `gru` applies `gru_step` to
each frame, and its pullback applies the pullbacks from the last frame to the first:
backpropagation through time.
"""

import numpy as np

from numpy_cae.ops.activations import sigmoid
from numpy_cae.ops.dense import linear
from numpy_cae.ops.shapes import Pullback, require_shape


def gru_step(
    x: np.ndarray, h: np.ndarray, w: np.ndarray, u: np.ndarray, b: np.ndarray, c: np.ndarray
) -> tuple[np.ndarray, Pullback]:
    """One step of the recurrence, h -> h'. Gates in the order reset, update, new.

        a = x · W + b,   s = h · U + c        each in three parts: a_r, a_z, a_n and s_r, s_z, s_n
        r = σ(a_r + s_r)                      reset: how much of h enters n
        z = σ(a_z + s_z)                      update: how much of h is kept
        n = tanh(a_n + r ∘ s_n)               new
        h' = (1 - z) ∘ n + z ∘ h

    The last line is why a GRU remembers: where z is near 1, h passes unchanged, and so does its
    gradient. The state h reaches h' along four paths: directly (z ∘ h), and through each of s_r,
    s_z, s_n. With dh' short for dL/dh', from the last line to the first:

        dn   = dh' ∘ (1 - z)
        dz   = dh' ∘ (h - n)
        da_n = dn ∘ (1 - n²)
        ds_n = da_n ∘ r
        dr   = da_n ∘ s_n
        da_z = ds_z = dz ∘ z ∘ (1 - z)
        da_r = ds_r = dr ∘ r ∘ (1 - r)
        dx = da · Wᵀ,   dW = Σ_rows xᵀ · da,   db = Σ_rows da
        dh = dh' ∘ z + ds · Uᵀ,   dU = Σ_rows hᵀ · ds,   dc = Σ_rows ds

    Parameters
    ----------
    x : (B, C) array of float
        The input of this step.
    h : (B, H) array of float
        The state before it.
    w : (C, 3H) array of float
    u : (H, 3H) array of float
    b, c : (3H,) arrays of float

    Returns
    -------
    h_next : (B, H) array
    pullback : dh_next -> (dx, dh, dw, du, db, dc)

    Raises
    ------
    ValueError
        If a shape does not fit.

    See Also
    --------
    gru : All steps of a sequence.

    References
    ----------
    Cho et al., EMNLP 2014; the reset gate after the product as in cuDNN and PyTorch's `GRU`.

    Examples
    --------
    >>> x, h = np.zeros((1, 1)), np.ones((1, 1))
    >>> w, u, c = np.zeros((1, 3)), np.zeros((1, 3)), np.zeros(3)
    >>> b = np.array([0.0, 4.0, 0.0])  # a large bias opens the update gate: h is kept
    >>> h_next, pullback = gru_step(x, h, w, u, b, c)
    >>> h_next.round(3), pullback(np.ones((1, 1)))[1].round(3)
    (array([[0.982]]), array([[0.982]]))
    """
    require_shape("h", h, ("batch", "hidden"))
    batch, hidden = h.shape
    require_shape("x", x, (batch, "in"))
    _require_weights(x.shape[1], hidden, w, u, b, c)

    a, a_pullback = linear(x, w, b)
    s, s_pullback = linear(h, u, c)
    a_r, a_z, a_n = np.split(a, 3, axis=1)
    s_r, s_z, s_n = np.split(s, 3, axis=1)
    r, _ = sigmoid(a_r + s_r)
    z, _ = sigmoid(a_z + s_z)
    n = np.tanh(a_n + r * s_n)
    h_next = (1 - z) * n + z * h

    def pullback(dh_next: np.ndarray) -> tuple[np.ndarray, ...]:
        require_shape("dh_next", dh_next, h_next.shape)
        dn = dh_next * (1 - z)
        dz = dh_next * (h - n)
        da_n = dn * (1 - n * n)
        ds_n = da_n * r
        dr = da_n * s_n
        da_z = dz * z * (1 - z)
        da_r = dr * r * (1 - r)
        dx, dw, db = a_pullback(np.concatenate([da_r, da_z, da_n], axis=1))
        dh_through_s, du, dc = s_pullback(np.concatenate([da_r, da_z, ds_n], axis=1))
        dh = dh_next * z + dh_through_s
        return dx, dh, dw, du, db, dc

    return h_next, pullback


def gru(
    x: np.ndarray, h0: np.ndarray, w: np.ndarray, u: np.ndarray, b: np.ndarray, c: np.ndarray
) -> tuple[np.ndarray, Pullback]:
    """h_t = gru_step(x_t, h_(t-1)) for each frame in turn, starting from h_0.

    The weights are the same at every step, so their gradients are summed over the steps. A state
    acts on the loss along two paths, as the output of its frame and as the state of the next step,
    so its gradient g_t is the sum of both. From the last frame to the first, with d_T = 0:

        g_t = dy_t + d_t
        dx_t, d_(t-1), dW, dU, db, dc  from the pullback of step t at g_t

    d_(t-1) is the dh that the pullback of step t returns. That of the first step is dL/dh_0.

    Parameters
    ----------
    x : (B, T, C) array of float
    h0 : (B, H) array of float
    w : (C, 3H) array of float
    u : (H, 3H) array of float
    b, c : (3H,) arrays of float

    Returns
    -------
    y : (B, T, H) array
        The state after each frame.
    pullback : dy -> (dx, dh0, dw, du, db, dc)

    Raises
    ------
    ValueError
        If a shape does not fit.

    See Also
    --------
    gru_step : One step, with the equations of the gates.

    References
    ----------
    jang2018, "Sequential Auto-Encoders with Wasserstein Regularizer"; Werbos, "Backpropagation
    through time: what it does and how to do it", Proceedings of the IEEE 78, 1990.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> w, u = rng.normal(size=(3, 12)), rng.normal(size=(4, 12))
    >>> x, h0, b = rng.normal(size=(2, 50, 3)), np.zeros((2, 4)), np.zeros(12)
    >>> y, pullback = gru(x, h0, w, u, b, b)
    >>> dx, dh0, dw, du, db, dc = pullback(np.ones_like(y))
    >>> y.shape, dx.shape, dw.shape
    ((2, 50, 4), (2, 50, 3), (3, 12))
    """
    require_shape("x", x, ("batch", "frames", "in"))
    batch, frames, channels = x.shape
    require_shape("h0", h0, (batch, "hidden"))
    hidden = h0.shape[1]
    _require_weights(channels, hidden, w, u, b, c)

    y = np.empty((batch, frames, hidden), dtype=h0.dtype)
    pullbacks = []
    h = h0
    for t in range(frames):
        h, step_pullback = gru_step(x[:, t], h, w, u, b, c)
        y[:, t] = h
        pullbacks.append(step_pullback)

    def pullback(dy: np.ndarray) -> tuple[np.ndarray, ...]:
        require_shape("dy", dy, y.shape)
        dx = np.empty(x.shape, dtype=x.dtype)
        dw, du, db, dc = (np.zeros_like(weight) for weight in (w, u, b, c))
        dh = np.zeros_like(h0)
        for t in reversed(range(frames)):
            dx[:, t], dh, *weight_terms = pullbacks[t](dy[:, t] + dh)
            for total, term in zip((dw, du, db, dc), weight_terms, strict=True):
                total += term
        return dx, dh, dw, du, db, dc

    return y, pullback


def _require_weights(
    channels: int, hidden: int, w: np.ndarray, u: np.ndarray, b: np.ndarray, c: np.ndarray
) -> None:
    require_shape("w", w, (channels, 3 * hidden))
    require_shape("u", u, (hidden, 3 * hidden))
    require_shape("b", b, (3 * hidden,))
    require_shape("c", c, (3 * hidden,))
