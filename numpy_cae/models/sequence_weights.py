"""The weights of jang2018's network by name: which there are, their shapes, their first values.

    encoder_w, encoder_u, encoder_b, encoder_c    the GRU that reads a clip
    latent_w, latent_b                            its last state to z
    state_w, state_b                              z to the decoder's first state
    decoder_w, decoder_u, decoder_b, decoder_c    the GRU that writes a clip
    frame_w, frame_b                              each of its states to a frame

A GRU's four are the arguments of `ops.gru_step`, a map's two those of `ops.linear`.
"""

from __future__ import annotations

import numpy as np

Weights = dict[str, np.ndarray]

GATES = 3
"""Reset, update and new, side by side in the columns of a GRU's weights."""


def weight_shapes(features: int, hidden: int, latent: int) -> dict[str, tuple[int, ...]]:
    """The shape of every weight by name, in the order in which they are kept."""
    gates = GATES * hidden
    of_a_gru = {"w": (features, gates), "u": (hidden, gates), "b": (gates,), "c": (gates,)}
    return {
        **{f"encoder_{letter}": shape for letter, shape in of_a_gru.items()},
        "latent_w": (hidden, latent),
        "latent_b": (latent,),
        "state_w": (latent, hidden),
        "state_b": (hidden,),
        **{f"decoder_{letter}": shape for letter, shape in of_a_gru.items()},
        "frame_w": (hidden, features),
        "frame_b": (features,),
    }


def initial_weights(
    features: int, hidden: int, latent: int, rng: np.random.Generator, dtype: np.dtype | type
) -> Weights:
    """Small random matrices by fan-in and fan-out, recurrent ones orthogonal, biases zero but one.

    As in the first network, W is uniform within ±√(6 / (fan_in + fan_out)). Each gate is a map of
    its own, so its fan-out is H and not the 3H columns that the three share. Two choices let a
    gradient live through fifty steps: each gate's recurrent matrix is orthogonal (Saxe et al.,
    2014), and the update gate's bias is 1, so that h' = (1 - z) ∘ n + z ∘ h begins by remembering.
    """
    weights = {}
    for name, shape in weight_shapes(features, hidden, latent).items():
        if len(shape) == 1:
            weights[name] = np.zeros(shape, dtype)
            if name in ("encoder_b", "decoder_b"):
                weights[name][hidden : 2 * hidden] = 1
            continue
        fan_in, fan_out = shape
        if name in ("encoder_u", "decoder_u"):
            gates = [np.linalg.qr(rng.standard_normal((hidden, hidden)))[0] for _ in range(GATES)]
            weights[name] = np.hstack(gates).astype(dtype)
            continue
        if name.startswith(("encoder", "decoder")):
            fan_out //= GATES
        width = np.sqrt(6 / (fan_in + fan_out))
        weights[name] = rng.uniform(-width, width, size=shape).astype(dtype)
    return weights


def gru_weights(weights: Weights, name: str) -> tuple[np.ndarray, ...]:
    """W, U, b and c of the "encoder" or the "decoder", as `ops.gru_step` takes them."""
    return tuple(weights[f"{name}_{letter}"] for letter in "wubc")
