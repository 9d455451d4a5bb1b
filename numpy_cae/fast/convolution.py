"""`conv1d` with a quarter of the arithmetic: blocks of frames are convolved by their spectra."""

import numpy as np

from numpy_cae.fast.blocks import Blocks, block_length, blocks, overlap_add, overlapping
from numpy_cae.ops.shapes import Pullback, require_shape

MAX_BLOCK_FRAMES = 40
"""Longer blocks save products and cost more in A and C; with 15 taps and 64 channels the optimum
lies between 30 and 50 frames."""


def conv1d(x: np.ndarray, w: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """y[t] = Σ_k x[t + k - K//2] · w[k] + b, as `ops.conv1d`, by y = C ((A x) ∘ (G w)) + b.

    A, G and C are the constant matrices of `numpy_cae.fast.blocks`, where they are derived. For
    every block j of L frames, in the order of the code:

        u[s, j] = Σ_n A[s, n] · x[j L + n]      the N = L + K - 1 frames that block j reads
        ŵ[s]    = Σ_k G[s, k] · w[k]
        v[s, j] = u[s, j] · ŵ[s]                ∘, a matrix product over the channels
        y[j L + t] = Σ_s C[t, s] · v[s, j]

    All four are linear, so the pullback is their transposes in reverse order:

        dv[s, j] = Σ_t C[t, s] · dy[j L + t]
        dŵ[s]    = Σ_j u[s, j]ᵀ · dv[s, j]      dw[k] = Σ_s G[s, k] · dŵ[s]
        du[s, j] = dv[s, j] · ŵ[s]ᵀ             dx[j L + n] += Σ_s A[s, n] · du[s, j]

    where the last line adds up the contributions of overlapping blocks to a frame that they share.
    With time as the leading axis, each of these lines is a plain matrix product.

    Arguments, results and errors are those of `ops.conv1d`.

    References
    ----------
    holden2015, section 5, equation 1. S. Winograd, "Arithmetic Complexity of Computations",
    SIAM 1980: every bilinear algorithm has this form, and no correlation of L frames and K taps
    needs fewer than L + K - 1 products (this form has half more, and loses no digits in float32).

    Examples
    --------
    >>> from numpy_cae import ops
    >>> rng = np.random.default_rng(0)
    >>> arguments = rng.normal(size=(2, 90, 3)), rng.normal(size=(15, 3, 4)), np.zeros(4)
    >>> np.allclose(conv1d(*arguments)[0], ops.conv1d(*arguments)[0])
    True
    """
    require_shape("w", w, ("taps", "in", "out"))
    taps, channels, filters = w.shape
    require_shape("x", x, ("batch", "frames", channels))
    require_shape("b", b, (filters,))
    if taps % 2 == 0:
        raise ValueError(f"w has shape {w.shape}: the number of taps must be odd, got {taps}")

    batch, frames = x.shape[:2]
    dtype = np.result_type(x, w, b)
    length, count = block_length(frames, MAX_BLOCK_FRAMES)
    matrices = blocks(taps, length, dtype.name)
    products = matrices.products

    w_hat = (matrices.g @ w.reshape(taps, -1)).reshape(products, channels, filters)
    padded = _time_first(x, taps // 2, matrices, count, dtype)
    u = _analyse(matrices.a, overlapping(padded, matrices, count)).reshape(products, -1, channels)
    y = _synthesise(matrices.c, (u @ w_hat).reshape(products, count, -1))
    y = _batch_first(y.reshape(-1, batch * filters), batch, frames) + b

    def pullback(dy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        require_shape("dy", dy, y.shape)
        dy_blocks = _time_first(dy, 0, matrices, count, dtype)[: count * length]
        dv = _analyse(matrices.c.T, dy_blocks.reshape(count, length, -1))
        dv = dv.reshape(products, -1, filters)
        dw_hat = u.transpose(0, 2, 1) @ dv
        dw = (matrices.g.T @ dw_hat.reshape(products, -1)).reshape(w.shape)
        du = dv @ w_hat.transpose(0, 2, 1)
        dx = np.empty_like(padded)
        overlap_add(_synthesise(matrices.a.T, du.reshape(products, count, -1)), matrices, dx)
        return _batch_first(dx[taps // 2 :], batch, frames), dw, dy.sum(axis=(0, 1))

    return y, pullback


def _time_first(
    x: np.ndarray, before: int, matrices: Blocks, count: int, dtype: np.dtype
) -> np.ndarray:
    """(B, T, C) as (count · L + K - 1, B · C): zeros `before` the first and after the last."""
    batch, frames, channels = x.shape
    rows = (count - 1) * matrices.frames + matrices.points
    padded = np.zeros((rows, batch, channels), dtype=dtype)
    padded[before : before + frames] = x.transpose(1, 0, 2)
    return padded.reshape(rows, batch * channels)


def _batch_first(rows: np.ndarray, batch: int, frames: int) -> np.ndarray:
    """The first T rows of (…, B · C) as (B, T, C)."""
    return np.ascontiguousarray(rows[:frames].reshape(frames, batch, -1).transpose(1, 0, 2))


def _analyse(matrix: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """(S, n) by (count, n, width): the transform of every block, (S, count, width)."""
    return np.matmul(matrix, frames).transpose(1, 0, 2).copy()


def _synthesise(matrix: np.ndarray, products: np.ndarray) -> np.ndarray:
    """(n, S) by (S, count, width): the inverse for every block, (count, n, width)."""
    return np.matmul(matrix, products.transpose(1, 0, 2))
