"""MyGrad: product with broadcasting."""

from studies.gradients.published import PublishedOperation


def multiply(a, b, *, fixed):
    def pullback(dy):
        db = (dy * a).sum(axis=0)
        if fixed:
            return dy * b, db
        else:
            return dy * b, db + db

    return a * b, pullback


PUBLISHED = PublishedOperation(
    project="MyGrad",
    operation="product with broadcasting",
    thread="https://github.com/rsokl/MyGrad/pull/131",
    fix="https://github.com/rsokl/MyGrad/pull/131",
    mistake=(
        "The backward step of an argument that was broadcast is called twice: its gradient is"
        " doubled."
    ),
    shapes={"a": "batch channels", "b": "channels"},
    function=multiply,
)
