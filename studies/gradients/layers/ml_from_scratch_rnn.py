"""ML-From-Scratch: recurrent layer."""

import numpy as np

from studies.gradients.published import PublishedOperation


def rnn(x, u, w, *, fixed):
    states = [np.zeros((len(x), len(u)), x.dtype)]
    for t in range(x.shape[1]):
        states.append(np.tanh(x[:, t] @ u.T + states[-1] @ w.T))

    def pullback(dy):
        dx, du, dw = np.zeros_like(x), np.zeros_like(u), np.zeros_like(w)
        carried = np.zeros_like(states[0])
        for t in reversed(range(x.shape[1])):
            slope = 1 - states[t + 1] ** 2
            da = (dy[:, t] + carried) * slope
            if fixed:
                dx[:, t] = da @ u
            else:
                dx[:, t] = (dy[:, t] * slope) @ u
            du, dw, carried = du + da.T @ x[:, t], dw + da.T @ states[t], da @ w
        return dx, du, dw

    return np.stack(states[1:], axis=1), pullback


PUBLISHED = PublishedOperation(
    project="ML-From-Scratch",
    operation="recurrent layer",
    thread="https://github.com/eriklindernoren/ML-From-Scratch/blob/master/mlfromscratch/deep_learning/layers.py",
    mistake="The gradient for the input at a step ignores all later steps.",
    shapes={"x": "batch frames channels", "u": "hidden channels", "w": "hidden hidden"},
    function=rnn,
)
