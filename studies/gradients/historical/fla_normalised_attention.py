"""flash-linear-attention: chunk_linear_attn with normalize=True."""

import numpy as np

from studies.gradients.published import PublishedOperation


def linear_attention(q, k, v, *, fixed):
    e, f = np.exp(q), np.exp(k)
    scores = np.tril(e @ f.T)
    total = scores.sum(axis=1, keepdims=True)
    y = scores @ v / total

    def pullback(dy):
        dnumerator = dy / total
        dscores = np.tril(dnumerator @ v.T)
        dtotal = -(dnumerator * y).sum(axis=1, keepdims=True)
        through_total = np.tril(np.broadcast_to(dtotal, scores.shape))
        dq = e * ((dscores + through_total) @ f)
        if fixed:
            dk = f * ((dscores + through_total).T @ e)
        else:
            dk = f * (dscores.T @ e)
        return dq, dk, scores.T @ dnumerator

    return y, pullback


PUBLISHED = PublishedOperation(
    project="flash-linear-attention",
    operation="chunk_linear_attn with normalize=True",
    thread="https://github.com/fla-org/flash-linear-attention/pull/875",
    fix="https://github.com/fla-org/flash-linear-attention/pull/875",
    mistake=(
        "The sum of the keys in the denominator is computed outside of the graph: the "
        "gradient for k misses a term."
    ),
    shapes={"q": "frames channels", "k": "frames channels", "v": "frames channels"},
    function=linear_attention,
)
