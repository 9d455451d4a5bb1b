"""Wrong steps of the GRU. The right one is `numpy_cae.ops.gru_step`, with the equations.

All but the last few share their forward pass, so that each differs from the right one in a line or
two of its pullback.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from numpy_cae.verify.zoo.bug import bug


def sigmoid(a):
    return 1 / (1 + np.exp(-a))


def forward(x, h, w, u, b, c):
    """The step, with everything on the way kept by its name in `gru_step`."""
    a_r, a_z, a_n = np.split(x @ w + b, 3, axis=-1)
    s_r, s_z, s_n = np.split(h @ u + c, 3, axis=-1)
    r, z = sigmoid(a_r + s_r), sigmoid(a_z + s_z)
    n = np.tanh(a_n + r * s_n)
    return SimpleNamespace(r=r, z=z, n=n, s_n=s_n, h_next=(1 - z) * n + z * h)


def backward(x, h, w, u, da, ds, dh_direct):
    """From the gradients of both sums to those of the arguments."""
    da, ds = np.concatenate(da, axis=-1), np.concatenate(ds, axis=-1)
    return da @ w.T, dh_direct + ds @ u.T, x.T @ da, h.T @ ds, da.sum(axis=0), ds.sum(axis=0)


@bug("gru_step", caught_by="gradient for h")
def step_without_reset_path(x, h, w, u, b, c):
    """The path through the reset gate is missing: r is treated as a constant."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = np.zeros_like(da_z)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for x")
def step_pullback_exchanges_z(x, h, w, u, b, c):
    """z and 1 - z are exchanged in the pullback alone."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * f.z * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * (1 - f.z))

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for h")
def step_without_direct_path(x, h, w, u, b, c):
    """The state's direct path z ∘ h is missing: its gradient comes through the gates alone."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, np.zeros_like(h))

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for h")
def step_direct_path_only(x, h, w, u, b, c):
    """The state's gradient is the direct path alone: what went through U is missing."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        dx, _, *of_weights = backward(x, h, w, u, (da_r, da_z, da_n), ds, 0)
        return dx, dh_next * f.z, *of_weights

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for x")
def step_without_tanh_derivative(x, h, w, u, b, c):
    """The new gate's derivative 1 - n² is missing."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for b")
def step_without_update_derivative(x, h, w, u, b, c):
    """The update gate's derivative z (1 - z) is missing."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for w")
def step_without_reset_derivative(x, h, w, u, b, c):
    """The reset gate's derivative r (1 - r) is missing."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for c")
def step_biases_alike(x, h, w, u, b, c):
    """c gets b's gradient, but its new part lies behind the reset gate: the factor r is missing."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        *others, db, _ = backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)
        return *others, db, db.copy()

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for u")
def step_state_without_reset(x, h, w, u, b, c):
    """The gradient of h · Un lacks the factor r that the product was multiplied by."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), (da_r, da_z, da_n), dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for b")
def step_update_sign_lost(x, h, w, u, b, c):
    """The update gate's gradient has n - h for h - n: the sign."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (f.n - h) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for w")
def step_reset_without_bias(x, h, w, u, b, c):
    """The reset gate's gradient is multiplied by h · Un without cn."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        without_bias = f.s_n - c[2 * h.shape[1] :]
        da_r = da_n * without_bias * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="gradient for w")
def step_gates_exchanged(x, h, w, u, b, c):
    """The pullback puts the gates' gradients together as update, reset, new."""
    f = forward(x, h, w, u, b, c)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_z, da_r, da_n * f.r)
        return backward(x, h, w, u, (da_z, da_r, da_n), ds, dh_next * f.z)

    return f.h_next, pullback


@bug("gru_step", caught_by="value")
def step_forgets_c(x, h, w, u, b, c):
    """The new gate's bias c is left out, forward and backward."""
    without = c.copy()
    without[2 * h.shape[1] :] = 0
    f = forward(x, h, w, u, b, without)

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (h - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        *others, dc = backward(x, h, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)
        dc[2 * h.shape[1] :] = 0
        return *others, dc

    return f.h_next, pullback


@bug("gru_step", caught_by="purity")
def step_updates_state_in_place(x, h, w, u, b, c):
    """The new state is written over the old one, which the caller still holds."""
    old = h.copy()
    f = forward(x, old, w, u, b, c)
    h[...] = f.h_next

    def pullback(dh_next):
        da_n = dh_next * (1 - f.z) * (1 - f.n * f.n)
        da_z = dh_next * (old - f.n) * f.z * (1 - f.z)
        da_r = da_n * f.s_n * f.r * (1 - f.r)
        ds = (da_r, da_z, da_n * f.r)
        return backward(x, old, w, u, (da_r, da_z, da_n), ds, dh_next * f.z)

    return f.h_next, pullback
