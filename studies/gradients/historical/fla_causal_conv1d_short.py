"""flash-linear-attention: causal_conv1d with a state."""

import numpy as np

from studies.gradients.published import PublishedOperation


def final_state(x, width=4, *, fixed):
    padded = np.concatenate([np.zeros_like(x[:1]).repeat(width, axis=0), x])

    def pullback(dstate):
        dx = np.zeros_like(x)
        if fixed:
            start = len(x) - width
        else:
            start = max(0, len(x) - width)
        for t in range(max(0, len(x) - width), len(x)):
            dx[t] = dstate[t - start]
        return dx

    return padded[-width:].copy(), pullback


PUBLISHED = PublishedOperation(
    project="flash-linear-attention",
    operation="causal_conv1d with a state",
    thread="https://github.com/fla-org/flash-linear-attention/issues/1140",
    fix="https://github.com/fla-org/flash-linear-attention/pull/1141",
    mistake=(
        "max(0, T - (W - 1)) in the index of the final state: wrong for sequences shorter "
        "than the filter."
    ),
    shapes={"x": "frames channels"},
    function=final_state,
)
