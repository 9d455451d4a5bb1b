"""Deep Learning from Scratch 2: affine layer of sequences."""

from studies.gradients.published import PublishedOperation


def affine(x, w, b):
    rows = x.reshape(-1, x.shape[2])

    def pullback(dy):
        dy = dy.reshape(len(rows), -1)
        return (dy @ w.T).reshape(x.shape), rows.T @ dy, dy.sum(axis=0)

    return (rows @ w + b).reshape(*x.shape[:2], -1), pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch 2",
    operation="affine layer of sequences",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch-2/blob/master/common/time_layers.py",
    shapes={"x": "batch frames channels", "w": "channels features", "b": "features"},
    function=affine,
)
