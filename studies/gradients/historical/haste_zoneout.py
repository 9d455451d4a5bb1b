"""Haste: GRU with zoneout."""

import numpy as np

from studies.gradients.published import PublishedOperation


def recurrence(x, *, fixed):
    kept = np.arange(x.size).reshape(x.shape) % 3 == 0
    h, states = np.zeros_like(x[0]), []
    for t in range(len(x)):
        h = np.where(kept[t], h, np.tanh(x[t] + h))
        states.append(h)
    y = np.stack(states)

    def pullback(dy):
        dx, dh = np.zeros_like(x), np.zeros_like(x[0])
        for t in reversed(range(len(x))):
            dh = dh + dy[t]
            if fixed:
                mask = kept[t]
            else:
                mask = kept[0]
            dx[t] = np.where(mask, 0, dh * (1 - y[t] * y[t]))
            dh = np.where(mask, dh, dx[t])
        return dx

    return y, pullback


PUBLISHED = PublishedOperation(
    project="Haste",
    operation="GRU with zoneout",
    thread="https://github.com/lmnt-com/haste/issues/43",
    fix="https://github.com/lmnt-com/haste/issues/43",
    mistake="The gradients of all frames use the zoneout mask of the first.",
    shapes={"x": "frames channels"},
    function=recurrence,
)
