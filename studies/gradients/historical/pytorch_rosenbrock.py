"""PyTorch: the gradient in the tests of the optimisers."""

from studies.gradients.published import PublishedOperation


def rosenbrock(x, y, *, fixed):
    def pullback(dz):
        gap = y - x * x
        if fixed:
            return dz * (-400 * x * gap - 2 * (1 - x)), dz * 200 * gap
        else:
            return dz * (-400 * x * gap - 2 * (1 - x)), dz * 200 * x * gap

    return (1 - x) ** 2 + 100 * (y - x * x) ** 2, pullback


PUBLISHED = PublishedOperation(
    project="PyTorch",
    operation="the gradient in the tests of the optimisers",
    thread="https://github.com/pytorch/pytorch/pull/3881",
    fix="https://github.com/pytorch/pytorch/pull/3881",
    mistake=(
        "A factor x too many, which is near 1 at the minimum: 200 x (y - x²) instead of 200 "
        "(y - x²)."
    ),
    shapes={"x": "batch", "y": "batch"},
    function=rosenbrock,
)
