"""Wrong convolutions over time. The right one is `numpy_cae.ops.convolution.conv1d`."""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.zoo.bug import bug


def padded(x, before, after, mode="constant"):
    return np.pad(x, ((0, 0), (before, after), (0, 0)), mode=mode)


def correlate(x, w, before=None, mode="constant"):
    """y[t] = Σ_k x[t + k - before] · w[k], `before` frames of padding in front."""
    taps = len(w)
    before = taps // 2 if before is None else before
    x_padded = padded(x, before, max(taps - 1 - before, 0), mode)
    return sum(x_padded[:, k : k + x.shape[1]] @ w[k] for k in range(taps))


def w_tilde(w):
    return w[::-1].transpose(0, 2, 1)


def for_filters(x, dy, taps):
    """dw[k] = Σ_windows Σ_t x[t + k - K//2]ᵀ · dy[t]"""
    x_padded, frames = padded(x, taps // 2, taps // 2), x.shape[1]
    return np.stack(
        [np.einsum("btc,btd->cd", x_padded[:, k : k + frames], dy) for k in range(taps)]
    )


@bug("conv1d", caught_by="gradient for x")
def conv_without_flip(x, w, b):
    """In the gradient for x the filters are not flipped in time."""
    y = correlate(x, w) + b

    def pullback(dy):
        dx = correlate(dy, w.transpose(0, 2, 1))
        return dx, for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for x")
def conv_without_exchange(x, w, b):
    """In the gradient for x the filters are flipped, but in and out channels not exchanged."""
    y = correlate(x, w) + b

    def pullback(dy):
        return correlate(dy, w[::-1]), for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for x")
def conv_gradient_shifted(x, w, b):
    """The gradient for x is padded by one frame too many in front: off by one."""
    y = correlate(x, w) + b

    def pullback(dy):
        dx = correlate(padded(dy, 1, 0)[:, :-1], w_tilde(w))
        return dx, for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for x")
def conv_middle_tap_only(x, w, b):
    """The gradient for x comes through the middle tap only: the sum over taps is missing."""
    y = correlate(x, w) + b

    def pullback(dy):
        dx = dy @ w[len(w) // 2].T
        return dx, for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for x")
def conv_edges_forgotten(x, w, b):
    """The gradient for x is set to 0 in the frames that the padding reaches."""
    y, beyond = correlate(x, w) + b, len(w) // 2

    def pullback(dy):
        dx = correlate(dy, w_tilde(w))
        dx[:, :beyond] = 0
        dx[:, x.shape[1] - beyond :] = 0
        return dx, for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for b")
def conv_bias_not_over_windows(x, w, b):
    """The bias's gradient is summed over frames but not over windows: only the last one counts."""
    y = correlate(x, w) + b

    def pullback(dy):
        for window in dy:
            db = window.sum(axis=0)
        return correlate(dy, w_tilde(w)), for_filters(x, dy, len(w)), db

    return y, pullback


@bug("conv1d", caught_by="gradient for b")
def conv_bias_not_over_frames(x, w, b):
    """The bias's gradient is summed over windows but not over frames."""
    y = correlate(x, w) + b

    def pullback(dy):
        return correlate(dy, w_tilde(w)), for_filters(x, dy, len(w)), dy.sum(axis=0)

    return y, pullback


@bug("conv1d", caught_by="gradient for b")
def conv_bias_averaged(x, w, b):
    """The bias's gradient is a mean over the windows where it should be a sum."""
    y = correlate(x, w) + b

    def pullback(dy):
        db = dy.sum(axis=1).mean(axis=0)
        return correlate(dy, w_tilde(w)), for_filters(x, dy, len(w)), db

    return y, pullback


@bug("conv1d", caught_by="gradient for w")
def conv_filters_of_last_window(x, w, b):
    """The filters' gradient is overwritten window by window: the sum over the batch is missing."""
    y = correlate(x, w) + b

    def pullback(dy):
        for i in range(len(x)):
            dw = for_filters(x[i : i + 1], dy[i : i + 1], len(w))
        return correlate(dy, w_tilde(w)), dw, dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for w")
def conv_filters_reversed(x, w, b):
    """The taps of the filters' gradient are in reverse."""
    y = correlate(x, w) + b

    def pullback(dy):
        dw = for_filters(x, dy, len(w))[::-1]
        return correlate(dy, w_tilde(w)), dw, dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for w")
def conv_filters_averaged(x, w, b):
    """The filters' gradient is a mean over the windows where it should be a sum."""
    y = correlate(x, w) + b

    def pullback(dy):
        dw = for_filters(x, dy, len(w)) / len(x)
        return correlate(dy, w_tilde(w)), dw, dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="gradient for w")
def conv_filters_without_edges(x, w, b):
    """The filters' gradient leaves out the frames at the edges, where the padding begins."""
    y, beyond = correlate(x, w) + b, len(w) // 2

    def pullback(dy):
        inner = np.zeros_like(dy)
        inner[:, beyond : dy.shape[1] - beyond] = dy[:, beyond : dy.shape[1] - beyond]
        dw = for_filters(x, inner, len(w))
        return correlate(dy, w_tilde(w)), dw, dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="value")
