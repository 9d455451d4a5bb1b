"""warp-ctc: CTC loss, here of one frame."""

import numpy as np

from studies.gradients.published import PublishedOperation


def ctc_of_one_frame(x, *, fixed):
    e = np.exp(x - x.max(axis=-1, keepdims=True))
    p = e / e.sum(axis=-1, keepdims=True)
    loss = (np.log(e.sum(axis=-1)) + x.max(axis=-1) - x[:, 0]).sum()

    def pullback(dloss):
        dx = p.copy()
        dx[:, 0] -= 1
        if fixed:
            return dloss * dx
        else:
            return dx

    return loss, pullback


PUBLISHED = PublishedOperation(
    project="warp-ctc",
    operation="CTC loss, here of one frame",
    thread="https://github.com/SeanNaren/warp-ctc/issues/69",
    fix="https://github.com/SeanNaren/warp-ctc/pull/170",
    mistake="The upstream gradient is ignored: a loss times 0.1 has the same gradient.",
    shapes={"x": "batch classes"},
    function=ctc_of_one_frame,
)
