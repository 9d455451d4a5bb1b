"""micrograd_c: subtract."""

from studies.gradients.published import PublishedOperation


def subtract(a, b, *, fixed):
    def pullback(dy):
        if fixed:
            return dy.copy(), -dy
        else:
            return dy.copy(), dy.copy()

    return a - b, pullback


PUBLISHED = PublishedOperation(
    project="micrograd_c",
    operation="subtract",
    thread="https://github.com/KhawajaAbaid/micrograd_c/issues/1",
    fix="https://github.com/KhawajaAbaid/micrograd_c/commit/1f7a98d2d5723a5def525a5a84696f2739c26c5d",
    mistake="The gradient for the second value has the wrong sign.",
    shapes={"a": "batch", "b": "batch"},
    function=subtract,
)
