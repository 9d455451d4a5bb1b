"""autobw.torch: backward of a Y-shaped model."""

import numpy as np

from studies.gradients.published import PublishedOperation


def y_shaped(x, *, fixed):
    adjoints = {}

    def pullback(dy):
        if fixed:
            adjoint = np.zeros_like(x)
        else:
            adjoint = adjoints.setdefault("x", np.zeros_like(x))
        adjoint += 2 * x * dy
        adjoint += dy
        return adjoint.copy()

    return x * x + x, pullback


PUBLISHED = PublishedOperation(
    project="autobw.torch",
    operation="backward of a Y-shaped model",
    thread="https://github.com/bshillingford/autobw.torch/pull/7",
    fix="https://github.com/bshillingford/autobw.torch/pull/7",
    mistake="Adjoints are cached and never cleared: right only the first time.",
    shapes={"x": "batch channels"},
    function=y_shaped,
)
