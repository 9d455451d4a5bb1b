"""Mamba: parallel layer norm with rowscale."""

from studies.gradients.published import PublishedOperation


def scaled_sum(x, x1, scale, *, fixed):
    def pullback(dy):
        rows = scale[:, None]
        if fixed:
            return dy * rows, dy * rows, (dy * (x + x1)).sum(axis=1)
        else:
            return dy * rows, dy.copy(), (dy * (x + x1)).sum(axis=1)

    return x * scale[:, None] + x1 * scale[:, None], pullback


PUBLISHED = PublishedOperation(
    project="Mamba",
    operation="parallel layer norm with rowscale",
    thread="https://github.com/state-spaces/mamba/pull/1023",
    fix="https://github.com/state-spaces/mamba/pull/1023",
    mistake="The second input is multiplied by its row scale in the forward pass only.",
    shapes={"x": "batch channels", "x1": "batch channels", "scale": "batch"},
    function=scaled_sum,
)
