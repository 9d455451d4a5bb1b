"""Wrong backpropagation through time. The right one is `numpy_cae.ops.gru`.

Each takes a right `gru_step` and repeats it; what is wrong is the bookkeeping over the frames.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.ops import gru_step
from numpy_cae.verify.zoo.bug import bug


def repeated(x, h, weights):
    """The states after each frame, and the pullback of each step."""
    states, pullbacks = [], []
    for t in range(x.shape[1]):
        h, pullback = gru_step(x[:, t], h, *weights)
        states.append(h)
        pullbacks.append(pullback)
    return np.stack(states, axis=1), pullbacks


def added(totals, terms):
    return [total + term for total, term in zip(totals, terms, strict=True)]


@bug("gru", caught_by="gradient for h0")
def gru_first_state_dropped(x, h0, w, u, b, c):
    """The gradient for the first state is dropped: zeros are returned in its place."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
            totals = added(totals, terms)
        return dx, np.zeros_like(h0), *totals

    return y, pullback


@bug("gru", caught_by="gradient for x")
def gru_skips_a_step(x, h0, w, u, b, c):
    """The loop backwards stops before the first frame: one time step is skipped."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in range(x.shape[1] - 1, 0, -1):
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
            totals = added(totals, terms)
        return dx, dh, *totals

    return y, pullback


@bug("gru", caught_by="gradient for x")
def gru_forgets_the_future(x, h0, w, u, b, c):
    """Each frame's gradient is its own output's: nothing is carried back through the state."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t])
            totals = added(totals, terms)
        return dx, dh, *totals

    return y, pullback


@bug("gru", caught_by="gradient for x")
def gru_last_output_only(x, h0, w, u, b, c):
    """Only the last frame's upstream gradient enters: the outputs on the way count for nothing."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), dy[:, -1], list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *terms = pullbacks[t](dh)
            totals = added(totals, terms)
        return dx, dh, *totals

    return y, pullback


@bug("gru", caught_by="gradient for w")
def gru_weights_overwritten(x, h0, w, u, b, c):
    """The weights' gradients are overwritten at each step: the sum over time is missing."""
    y, pullbacks = repeated(x, h0, (w, u, b, c))

    def pullback(dy):
        dx, dh = np.zeros_like(x), np.zeros_like(h0)
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *totals = pullbacks[t](dy[:, t] + dh)
        return dx, dh, *totals

    return y, pullback


@bug("gru", caught_by="gradient for b")
def gru_weights_averaged(x, h0, w, u, b, c):
    """The weights' gradients are a mean over the frames where they should be a sum."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
            totals = added(totals, terms)
        return dx, dh, *(total / x.shape[1] for total in totals)

    return y, pullback


@bug("gru", caught_by="gradient for x")
def gru_frames_reversed(x, h0, w, u, b, c):
    """The input's gradients are collected while walking backwards and never turned around."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = [], np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx_t, dh, *terms = pullbacks[t](dy[:, t] + dh)
            dx.append(dx_t)
            totals = added(totals, terms)
        return np.stack(dx, axis=1), dh, *totals

    return y, pullback


@bug("gru", caught_by="gradient for x")
def gru_walks_forwards(x, h0, w, u, b, c):
    """The pullback goes through the frames from the first to the last."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in range(x.shape[1]):
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
            totals = added(totals, terms)
        return dx, dh, *totals

    return y, pullback


@bug("gru", caught_by="value")
def gru_ignores_first_state(x, h0, w, u, b, c):
    """It begins with a state of zeros, whatever h0 is."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, np.zeros_like(h0), weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
            totals = added(totals, terms)
        return dx, np.zeros_like(h0), *totals

    return y, pullback


@bug("gru", caught_by="value")
def gru_one_frame_late(x, h0, w, u, b, c):
    """It returns the state before each frame, h0 first, where it should return the one after."""
    weights = (w, u, b, c)
    after, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *terms = pullbacks[t](dh)
            dh = dh + dy[:, t]
            totals = added(totals, terms)
        return dx, dh, *totals

    return np.concatenate([h0[:, None], after[:, :-1]], axis=1), pullback


@bug("gru", caught_by="causality")
def gru_normalises_over_time(x, h0, w, u, b, c):
    """x is centred over its frames first, so that the past depends on the future."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x - x.mean(axis=1, keepdims=True), h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
            totals = added(totals, terms)
        return dx - dx.mean(axis=1, keepdims=True), dh, *totals

    return y, pullback


@bug("gru", caught_by="purity")
def gru_pullback_adds_in_place(x, h0, w, u, b, c):
    """The state's gradient is added into dy itself, which the caller may still need."""
    weights = (w, u, b, c)
    y, pullbacks = repeated(x, h0, weights)

    def pullback(dy):
        dx, dh, totals = np.zeros_like(x), np.zeros_like(h0), list(map(np.zeros_like, weights))
        for t in reversed(range(x.shape[1])):
            dy[:, t] += dh
            dx[:, t], dh, *terms = pullbacks[t](dy[:, t])
            totals = added(totals, terms)
        return dx, dh, *totals

    return y, pullback
