"""Wrong affine maps. The right one is `numpy_cae.ops.linear`."""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.zoo.bug import bug


def rows(array):
    return array.reshape(-1, array.shape[-1])


@bug("linear", caught_by="gradient for x")
def linear_weights_not_transposed(x, w, b):
    """The gradient for x is dy · W: the transpose is missing."""
    return x @ w + b, lambda dy: (dy @ w, rows(x).T @ rows(dy), rows(dy).sum(axis=0))


@bug("linear", caught_by="gradient for w")
def linear_weights_gradient_transposed(x, w, b):
    """The gradient for w is dyᵀ · x, the transpose of what it should be."""
    return x @ w + b, lambda dy: (dy @ w.T, rows(dy).T @ rows(x), rows(dy).sum(axis=0))


@bug("linear", caught_by="gradient for w")
def linear_weights_of_last_row(x, w, b):
    """The gradient for w is that of the last row: the sum over the rows is missing."""
    y = x @ w + b
    return y, lambda dy: (
        dy @ w.T,
        np.outer(rows(x)[-1], rows(dy)[-1]),
        rows(dy).sum(axis=0),
    )


@bug("linear", caught_by="gradient for b")
def linear_bias_averaged(x, w, b):
    """The gradient for b is a mean over the rows where it should be a sum."""
    return x @ w + b, lambda dy: (dy @ w.T, rows(x).T @ rows(dy), rows(dy).mean(axis=0))


@bug("linear", caught_by="gradient for b")
def linear_bias_not_over_frames(x, w, b):
    """The gradient for b is summed over the first axis only, not over the frames."""
    return x @ w + b, lambda dy: (dy @ w.T, rows(x).T @ rows(dy), np.atleast_2d(dy).sum(axis=0))


@bug("linear", caught_by="value")
def linear_forgets_bias(x, w, b):
    """The bias is not added, though it gets a gradient."""
    return x @ w, lambda dy: (dy @ w.T, rows(x).T @ rows(dy), rows(dy).sum(axis=0))


@bug("linear", caught_by="rows alone")
def linear_centres_the_batch(x, w, b):
    """It takes the mean over the rows off x, so that a row's value depends on its neighbours."""
    centred = rows(x) - rows(x).mean(axis=0)
    y = (centred @ w + b).reshape(*x.shape[:-1], -1)

    def pullback(dy):
        dcentred = rows(dy) @ w.T
        dx = (dcentred - dcentred.mean(axis=0)).reshape(x.shape)
        return dx, centred.T @ rows(dy), rows(dy).sum(axis=0)

    return y, pullback
