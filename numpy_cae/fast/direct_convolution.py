"""X * W and Z * W̃ with one W, as their definition computes them, and the derivatives of both.

`ops.conv1d` unfolds: the K frames that a frame of the result reads, side by side, are a row x̃ of
K · C numbers, and W is a matrix (K · C, D). The decoder and the pullback for x are the adjoint: the
K parts of a row are added to the frames that they were read from ("fold").

    encoder     y = x̃ W                 its pullback    dx = fold(dy Wᵀ)
    decoder     x̂ = fold(z Wᵀ)          its pullback    dz = d̃x̂ W
    dW = x̃ᵀ dy + d̃x̂ᵀ z

One window is faster so than by blocks (`spectral_convolution`) in a step of training, and in the
layer with the most filters otherwise: ŵ has several times as many numbers as W, and reading them
takes longer than the arithmetic that they save.

**Even unpooling** makes pairs of equal frames. The rows of a pair of frames are added up before the
product with W (after the product with Wᵀ), which is then computed once for both.
"""

import numpy as np

from numpy_cae.fast.layer_sizes import LayerSizes
from numpy_cae.fast.thread_team import Part
from numpy_cae.ops.convolution import unfold


class DirectConvolution:
    """One layer's W in the encoder and in the decoder, for one window: B is 1.

    Attributes
    ----------
    w : (K, C, D) array
        W; the caller sets it.
    x, z, error, d_convolved : arrays
        As those of `SpectralConvolution`.
    """

    def __init__(self, sizes: LayerSizes):
        self.sizes = sizes
        frames = sizes.frames
        self._inside = slice(sizes.taps // 2, sizes.taps // 2 + frames)
        self._padded_x = np.zeros((frames + sizes.taps - 1, 1, sizes.channels), sizes.dtype)
        self._padded_error = np.zeros_like(self._padded_x)
        self.x = self._padded_x[self._inside]
        self.error = self._padded_error[self._inside]
        self._dy_and_z = np.zeros((frames + frames // sizes.rate, 1, sizes.filters), sizes.dtype)
        self.d_convolved = self._dy_and_z[:frames]
        self.z = self._dy_and_z[frames:]
        self.w = np.zeros((sizes.taps, sizes.channels, sizes.filters), sizes.dtype)

    def convolve(self) -> np.ndarray:
        """x̃ W of `x`: (T, 1, D)."""
        self._x_rows = unfold(self._padded_x.swapaxes(0, 1), self.sizes.taps)
        return (self._x_rows @ self._matrix)[:, None]

    def convolve_transposed(self) -> np.ndarray:
        """fold(z Wᵀ) of `z`: (T, 1, C)."""
        return self._fold(self.z, self.sizes.rate)

    def convolve_transposed_pullback(self) -> np.ndarray:
        """dz = d̃x̂ W of `error`: as `z`."""
        padded = self._padded_error
        if self.sizes.rate == 2:
            padded = padded.copy()
            padded[:-1] += padded[1:]
        self._error_rows = unfold(padded.swapaxes(0, 1), self.sizes.taps)[:: self.sizes.rate]
        return (self._error_rows @ self._matrix)[:, None]

    def convolve_pullback(self, with_dx: bool = True) -> np.ndarray | None:
        """dx = fold(dy Wᵀ) of `d_convolved`: (T, 1, C); nothing without dx."""
        return self._fold(self.d_convolved, 1) if with_dx else None

    def gradient(self, dw: np.ndarray, part: Part) -> None:
        """Compute dw, all of it in one thread."""
        rows = np.concatenate([self._x_rows, self._error_rows])
        np.matmul(rows.T, self._dy_and_z[:, 0], out=dw.reshape(-1, dw.shape[2]))

    @property
    def _matrix(self) -> np.ndarray:
        return self.w.reshape(-1, self.sizes.filters)

    def _fold(self, rows: np.ndarray, step: int) -> np.ndarray:
        """The adjoint of unfolding, for every `step`-th frame and the one after it, and of W."""
        parts = (rows[:, 0] @ self._matrix.T).reshape(len(rows), self.sizes.taps, 1, -1)
        out = np.zeros_like(self._padded_x)
        for k in range(self.sizes.taps):
            out[k : k + len(rows) * step : step] += parts[:, k]
        if step == 2:
            out[1:] += out[:-1]
        return out[self._inside]
