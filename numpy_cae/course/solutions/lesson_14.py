"""The solutions of lesson 14, beyond the papers."""

import numpy as np


def bones_off(q, lengths, parents):
    """mean (|bone| - length)², and its pullback."""
    ends = [joint for joint, parent in enumerate(parents) if parent != -1]
    starts = [parents[joint] for joint in ends]
    bones = q[:, ends] - q[:, starts]
    measured = np.linalg.norm(bones, axis=-1, keepdims=True)
    gap = measured - lengths[ends][:, None]

    def pullback(dloss=1.0):
        d_bones = dloss * 2 * gap / gap.size * bones / measured
        dq = np.zeros_like(q)
        for n, (end, start) in enumerate(zip(ends, starts, strict=True)):
            dq[:, end] += d_bones[:, n]
            dq[:, start] -= d_bones[:, n]
        return dq

    return np.mean(gap**2), pullback


def path_energy(path):
    """N Σ |X_{i+1} - X_i|², and its pullback."""
    steps = np.diff(path, axis=0)

    def pullback(dloss=1.0):
        d = np.zeros_like(path)
        d[1:] += 2 * dloss * len(steps) * steps
        d[:-1] -= 2 * dloss * len(steps) * steps
        return d

    return len(steps) * np.sum(steps**2), pullback


def observed_error(x_hat, x, known):
    """mean (x̂ - x)² over the known values, and its pullback."""
    difference = np.where(known, x_hat - x, 0.0)
    count = known.sum()

    def pullback(dloss=1.0):
        return 2 * dloss / count * difference

    return np.sum(difference**2) / count, pullback
