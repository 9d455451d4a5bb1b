"""The solutions of lesson 07b, better steps."""

import numpy as np


def momentum_step(parameter, velocity, gradient, rate, momentum):
    """v ← μ v - η · dL/dθ,   θ ← θ + v   (Polyak 1964)."""
    velocity = momentum * velocity - rate * gradient
    return parameter + velocity, velocity


def adam_step(parameter, mean, square, gradient, rate, step):
    """Adam with β₁ = 0.9, β₂ = 0.99 (Kingma and Ba 2015, algorithm 1); steps count from 1."""
    mean = 0.9 * mean + 0.1 * gradient
    square = 0.99 * square + 0.01 * gradient**2
    unbiased_mean = mean / (1 - 0.9**step)
    unbiased_square = square / (1 - 0.99**step)
    parameter = parameter - rate * unbiased_mean / (np.sqrt(unbiased_square) + 1e-8)
    return parameter, mean, square


def one_cycle(peak, share):
    """Half a cosine up from peak / 25 in 30% of the steps, then half a cosine down to 0."""
    if share < 0.3:
        return peak / 25 + (peak - peak / 25) * (1 - np.cos(np.pi * share / 0.3)) / 2
    return peak * (1 + np.cos(np.pi * (share - 0.3) / 0.7)) / 2
