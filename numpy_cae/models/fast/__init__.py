"""The autoencoder at speed: the same numbers as `numpy_cae.models.composed`, another order of work.

Read `numpy_cae.ops.fast` first (the convolution by blocks), then here, from the inside out:

tied_convolution   X * W and Z * W̃ with one spectrum of W, and their derivatives
layer              equations 1 and 2 around it, in buffers that are allocated once
network            equation 3 over all layers
team               two threads that share the work, and what they agree on
blas               how many threads a matrix product uses
"""

from numpy_cae.models.fast.network import FastNetwork

__all__ = ["FastNetwork"]
