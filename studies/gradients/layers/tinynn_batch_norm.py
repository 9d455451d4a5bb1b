"""tinynn: batch normalisation."""

from studies.gradients.published import PublishedOperation


def batch_norm(x, gain, shift):
    centred = x - x.mean(axis=0)
    inverse = 1.0 / (x.var(axis=0) + 1e-5) ** 0.5
    n = centred * inverse

    def pullback(dy):
        together = len(x) * dy - dy.sum(axis=0) - centred * inverse**2 * (dy * centred).sum(axis=0)
        return gain * inverse * together / len(x), (n * dy).sum(axis=0), dy.sum(axis=0)

    return gain * n + shift, pullback


PUBLISHED = PublishedOperation(
    project="tinynn",
    operation="batch normalisation",
    thread="https://github.com/borgwang/tinynn/blob/master/tinynn/core/layer.py",
    shapes={"x": "batch features", "gain": "features", "shift": "features"},
    function=batch_norm,
)
