"""flash-attention: attention with softcap."""

import numpy as np

from studies.gradients.published import PublishedOperation


def attention(q, k, v, cap=2.0, *, fixed):
    capped = np.tanh(q @ k.T / cap)
    e = np.exp(cap * capped - cap)
    p = e / e.sum(axis=1, keepdims=True)

    def pullback(dy):
        dp = dy @ v.T
        ds = p * (dp - (dp * p).sum(axis=1, keepdims=True))
        if fixed:
            ds = ds * (1 - capped * capped)
        return ds @ k, ds.T @ q, p.T @ dy

    return p @ v, pullback


PUBLISHED = PublishedOperation(
    project="flash-attention",
    operation="attention with softcap",
    thread="https://github.com/Dao-AILab/flash-attention/pull/2544",
    fix="https://github.com/Dao-AILab/flash-attention/pull/2402",
    mistake=(
        "The backward step does not know the softcap: the factor 1 - tanh² is missing in dq and dk."
    ),
    shapes={"q": "frames channels", "k": "frames channels", "v": "frames channels"},
    function=attention,
)
