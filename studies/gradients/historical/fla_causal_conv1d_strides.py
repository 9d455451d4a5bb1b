"""flash-linear-attention: causal_conv1d."""

import numpy as np

from studies.gradients.published import PublishedOperation, in_memory_order


def causal_conv(x, w, *, fixed):
    taps = len(w)
    padded = np.concatenate([np.zeros_like(w[1:]), x])
    windows = [padded[taps - 1 - k : taps - 1 - k + len(x)] for k in range(taps)]

    def pullback(dy):
        if not fixed:
            dy = in_memory_order(dy)
        dx = np.zeros_like(padded)
        for k in range(taps):
            dx[taps - 1 - k : taps - 1 - k + len(x)] += dy * w[k]
        dw = np.stack([(dy * window).sum(axis=0) for window in windows])
        return dx[taps - 1 :], dw

    return sum(window * w[k] for k, window in enumerate(windows)), pullback


PUBLISHED = PublishedOperation(
    project="flash-linear-attention",
    operation="causal_conv1d",
    thread="https://github.com/fla-org/flash-linear-attention/pull/871",
    fix="https://github.com/fla-org/flash-linear-attention/pull/871",
    mistake=(
        "The strides of the upstream gradient are written down in the kernel: right only for "
        "a contiguous array."
    ),
    shapes={"x": "frames channels", "w": "taps channels"},
    function=causal_conv,
)
