"""Caffe: MVN, mean only."""

from studies.gradients.published import PublishedOperation


def without_mean(x, *, fixed):
    def pullback(dy):
        if fixed:
            return dy - dy.mean(axis=-1, keepdims=True)
        else:
            return dy.copy()

    return x - x.mean(axis=-1, keepdims=True), pullback


PUBLISHED = PublishedOperation(
    project="Caffe",
    operation="MVN, mean only",
    thread="https://github.com/BVLC/caffe/issues/1938",
    fix="https://github.com/BVLC/caffe/pull/2964",
    mistake=(
        "Where only the mean is subtracted, the upstream gradient is copied: its own mean is "
        "not subtracted."
    ),
    shapes={"x": "batch channels"},
    function=without_mean,
)