def conv_truly_convolves(x, w, b):
    """The filters are flipped in the forward pass too: a convolution, not equation 1's sum."""
    y = correlate(x, w[::-1]) + b

    def pullback(dy):
        dx = correlate(dy, w.transpose(0, 2, 1))
        return dx, for_filters(x, dy, len(w))[::-1], dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="value")
def conv_wraps_around(x, w, b):
    """Beyond the edge it reads the other end of the window instead of zeros."""
    y, taps = correlate(x, w, mode="wrap") + b, len(w)

    def pullback(dy):
        x_wrapped = padded(x, taps // 2, taps // 2, "wrap")
        dw = [np.einsum("btc,btd->cd", x_wrapped[:, k : k + x.shape[1]], dy) for k in range(taps)]
        return correlate(dy, w_tilde(w), mode="wrap"), np.stack(dw), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="value")
def conv_looks_ahead(x, w, b):
    """The padding is all behind: off by half a filter, the filter starts at its own frame."""
    taps, frames = len(w), x.shape[1]
    y = correlate(x, w, before=0) + b

    def pullback(dy):
        dx = correlate(dy, w_tilde(w), before=taps - 1)
        x_padded = padded(x, 0, taps - 1)
        dw = [np.einsum("btc,btd->cd", x_padded[:, k : k + frames], dy) for k in range(taps)]
        return dx, np.stack(dw), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="linearity")
def conv_clips_gradients(x, w, b):
    """The gradient for x is clipped at ±1 inside the pullback: no longer linear, nor a gradient."""
    y = correlate(x, w) + b

    def pullback(dy):
        dx = np.clip(correlate(dy, w_tilde(w)), -1, 1)
        return dx, for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="purity")
def conv_subtracts_in_place(x, w, b):
    """The window's mean is taken off for accuracy, in place, and x is not what it was."""
    mean = x.mean(axis=1, keepdims=True)
    x -= mean
    y = correlate(x, w) + correlate(np.broadcast_to(mean, x.shape), w) + b
    whole = x + mean

    def pullback(dy):
        return correlate(dy, w_tilde(w)), for_filters(whole, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="independence")
def conv_accumulates(x, w, b):
    """The filters' gradient is added to a buffer that is never cleared."""
    y, dw = correlate(x, w) + b, np.zeros_like(w)

    def pullback(dy):
        dw.__iadd__(for_filters(x, dy, len(w)))
        return correlate(dy, w_tilde(w)), dw, dy.sum(axis=(0, 1))

    return y, pullback


LAST_INPUT = {}


@bug("conv1d", caught_by="independence")
def conv_remembers_globally(x, w, b):
    """x is kept for the pullback in one place for all calls: the last call's is used."""
    LAST_INPUT["x"] = x
    y = correlate(x, w) + b

    def pullback(dy):
        dw = for_filters(LAST_INPUT["x"], dy, len(w))
        return correlate(dy, w_tilde(w)), dw, dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="dtype")
def conv_in_float32(x, w, b):
    """It computes in float32 inside and hands back float64."""
    small_x, small_w = x.astype(np.float32), w.astype(np.float32)
    y = (correlate(small_x, small_w) + b.astype(np.float32)).astype(x.dtype)

    def pullback(dy):
        dx = correlate(dy.astype(np.float32), w_tilde(small_w)).astype(x.dtype)
        return dx, for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="dtype")
def conv_turns_to_float64(x, w, b):
    """Its buffers are np.zeros without a dtype: float32 becomes float64."""
    y = np.zeros((*x.shape[:2], w.shape[2]))
    y += correlate(x, w) + b

    def pullback(dy):
        return correlate(dy, w_tilde(w)), for_filters(x, dy, len(w)), dy.sum(axis=(0, 1))

    return y, pullback


@bug("conv1d", caught_by="strides")
def conv_trusts_the_memory_order(x, w, b):
    """It looks at x's memory as if every array were contiguous: a view gives another's frames."""
    as_in_memory = np.ravel(x, order="K").reshape(x.shape)
    y = correlate(as_in_memory, w) + b

    def pullback(dy):
        dw = for_filters(as_in_memory, dy, len(w))
        return correlate(dy, w_tilde(w)), dw, dy.sum(axis=(0, 1))

    return y, pullback
