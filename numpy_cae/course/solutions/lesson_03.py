"""The solutions of lesson 03, convolution by hand."""

import numpy as np


def conv1d_by_loops(x, w, b):
    """y[t] = Σ_k x[t + k - K//2] w[k] + b, one number at a time."""
    (batch, frames, channels), (taps, _, filters) = x.shape, w.shape
    y = np.zeros((batch, frames, filters))
    for i in range(batch):
        for t in range(frames):
            for d in range(filters):
                y[i, t, d] = b[d]
                for k in range(taps):
                    there = t + k - taps // 2
                    if 0 <= there < frames:
                        for c in range(channels):
                            y[i, t, d] += x[i, there, c] * w[k, c, d]
    return y


def unfold(x, taps):
    """Row t holds the frames that a filter reads at t, (B, T, K * C)."""
    batch, frames, channels = x.shape
    padded = np.zeros((batch, frames + taps - 1, channels), dtype=x.dtype)
    padded[:, taps // 2 : taps // 2 + frames] = x
    return np.concatenate([padded[:, k : k + frames] for k in range(taps)], axis=-1)
