"""OneFlow: layer norm."""

from studies.gradients.published import PublishedOperation


def scale_and_shift(x, weight, bias, *, fixed):
    def pullback(dy):
        of_weight, of_bias = (dy * x).sum(axis=0), dy.sum(axis=0)
        if fixed:
            return dy * weight, of_weight, of_bias
        else:
            return dy * weight, of_bias, of_weight

    return x * weight + bias, pullback


PUBLISHED = PublishedOperation(
    project="OneFlow",
    operation="layer norm",
    thread="https://github.com/Oneflow-Inc/oneflow/pull/6149",
    fix="https://github.com/Oneflow-Inc/oneflow/pull/6149",
    mistake="The gradients for the weight and the bias are returned in the wrong order.",
    shapes={"x": "batch channels", "weight": "channels", "bias": "channels"},
    function=scale_and_shift,
)
