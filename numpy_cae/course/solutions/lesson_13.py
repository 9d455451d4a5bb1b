"""The solutions of lesson 13, fast."""

import numpy as np

from numpy_cae.course.solutions.lesson_03 import unfold


def conv1d_unfolded(x, w, b):
    """The rows of `unfold` times the filters as one matrix."""
    taps, channels, filters = w.shape
    return unfold(x, taps) @ w.reshape(taps * channels, filters) + b


def conv1d_shifted(x, w, b):
    """A product for every tap."""
    frames, taps = x.shape[1], len(w)
    padded = np.pad(x, ((0, 0), (taps // 2, taps // 2), (0, 0)))
    return sum(padded[:, k : k + frames] @ w[k] for k in range(taps)) + b


def three_products(a, b, p, q, multiply):
    """Real and imaginary part of (a + i b)(p + i q), after Gauss."""
    m1 = multiply(a + b, p)
    m2 = multiply(a, q - p)
    m3 = multiply(b, p + q)
    return m1 - m3, m1 + m2


def one_frequency(frequency, taps, frames):
    """The rows of A and G and the columns of C of one frequency: three, or one if it is real."""
    points = frames + taps - 1
    angles = 2 * np.pi * frequency / points * np.arange(points)
    cos, sin = np.cos(angles), np.sin(angles)
    cos_k, sin_k = cos[:taps], sin[:taps]
    cos_t, sin_t = cos[:frames] / points, sin[:frames] / points
    if 2 * frequency in (0, points):
        return cos[None], cos_k[None], cos_t[:, None]
    a = np.array([cos - sin, cos, -sin])
    g = np.array([cos_k, sin_k - cos_k, cos_k + sin_k])
    c = np.array([2 * (cos_t - sin_t), -2 * sin_t, -2 * cos_t])
    return a, g, c.T


def block_matrices(taps, frames):
    """A, G and C: transforms of a block and of a filter, and the transform back."""
    points = frames + taps - 1
    every = [one_frequency(f, taps, frames) for f in range(points // 2 + 1)]
    a, g, c = zip(*every, strict=True)
    return np.concatenate(a), np.concatenate(g), np.concatenate(c, axis=1)


def conv1d_by_blocks(x, w, b, a, g, c):
    """The convolution by A, G and C, and its pullback."""
    (batch, frames, channels), (taps, _, filters) = x.shape, w.shape
    (products, points), length = a.shape, len(c)
    before, count = taps // 2, -(-frames // length)
    starts = range(0, count * length, length)

    def by_product(blocks):
        return blocks.transpose(1, 0, 2).reshape(products, count * batch, -1)

    def by_block(each_product):
        return each_product.reshape(products, count, -1).transpose(1, 0, 2)

    padded = np.zeros((count * length + taps - 1, batch, channels), dtype=x.dtype)
    padded[before : before + frames] = x.transpose(1, 0, 2)
    read = np.stack([padded[s : s + points].reshape(points, -1) for s in starts])
    u = by_product(a @ read)
    w_hat = np.tensordot(g, w, 1)
    v = u @ w_hat
    y = (c @ by_block(v)).reshape(count * length, batch, filters)

    def pullback(dy):
        dy_rows = np.zeros((count * length, batch, filters), dtype=dy.dtype)
        dy_rows[:frames] = dy.transpose(1, 0, 2)
        dv = by_product(c.T @ dy_rows.reshape(count, length, -1))
        dw = np.tensordot(g.T, u.transpose(0, 2, 1) @ dv, 1)
        du = dv @ w_hat.transpose(0, 2, 1)
        d_read = (a.T @ by_block(du)).reshape(count, points, batch, channels)
        d_padded = np.zeros(padded.shape, dtype=x.dtype)
        for s, part in zip(starts, d_read, strict=True):
            d_padded[s : s + points] += part
        dx = d_padded[before : before + frames].transpose(1, 0, 2)
        return dx, dw, dy.sum(axis=(0, 1))

    return y[:frames].transpose(1, 0, 2) + b, pullback
