"""neon: bprop_conv."""

import numpy as np

from studies.gradients.published import PublishedOperation


def convolve(x, w, *, fixed):
    frames, taps = len(x), len(w)
    y = np.zeros_like(x)
    for m in range(frames):
        for k in range(min(taps, m + 1)):
            y[m] += x[m - k] * w[k]

    def pullback(dy):
        dx, dw = np.zeros_like(x), np.zeros_like(w)
        for m in range(frames):
            for k in range(min(taps, m + 1)):
                d = m - k
                if fixed:
                    dx[d] = dx[d] + dy[m] * w[k]
                else:
                    dx[m] = dx[m] + dy[m] * w[k]
                dw[k] += dy[m] * x[d]
        return dx, dw

    return y, pullback


PUBLISHED = PublishedOperation(
    project="neon",
    operation="bprop_conv",
    thread="https://github.com/NervanaSystems/neon/issues/111",
    fix="https://github.com/NervanaSystems/neon/issues/111",
    mistake=(
        "The gradient for the input is stored at the index of the output, m, instead of that "
        "of the input, d."
    ),
    shapes={"x": "frames channels", "w": "taps channels"},
    function=convolve,
)
