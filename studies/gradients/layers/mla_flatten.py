"""MLAlgorithms: flatten."""

from studies.gradients.published import PublishedOperation


def flatten(x):
    return x.reshape(len(x), -1), lambda dy: dy.reshape(x.shape)


PUBLISHED = PublishedOperation(
    project="MLAlgorithms",
    operation="flatten",
    thread="https://github.com/rushter/MLAlgorithms/blob/master/mla/neuralnet/layers/convnet.py",
    shapes={"x": "batch channels rows"},
    function=flatten,
)
