"""jax-js: triangular_solve."""

import numpy as np

from studies.gradients.published import PublishedOperation


def solve_unit_upper(a, b, *, fixed):
    upper = np.triu(a, 1) + np.eye(len(a), dtype=a.dtype)
    x = np.linalg.solve(upper, b)

    def pullback(dx):
        db = np.linalg.solve(upper.T, dx)
        da = -np.outer(db, x)
        if fixed:
            return np.triu(da, 1), db
        else:
            return da, db

    return x, pullback


PUBLISHED = PublishedOperation(
    project="jax-js",
    operation="triangular_solve",
    thread="https://github.com/ekzhang/jax-js/issues/84",
    fix="https://github.com/ekzhang/jax-js/issues/84",
    mistake=(
        "The part of the gradient below the diagonal, which the solver never reads, is not "
        "set to 0."
    ),
    shapes={"a": "channels channels", "b": "channels"},
    ranges={"a": (-0.1, 0.1)},
    function=solve_unit_upper,
)
