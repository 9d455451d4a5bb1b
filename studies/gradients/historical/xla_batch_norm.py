"""PyTorch/XLA: batch norm in evaluation."""

from studies.gradients.published import PublishedOperation


def batch_norm(x, *, fixed):
    running_mean, running_variance = 0.5, 2.0
    scale = running_variance**-0.5
    y = (x - running_mean) * scale

    def pullback(dy):
        if fixed:
            return dy * scale
        else:
            return scale * (dy - dy.mean(axis=0) - y * (dy * y).mean(axis=0))

    return y, pullback


PUBLISHED = PublishedOperation(
    project="PyTorch/XLA",
    operation="batch norm in evaluation",
    thread="https://github.com/pytorch/xla/issues/913",
    fix="https://github.com/pytorch/xla/pull/934",
    mistake="In evaluation the statistics are constants; the gradient is still that of training.",
    shapes={"x": "batch channels"},
    function=batch_norm,
)
