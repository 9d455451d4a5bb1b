"""PyTorch: a + b with broadcasting."""

from studies.gradients.published import PublishedOperation


def add(a, b, *, fixed):
    def pullback(dy):
        if fixed:
            return dy.copy(), dy.sum(axis=0)
        else:
            return dy.copy(), dy.copy()

    return a + b, pullback


PUBLISHED = PublishedOperation(
    project="PyTorch",
    operation="a + b with broadcasting",
    thread="https://github.com/pytorch/pytorch/issues/913",
    fix="https://github.com/pytorch/pytorch/pull/852",
    mistake="The gradient for the argument that was broadcast keeps the shape of the sum.",
    shapes={"a": "batch channels", "b": "channels"},
    function=add,
)
