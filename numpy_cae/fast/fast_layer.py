"""Equations 1 and 2 in fixed buffers: one layer, one thread's windows, time as the leading axis.

The mathematics of `numpy_cae.models.conv_layer`, line for line, with three differences: every array
is allocated once; the biases are added after pooling (max(u + b, v + b) = max(u, v) + b); and even
unpooling is part of the convolution below it, so that b is subtracted once for each pair of equal
frames. In float32 tanh⁻¹ is rounded to 1e-7 of 1, not of the result.
"""

import numpy as np

from numpy_cae.fast.layer_convolution import DirectConvolution, SpectralConvolution
from numpy_cae.fast.products import zeros

Convolution = SpectralConvolution | DirectConvolution


class FastLayer:
    """One layer in both directions, with both pullbacks.

    Parameters
    ----------
    convolution : Convolution
    bound : float
        Where arctanh clips.
    y : (T/2, B, D) array
        Receives what the layer encodes: the input of the layer above.

    Attributes
    ----------
    b : (D,) array
        The bias; the caller sets it.
    db : (D,) array
        Its gradient for the windows of this thread.
    """

    def __init__(self, convolution: Convolution, bound: float, y: np.ndarray):
        self.convolution = convolution
        self.bound = bound
        self.y = y
        self.b = np.zeros(y.shape[2], y.dtype)
        self.db = np.zeros_like(self.b)
        self._clipped = zeros(y.shape, y.dtype)
        self._scratch = zeros(y.shape, y.dtype)
        self._earlier_won = np.empty(y.shape, bool)
        self._inside = np.empty(y.shape, bool)
        self._first: np.ndarray | None = None

    def encode(self) -> None:
        """y = tanh(max(pairs of x * W) + b), equation 1."""
        convolved = self.convolution.convolve()
        earlier = convolved[0::2]
        later = convolved[1::2]
        np.greater_equal(earlier, later, out=self._earlier_won)
        y = np.maximum(earlier, later, out=self.y)
        y += self.b
        np.tanh(y, out=y)

    def decode(self, y: np.ndarray, first: np.ndarray | None) -> np.ndarray:
        """(Ψ†(tanh⁻¹(y)) - b) * W̃, equation 2: (T, B, C).

        `first`, (B, T/2, D), is the mask of `ops.unpool_random`.
        """
        np.clip(y, -self.bound, self.bound, out=self._clipped)
        np.equal(y, self._clipped, out=self._inside)
        z = self.convolution.z
        # tanh⁻¹(y) = log((1 + y) / (1 - y)) / 2: np.arctanh takes ten times as long.
        activated = np.add(1, self._clipped, out=self._scratch)
        activated /= np.subtract(1, self._clipped, out=z if first is None else z[0::2])
        np.log(activated, out=activated)
        activated *= 0.5
        if first is None:  # one row of z is both frames of a pair
            self._first = None
            np.multiply(activated, 0.5, out=z)
        else:
            self._first = np.ascontiguousarray(first.transpose(1, 0, 2))
            np.multiply(activated, self._first, out=z[0::2])
            np.subtract(activated, z[0::2], out=z[1::2])
        z -= self.b
        return self.convolution.convolve_transposed()

    def decode_pullback(self, dy: np.ndarray) -> None:
        """From dx̂ in the convolution's `error` to dy; db gets the decoder's share."""
        dz = self.convolution.convolve_transposed_pullback()
        d_activated = self._scratch
        if self._first is None:  # dz is the sum for both frames of a pair
            np.multiply(dz, 0.5, out=d_activated)
        else:
            np.subtract(dz[0::2], dz[1::2], out=d_activated)
            d_activated *= self._first
            d_activated += dz[1::2]
        np.negative(dz.sum(axis=(0, 1)), out=self.db)
        # d arctanh = 1 / (1 - y²) inside the bound, 0 beyond
        slope = np.multiply(self._clipped, self._clipped, out=self._clipped)
        np.subtract(1, slope, out=slope)
        d_activated *= self._inside
        np.divide(d_activated, slope, out=dy)

    def encode_pullback(self, dy: np.ndarray, with_dx: bool) -> np.ndarray | None:
        """From dy, which is overwritten, to dx if it is wanted; adds the encoder's share to db."""
        slope = np.multiply(self.y, self.y, out=self._scratch)
        np.subtract(1, slope, out=slope)
        dy *= slope
        self.db += dy.sum(axis=(0, 1))
        d_convolved = self.convolution.d_convolved
        np.multiply(dy, self._earlier_won, out=d_convolved[0::2])
        np.subtract(dy, d_convolved[0::2], out=d_convolved[1::2])
        return self.convolution.convolve_pullback(with_dx)
