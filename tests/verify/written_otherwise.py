"""Right implementations that look nothing like ours: einsum, FFT, other formulas.

None of them may raise an alarm. Each is (operation, function).
"""

import numpy as np
from scipy.special import expit, log1p

RIGHT = []


def right(operation):
    def admit(function):
        RIGHT.append((operation, function))
        return function

    return admit


def windows_of(x, taps):
    padded = np.pad(x, ((0, 0), (taps // 2, taps // 2), (0, 0)))
    return np.lib.stride_tricks.sliding_window_view(padded, taps, axis=1)


@right("conv1d")
def conv1d_by_einsum(x, w, b):
    windows = windows_of(x, len(w))

    def pullback(dy):
        dx = np.einsum("btdk,kcd->btc", windows_of(dy, len(w)), w[::-1], optimize=True)
        return dx, np.einsum("btck,btd->kcd", windows, dy), np.einsum("btd->d", dy)

    return np.einsum("btck,kcd->btd", windows, w) + b, pullback


@right("conv1d")
def conv1d_by_fft(x, w, b):
    frames = x.shape[1]
    taps = len(w)
    size = frames + 2 * taps

    def transformed(a, axis):
        return np.fft.rfft(a, size, axis=axis)

    def shifted_back(product, axis, first, count):
        padded = np.fft.irfft(product, size, axis=axis)
        return np.take(padded, range(first, first + count), axis=axis, mode="wrap")

    xf = transformed(x, 1)
    wf = transformed(w, 0)
    y = shifted_back(np.einsum("bfc,fcd->bfd", xf, wf.conj()), 1, -(taps // 2), frames)
    y = (y + b).astype(x.dtype)

    def pullback(dy):
        dyf = transformed(dy, 1)
        dx = shifted_back(np.einsum("bfd,fcd->bfc", dyf, wf), 1, taps // 2, frames)
        # As dy moves with x: k taps later at a tap k, from -K//2 to K//2.
        dw = shifted_back(np.einsum("bfc,bfd->fcd", xf, dyf.conj()), 0, -(taps // 2), taps)
        if taps // 2 >= frames:  # beyond the window there is nothing to meet
            far = np.abs(np.arange(taps) - taps // 2) >= frames
            dw[far] = 0
        return dx.astype(x.dtype), dw.astype(x.dtype), dy.sum(axis=1).sum(axis=0)

    return y, pullback


@right("transpose_filters")
def transpose_by_einsum(w):
    return np.einsum("kcd->kdc", np.flip(w, 0)), lambda d: np.einsum("kdc->kcd", np.flip(d, 0))


@right("max_pool")
def pool_by_argmax(x):
    batch, frames, channels = x.shape
    paired = x.reshape(batch, frames // 2, 2, channels)
    winner = np.expand_dims(paired.argmax(axis=2), 2)

    def pullback(dy):
        dx = np.zeros_like(paired)
        np.put_along_axis(dx, winner, np.expand_dims(dy, 2), axis=2)
        return dx.reshape(x.shape)

    return np.take_along_axis(paired, winner, axis=2)[:, :, 0], pullback


@right("unpool_even")
def even_by_matrix(y):
    spread = np.kron(np.eye(y.shape[1]), [[0.5], [0.5]]).astype(y.dtype)
    return np.einsum("st,btc->bsc", spread, y), lambda dx: np.einsum("st,bsc->btc", spread, dx)


@right("unpool_random")
def random_by_where(y, first):
    def pullback(dx):
        paired = dx.reshape(y.shape[0], y.shape[1], 2, y.shape[2])
        return np.where(first, paired[:, :, 0], paired[:, :, 1])

    paired = np.stack([np.where(first, y, 0), np.where(first, 0, y)], axis=2)
    return paired.reshape(y.shape[0], -1, y.shape[2]), pullback


@right("tanh")
def tanh_by_sigmoid(x):
    y = 2 * expit(2 * x) - 1
    return y, lambda dy: dy * 4 * expit(2 * x) * expit(-2 * x)


@right("sigmoid")
def sigmoid_by_tanh(x):
    y = (1 + np.tanh(x / 2)) / 2
    return y, lambda dy: dy * (1 - np.tanh(x / 2) ** 2) / 4


@right("arctanh")
def arctanh_by_logarithm(y, bound):
    clipped = np.minimum(np.maximum(y, -bound), bound)
    x = (log1p(clipped) - log1p(-clipped)) / 2

    def pullback(dx):
        return np.where((y < -bound) | (y > bound), 0, dx / ((1 - clipped) * (1 + clipped)))

    return x, pullback


@right("linear")
def linear_by_einsum(x, w, b):
    def pullback(dy):
        dw = np.tensordot(x, dy, axes=(range(x.ndim - 1), range(x.ndim - 1)))
        return np.einsum("...d,cd->...c", dy, w), dw, dy.sum(axis=tuple(range(x.ndim - 1)))

    return np.einsum("...c,cd->...d", x, w) + b, pullback


def gates(x, h, w, u, b, c):
    w_r, w_z, w_n = np.split(w, 3, axis=1)
    u_r, u_z, u_n = np.split(u, 3, axis=1)
    b_r, b_z, b_n = np.split(b, 3)
    c_r, c_z, c_n = np.split(c, 3)
    r = expit(x @ w_r + b_r + h @ u_r + c_r)
    z = expit(x @ w_z + b_z + h @ u_z + c_z)
    inner = h @ u_n + c_n
    return r, z, np.tanh(x @ w_n + b_n + r * inner), inner


@right("gru")
def gru_all_weights_at_once(x, h0, w, u, b, c):
    """Keeps the gates' gradients of all frames and multiplies them with the inputs at the end."""
    hidden = h0.shape[1]
    before = [h0]
    gates_of_frames = []
    for t in range(x.shape[1]):
        r, z, n, inner = gates(x[:, t], before[-1], w, u, b, c)
        gates_of_frames.append((r, z, n, inner))
        before.append((1 - z) * n + z * before[-1])

    def pullback(dy):
        to_x = np.zeros((*x.shape[:2], 3 * hidden), x.dtype)
        to_h = np.zeros_like(to_x)
        g = np.zeros_like(h0)
        for t in range(x.shape[1] - 1, -1, -1):
            r, z, n, inner = gates_of_frames[t]
            g = g + dy[:, t]
            new = g * (1 - z) * (1 - n**2)
            update = g * (before[t] - n) * z * (1 - z)
            reset = new * inner * r * (1 - r)
            to_x[:, t] = np.hstack([reset, update, new])
            to_h[:, t] = np.hstack([reset, update, new * r])
            g = g * z + to_h[:, t] @ u.T
        states = np.stack(before[:-1], axis=1)
        dw = np.einsum("btc,btg->cg", x, to_x)
        du = np.einsum("bth,btg->hg", states, to_h)
        return to_x @ w.T, g, dw, du, to_x.sum((0, 1)), to_h.sum((0, 1))

    return np.stack(before[1:], axis=1), pullback


@right("gru_step")
def step_as_a_sequence_of_one_frame(x, h, w, u, b, c):
    y, of_sequence = gru_all_weights_at_once(x[:, None], h, w, u, b, c)

    def pullback(g):
        dx, *of_weights = of_sequence(g[:, None])
        return dx[:, 0], *of_weights

    return y[:, 0], pullback


@right("mean_squared_error")
def squared_as_python_number(x_hat, x):
    loss = sum(float(g) ** 2 for g in (x_hat - x).flat) / x.size
    return loss, lambda dloss=1.0: ((x_hat - x) / x.size * float(2 * dloss)).astype(x.dtype)


@right("mean_absolute")
def absolute_by_comparison(y):
    positive = (y > 0).astype(y.dtype)
    negative = (y < 0).astype(y.dtype)
    loss = np.mean(y * (positive - negative))
    return loss, lambda dloss=1.0: (positive - negative) * y.dtype.type(dloss / y.size)


@right("tied_layer")
def tied_by_einsum(x, w, b):
    a, of_a = conv1d_by_einsum(x, w, b)
    y = np.tanh(a)
    flipped = np.einsum("kcd->kdc", w[::-1])
    x_hat, of_x_hat = conv1d_by_einsum(y - b, flipped, 0 * x[0, 0])

    def pullback(g):
        dy, dflipped, _ = of_x_hat(g)
        dx, dw, db = of_a(dy * (1 - y * y))
        return dx, dw + np.einsum("kdc->kcd", dflipped)[::-1], db - np.einsum("btd->d", dy)

    return x_hat, pullback


@right("sliced_wasserstein")
def sliced_by_ranks(z, prior, directions):
    """Each point's gap from the prior's point of the same rank; nothing of z is ever sorted."""
    p = z @ directions.T
    ranks = p.argsort(axis=0, kind="stable").argsort(axis=0, kind="stable")
    gap = p - np.take_along_axis(np.sort(prior @ directions.T, axis=0), ranks, axis=0)
    return (gap**2).mean(), lambda dloss=1.0: gap @ directions * z.dtype.type(2 * dloss / gap.size)
