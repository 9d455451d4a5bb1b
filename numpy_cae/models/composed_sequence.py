"""jang2018's network and its loss, composed of `numpy_cae.ops`: the definition.

Operations forwards in their order, pullbacks backwards in reverse order. `SequentialAutoencoder`
computes the same by `numpy_cae.fast.sequence_network`, which tests hold equal to what stands here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from numpy_cae import ops
from numpy_cae.models.sequence_weights import Weights, gru_weights

EncodePullback = Callable[[np.ndarray], Weights]
DecodePullback = Callable[[np.ndarray], tuple[np.ndarray, Weights]]


class Losses(NamedTuple):
    """What training makes small, and the two numbers that it is the sum of.

    Attributes
    ----------
    total : float
        reconstruction + λ · discrepancy.
    reconstruction : float
        Mean squared error over every element, so that it depends on no length and no batch.
    discrepancy : float
        The sliced Wasserstein distance between the batch's latent vectors and draws of the prior.
    """

    total: float
    reconstruction: float
    discrepancy: float


def encode(weights: Weights, x: np.ndarray) -> tuple[np.ndarray, EncodePullback]:
    """z = h_T · W + b, where h_1, …, h_T are the GRU's states over the clip and h_0 = 0.

    z depends on the clip through the last state alone, so that is where its gradient enters:

        dh_T = dz · Wᵀ,   dh_t = 0 from the loss for every t < T

    and the pullback of `ops.gru` carries it back through time. Nothing asks for dx, since x is
    data, nor for dh_0, since h_0 is no parameter.

    Parameters
    ----------
    weights : dict of name to array
    x : (B, T, F) array of float

    Returns
    -------
    z : (B, Z) array
    pullback : dz -> gradients by name
    """
    u = weights["encoder_u"]
    nothing = np.zeros((len(x), len(u)), u.dtype)
    states, gru_back = ops.gru(x, nothing, *gru_weights(weights, "encoder"))
    z, latent_back = ops.linear(states[:, -1], weights["latent_w"], weights["latent_b"])

    def pullback(dz: np.ndarray) -> Weights:
        d_states = np.zeros_like(states)
        d_states[:, -1], dw, db = latent_back(dz)
        _, _, *of_gru = gru_back(d_states)
        return {**_named("encoder", of_gru), "latent_w": dw, "latent_b": db}

    return z, pullback


def decode(weights: Weights, z: np.ndarray, frames: int) -> tuple[np.ndarray, DecodePullback]:
    """From z a clip, by a GRU that is fed its own frames; the last frame of the clip comes first.

        h_0 = z · W_state + b_state,   y_0 = 0
        h_k = gru_step(y_(k-1), h_(k-1)),   y_k = h_k · W_frame + b_frame      for k = 1, …, T
        x̂_t = y_(T+1-t)

    y_0 is zero, the mean pose; no frame of any source is ever an input. The last line is the
    reversal, here and nowhere else: everyone outside sees clips in the order of time.

    The frame y_k acts on the loss along two paths: it is compared with the source, and it is what
    step k + 1 is fed. The state h_k acts along two: through its frame y_k, and as the state that
    step k + 1 begins with. So, with dx̂ short for dL/dx̂ and from the last step to the first,

        dy_k = dx̂_(T+1-k) + (the dx that step k + 1's pullback returns; 0 after the last)
        dh_k = dy_k · W_frameᵀ + (the dh that step k + 1's pullback returns; 0 after the last)
        dx, dh, dW, dU, db, dc    from the pullback of step k at dh_k

    dx of step 1 is for y_0, which is constant, and goes nowhere; dh of step 1 is dh_0, and

        dz = dh_0 · W_stateᵀ

    Every step uses the same weights: their gradients are sums over the steps.

    Parameters
    ----------
    weights : dict of name to array
    z : (B, Z) array of float
    frames : int
        T, at least 1.

    Returns
    -------
    x_hat : (B, T, F) array
    pullback : dx_hat -> (dz, gradients by name)
    """
    frame_w, frame_b = weights["frame_w"], weights["frame_b"]
    h, state_back = ops.linear(z, weights["state_w"], weights["state_b"])
    y = np.zeros((len(z), len(frame_b)), h.dtype)
    emitted, step_backs, frame_backs = [], [], []
    for _ in range(frames):
        h, step_back = ops.gru_step(y, h, *gru_weights(weights, "decoder"))
        y, frame_back = ops.linear(h, frame_w, frame_b)
        emitted.append(y)
        step_backs.append(step_back)
        frame_backs.append(frame_back)
    x_hat = np.stack(emitted[::-1], axis=1)

    def pullback(dx_hat: np.ndarray) -> tuple[np.ndarray, Weights]:
        of_gru = [np.zeros_like(weight) for weight in gru_weights(weights, "decoder")]
        of_frame = [np.zeros_like(frame_w), np.zeros_like(frame_b)]
        dy_fed, dh = np.zeros_like(y), np.zeros_like(h)
        d_emitted = [dx_hat[:, t] for t in reversed(range(frames))]
        for k in reversed(range(frames)):
            dh_through_frame, *of_this_frame = frame_backs[k](d_emitted[k] + dy_fed)
            dy_fed, dh, *of_this_step = step_backs[k](dh + dh_through_frame)
            _add(of_frame, of_this_frame)
            _add(of_gru, of_this_step)
        dz, d_state_w, d_state_b = state_back(dh)
        return dz, {
            "state_w": d_state_w,
            "state_b": d_state_b,
            **_named("decoder", of_gru),
            "frame_w": of_frame[0],
            "frame_b": of_frame[1],
        }

    return x_hat, pullback


def loss_and_gradients(
    weights: Weights, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
) -> tuple[Losses, Weights]:
    """mean((x̂ - x)²) + λ · sliced_wasserstein(z, prior), and its derivatives.

    z acts along two paths, as what is decoded and as a point among the prior's, so its gradient is
    the sum of both.

    Parameters
    ----------
    weights : dict of name to array
    x : (B, T, F) array of float
        The clips that are read and to be reproduced.
    prior : (B, Z) array of float
        Draws of the prior.
    directions : (L, Z) array of float, rows of length 1
    weight : float
        λ.

    Returns
    -------
    losses : Losses
    gradients : dict of name to array, in the order of `weights`

    References
    ----------
    jang2018, "Sequential Auto-Encoders with Wasserstein Regularizer".
    """
    z, encode_back = encode(weights, x)
    x_hat, decode_back = decode(weights, z, x.shape[1])
    reconstruction, error_back = ops.mean_squared_error(x_hat, x)
    discrepancy, prior_back = ops.sliced_wasserstein(z, prior, directions)
    total = reconstruction + weight * discrepancy

    dz, of_decoder = decode_back(error_back())
    of_encoder = encode_back(dz + prior_back(weight))
    losses = Losses(float(total), float(reconstruction), float(discrepancy))
    return losses, {**of_encoder, **of_decoder}


def _named(gru: str, gradients: list[np.ndarray]) -> Weights:
    """dW, dU, db and dc of one of the two, by name."""
    return {f"{gru}_{letter}": each for letter, each in zip("wubc", gradients, strict=True)}


def _add(totals: list[np.ndarray], terms: list[np.ndarray]) -> None:
    for total, term in zip(totals, terms, strict=True):
        total += term
