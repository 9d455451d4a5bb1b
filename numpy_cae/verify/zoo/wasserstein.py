"""Wrong sliced Wasserstein distances. The right one is `numpy_cae.ops.sliced_wasserstein`."""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.zoo.bug import bug


def gaps(z, prior, directions):
    """The sorted projections' gaps and the order that sorted them."""
    p = z @ directions.T
    order = np.argsort(p, axis=0)
    return np.sort(p, axis=0) - np.sort(prior @ directions.T, axis=0), order


def scattered(values, order):
    out = np.empty_like(values)
    np.put_along_axis(out, order, values, axis=0)
    return out


@bug("sliced_wasserstein", caught_by="gradient for z")
def sliced_not_scattered_back(z, prior, directions):
    """The gradient stays in sorted order: it is not carried back to the points it belongs to."""
    gap, _ = gaps(z, prior, directions)
    return np.mean(gap * gap), lambda dloss=1.0: 2 * float(dloss) / gap.size * gap @ directions


@bug("sliced_wasserstein", caught_by="gradient for z")
def sliced_gathered_not_scattered(z, prior, directions):
    """The permutation is applied once more instead of being undone."""
    gap, order = gaps(z, prior, directions)

    def pullback(dloss=1.0):
        dp = np.take_along_axis(2 * float(dloss) / gap.size * gap, order, axis=0)
        return dp @ directions

    return np.mean(gap * gap), pullback


@bug("sliced_wasserstein", caught_by="gradient for z")
def sliced_without_two(z, prior, directions):
    """The derivative of a square without its factor of 2."""
    gap, order = gaps(z, prior, directions)
    loss = np.mean(gap * gap)
    return loss, lambda dloss=1.0: scattered(float(dloss) / gap.size * gap, order) @ directions


@bug("sliced_wasserstein", caught_by="gradient for z")
def sliced_not_over_directions(z, prior, directions):
    """The gradient is divided by the points but not by the directions."""
    gap, order = gaps(z, prior, directions)
    loss = np.mean(gap * gap)
    return loss, lambda dloss=1.0: scattered(2 * float(dloss) / len(z) * gap, order) @ directions


@bug("sliced_wasserstein", caught_by="gradient for z")
def sliced_sign_lost(z, prior, directions):
    """The gradient pushes z away from the prior: the sign."""
    gap, order = gaps(z, prior, directions)
    loss = np.mean(gap * gap)
    return loss, lambda dloss=1.0: scattered(-2 * float(dloss) / gap.size * gap, order) @ directions


@bug("sliced_wasserstein", caught_by="order")
def sliced_unsorted_prior(z, prior, directions):
    """The prior's projections are not sorted: points are paired by chance."""
    p = z @ directions.T
    order = np.argsort(p, axis=0)
    gap = np.sort(p, axis=0) - prior @ directions.T
    loss = np.mean(gap * gap)
    return loss, lambda dloss=1.0: scattered(2 * float(dloss) / gap.size * gap, order) @ directions


@bug("sliced_wasserstein", caught_by="equal sets")
def sliced_never_sorts(z, prior, directions):
    """Nothing is sorted: it is a mean squared error of the projections."""
    gap = (z - prior) @ directions.T
    return np.mean(gap * gap), lambda dloss=1.0: 2 * float(dloss) / gap.size * gap @ directions


@bug("sliced_wasserstein", caught_by="optimal assignment")
def sliced_absolute(z, prior, directions):
    """The absolute gap takes the place of the squared one: the 1-Wasserstein distance."""
    gap, order = gaps(z, prior, directions)
    sign = np.sign(np.where(np.abs(gap) < 1e-12, 0, gap))
    loss = np.mean(np.abs(gap))
    return loss, lambda dloss=1.0: scattered(float(dloss) / gap.size * sign, order) @ directions


@bug("sliced_wasserstein", caught_by="value")
def sliced_summed(z, prior, directions):
    """A sum over the points where it should be a mean."""
    gap, order = gaps(z, prior, directions)
    loss = np.sum(gap * gap) / len(directions)
    scale = 2 / len(directions)
    return loss, lambda dloss=1.0: scattered(scale * float(dloss) * gap, order) @ directions


@bug("sliced_wasserstein", caught_by="value")
def sliced_sorts_points_not_projections(z, prior, directions):
    """Each coordinate is sorted before the projection, where the projections should be."""
    order = np.argsort(z, axis=0)
    gap = (np.sort(z, axis=0) - np.sort(prior, axis=0)) @ directions.T

    def pullback(dloss=1.0):
        return scattered(2 * float(dloss) / gap.size * gap @ directions, order)

    return np.mean(gap * gap), pullback
