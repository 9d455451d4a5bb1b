"""Torch 7 (cunn): DistKLDivCriterion."""

import numpy as np

from studies.gradients.published import PublishedOperation


def kl_divergence(x, *, fixed):
    target = np.full_like(x, 1 / x.shape[-1])
    loss = (target * (np.log(target) - x)).mean()

    def pullback(dloss):
        if fixed:
            return -dloss * target / x.size
        else:
            return -2 * dloss * target / x.size

    return loss, pullback


PUBLISHED = PublishedOperation(
    project="Torch 7 (cunn)",
    operation="DistKLDivCriterion",
    thread="https://github.com/torch/cunn/pull/318",
    fix="https://github.com/torch/cunn/pull/318",
    mistake=(
        "The gradient is twice as large; the test allowed an error of 0.01 and did not notice"
        " it for years."
    ),
    shapes={"x": "batch classes"},
    function=kl_divergence,
)
