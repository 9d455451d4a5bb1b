"""tt-metal: clamp with bounds that are arrays."""

import numpy as np

from studies.gradients.published import PublishedOperation


def clamp(x, *, fixed):
    low, high = -np.ones_like(x), np.ones_like(x)

    def pullback(dy):
        if fixed:
            inside = (x >= low) & (x <= high)
        else:
            inside = (x <= low) & (x >= high)
        return np.where(inside, dy, 0)

    return np.clip(x, low, high), pullback


PUBLISHED = PublishedOperation(
    project="tt-metal",
    operation="clamp with bounds that are arrays",
    thread="https://github.com/tenstorrent/tt-metal/pull/48204",
    fix="https://github.com/tenstorrent/tt-metal/pull/48204",
    mistake=(
        "The comparisons are the wrong way round: no entry is below the lower and above the "
        "upper bound, the gradient is 0."
    ),
    shapes={"x": "batch channels"},
    function=clamp,
)
