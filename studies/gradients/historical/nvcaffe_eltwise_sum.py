"""NVIDIA Caffe: Eltwise SUM."""

from studies.gradients.published import PublishedOperation


def eltwise_sum(a, b, *, fixed):
    def pullback(dy):
        if fixed:
            return dy.copy(), dy.copy()
        else:
            shared = dy.copy()
            return shared, shared

    return a + b, pullback


PUBLISHED = PublishedOperation(
    project="NVIDIA Caffe",
    operation="Eltwise SUM",
    thread="https://github.com/NVIDIA/caffe/issues/523",
    fix="https://github.com/NVIDIA/caffe/issues/523",
    mistake=(
        "Both inputs share one array of gradients: a layer below that changes its own in "
        "place changes the other's."
    ),
    shapes={"a": "batch channels", "b": "batch channels"},
    function=eltwise_sum,
)
