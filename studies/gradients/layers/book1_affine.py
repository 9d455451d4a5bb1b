"""Deep Learning from Scratch: affine layer of images."""

from studies.gradients.published import PublishedOperation


def affine(x, w, b):
    flat = x.reshape(len(x), -1)

    def pullback(dy):
        return (dy @ w.T).reshape(x.shape), flat.T @ dy, dy.sum(axis=0)

    return flat @ w + b, pullback


PUBLISHED = PublishedOperation(
    project="Deep Learning from Scratch",
    operation="affine layer of images",
    thread="https://github.com/oreilly-japan/deep-learning-from-scratch/blob/master/common/layers.py",
    shapes={"x": "batch rows columns", "w": "rows*columns features", "b": "features"},
    function=affine,
)
