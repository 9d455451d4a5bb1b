"""Equations 1 and 2 in fixed buffers: one layer, one thread's windows, time as the leading axis.

The mathematics of `numpy_cae.models.conv_layer`, line for line, with three differences: every array
is allocated once; the biases are added after pooling (max(u + b, v + b) = max(u, v) + b); and even
unpooling is part of the convolution below it, so that b is subtracted once for each pair of equal
frames.
"""

import numpy as np

from numpy_cae.fast.tied_convolution import TiedConvolution, buffer


class FastLayer:
    """One layer in both directions, with both pullbacks.

    Parameters
    ----------
    convolution : TiedConvolution
    bound : float
        Where arctanh clips.
    y : (T/2, B·D) array
        Receives what the layer encodes: the input of the layer above.
    """

    def __init__(self, convolution: TiedConvolution, bound: float, y: np.ndarray):
        self.convolution, self.bound, self.y = convolution, bound, y
        frames, width = y.shape
        self._clipped, self._slope, self._scratch = (
            buffer(frames, width, y.dtype) for _ in range(3)
        )
        self._earlier_won, self._inside = (np.empty(y.shape, bool) for _ in range(2))
        self._first: np.ndarray | None = None

    def encode(self, b: np.ndarray) -> None:
        """y = tanh(max(pairs of x * W) + b), equation 1."""
        convolved, y = self.convolution.convolve(), self.y
        earlier, later = convolved[0::2], convolved[1::2]
        np.greater_equal(earlier, later, out=self._earlier_won)
        np.maximum(earlier, later, out=y)
        _for_each_window(y, b)[...] += b
        np.tanh(y, out=y)

    def decode(self, y: np.ndarray, b: np.ndarray, first: np.ndarray | None) -> np.ndarray:
        """(Ψ†(tanh⁻¹(y)) - b) * W̃, equation 2: (T, B·C)."""
        np.clip(y, -self.bound, self.bound, out=self._clipped)
        np.equal(y, self._clipped, out=self._inside)
        activated = np.arctanh(self._clipped, out=self._scratch)
        z = self.convolution.z
        self._first = first
        if first is None:  # one row of z is both frames of a pair
            np.multiply(activated, 0.5, out=z)
        else:
            np.multiply(activated, first, out=z[0::2])
            np.subtract(activated, z[0::2], out=z[1::2])
        _for_each_window(z, b)[...] -= b
        return self.convolution.convolve_transposed()

    def decode_pullback(self, db: np.ndarray, dy: np.ndarray) -> None:
        """From dx̂ in the convolution's `error` to dy; db gets the decoder's share."""
        dz, d_activated = self.convolution.convolve_transposed_pullback(), self._scratch
        if self._first is None:  # dz is the sum for both frames of a pair
            np.multiply(dz, 0.5, out=d_activated)
        else:
            earlier, later = dz[0::2], dz[1::2]
            np.subtract(earlier, later, out=d_activated)
            d_activated *= self._first
            d_activated += later
        np.negative(_for_each_window(dz, db).sum(axis=(0, 1)), out=db)
        # d arctanh = 1 / (1 - y²) inside the bound, 0 beyond
        np.multiply(self._clipped, self._clipped, out=self._slope)
        np.subtract(1, self._slope, out=self._slope)
        d_activated *= self._inside
        np.divide(d_activated, self._slope, out=dy)

    def encode_pullback(self, dy: np.ndarray, db: np.ndarray, with_dx: bool) -> np.ndarray | None:
        """From dy, which is overwritten, to dx if it is wanted; adds the encoder's share to db."""
        np.multiply(self.y, self.y, out=self._slope)
        np.subtract(1, self._slope, out=self._slope)
        dy *= self._slope
        db += _for_each_window(dy, db).sum(axis=(0, 1))
        d_convolved = self.convolution.d_convolved
        np.multiply(dy, self._earlier_won, out=d_convolved[0::2])
        np.subtract(dy, d_convolved[0::2], out=d_convolved[1::2])
        return self.convolution.convolve_pullback(with_dx)


def _for_each_window(rows: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(T, B·D) as (T, B, D), the same memory."""
    return rows.reshape(len(rows), -1, len(b))
