"""autograd: multivariate_normal.logpdf."""

import numpy as np

from studies.gradients.published import PublishedOperation


def log_density(x, a, *, fixed):
    covariance = a @ a.T + np.eye(len(x), dtype=a.dtype)
    inverse = np.linalg.inv(covariance)
    y = -0.5 * (np.linalg.slogdet(covariance)[1] + x @ inverse @ x)

    def pullback(dy):
        if fixed:
            slope = -0.5 * (inverse - np.outer(inverse @ x, inverse @ x))
        else:
            slope = 0.5 * (inverse - np.outer(inverse @ x, inverse @ x))
        return -dy * inverse @ x, 2 * dy * slope @ a

    return y, pullback


PUBLISHED = PublishedOperation(
    project="autograd",
    operation="multivariate_normal.logpdf",
    thread="https://github.com/HIPS/autograd/pull/412",
    fix="https://github.com/HIPS/autograd/pull/412",
    mistake=(
        "The gradient for the covariance has the wrong sign; a typing error kept its test "
        "from running."
    ),
    shapes={"x": "channels", "a": "channels channels"},
    function=log_density,
)
