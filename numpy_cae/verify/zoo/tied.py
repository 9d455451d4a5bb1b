"""Wrong tied layers. The right one is `numpy_cae.verify.tied.tied_layer`."""

from __future__ import annotations

import numpy as np

from numpy_cae.ops import conv1d, tanh, transpose_filters
from numpy_cae.verify.zoo.bug import bug


def forward(x, w, b):
    """x -> tanh(x * W + b) -> (y - b) * W̃, and the pullbacks on the way."""
    a, of_encoding = conv1d(x, w, b)
    y, of_tanh = tanh(a)
    w_tilde, of_transpose = transpose_filters(w)
    x_hat, of_decoding = conv1d(y - b, w_tilde, np.zeros(x.shape[-1], x.dtype))
    return x_hat, of_encoding, of_tanh, of_transpose, of_decoding


@bug("tied_layer", caught_by="gradient for w")
def tied_weights_counted_once(x, w, b):
    """The tied filters act twice but are counted once: what decoding adds is missing."""
    x_hat, of_encoding, of_tanh, _, of_decoding = forward(x, w, b)

    def pullback(dx_hat):
        dy, _, _ = of_decoding(dx_hat)
        dx, dw, db = of_encoding(of_tanh(dy))
        return dx, dw, db - dy.sum(axis=(0, 1))

    return x_hat, pullback


@bug("tied_layer", caught_by="gradient for w")
def tied_weights_of_decoder_only(x, w, b):
    """The tied filters are counted once: what encoding adds is missing."""
    x_hat, of_encoding, of_tanh, of_transpose, of_decoding = forward(x, w, b)

    def pullback(dx_hat):
        dy, dw_tilde, _ = of_decoding(dx_hat)
        dx, _, db = of_encoding(of_tanh(dy))
        return dx, of_transpose(dw_tilde), db - dy.sum(axis=(0, 1))

    return x_hat, pullback


@bug("tied_layer", caught_by="gradient for w")
def tied_weights_not_flipped_back(x, w, b):
    """The decoder's share is exchanged back but not flipped in time before it is added."""
    x_hat, of_encoding, of_tanh, _, of_decoding = forward(x, w, b)

    def pullback(dx_hat):
        dy, dw_tilde, _ = of_decoding(dx_hat)
        dx, dw, db = of_encoding(of_tanh(dy))
        return dx, dw + dw_tilde.transpose(0, 2, 1), db - dy.sum(axis=(0, 1))

    return x_hat, pullback


@bug("tied_layer", caught_by="gradient for b")
def tied_bias_counted_once(x, w, b):
    """The bias is added and taken off again, but only the adding is differentiated."""
    x_hat, of_encoding, of_tanh, of_transpose, of_decoding = forward(x, w, b)

    def pullback(dx_hat):
        dy, dw_tilde, _ = of_decoding(dx_hat)
        dx, dw, db = of_encoding(of_tanh(dy))
        return dx, dw + of_transpose(dw_tilde), db

    return x_hat, pullback


@bug("tied_layer", caught_by="gradient for b")
def tied_bias_sign_lost(x, w, b):
    """The gradient of the bias that is taken off is added: the sign."""
    x_hat, of_encoding, of_tanh, of_transpose, of_decoding = forward(x, w, b)

    def pullback(dx_hat):
        dy, dw_tilde, _ = of_decoding(dx_hat)
        dx, dw, db = of_encoding(of_tanh(dy))
        return dx, dw + of_transpose(dw_tilde), db + dy.sum(axis=(0, 1))

    return x_hat, pullback
