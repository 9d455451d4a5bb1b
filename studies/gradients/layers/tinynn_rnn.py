"""tinynn: recurrent layer that returns its last output."""

import numpy as np

from studies.gradients.published import PublishedOperation


def recurrent(x, u, v, *, fixed):
    h = np.tanh(x @ u.T)

    def pullback(dy):
        dx, du, dv = np.zeros_like(x), np.zeros_like(u), np.zeros_like(v)
        steps = range(x.shape[1])
        if fixed:
            steps = steps[-1:]
        for t in steps:
            dv += dy.T @ h[:, t]
            da = dy @ v * (1 - h[:, t] ** 2)
            du += da.T @ x[:, t]
            dx[:, t] = da @ u
        return dx, du, dv

    return h[:, -1] @ v.T, pullback


PUBLISHED = PublishedOperation(
    project="tinynn",
    operation="recurrent layer that returns its last output",
    thread="https://github.com/borgwang/tinynn/blob/master/tinynn/core/layer.py",
    mistake="The gradient of the last output is given to the outputs of all steps.",
    shapes={"x": "batch frames channels", "u": "hidden channels", "v": "features hidden"},
    function=recurrent,
)
