"""The differentiable operations of both papers: one function each, returning value and pullback.

Every function returns its value and its pullback, the convention of `jax.vjp`. The pullback takes
the gradient of a loss L with respect to the value and returns the gradient of L with respect to
each differentiated argument, in the order of the arguments: a bare array for one, a tuple for
several. Nothing has state. This package imports nothing of the project.
"""

from numpy_cae.ops.activations import arctanh, sigmoid, tanh
from numpy_cae.ops.convolution import conv1d, transpose_filters
from numpy_cae.ops.dense import linear
from numpy_cae.ops.losses import mean_absolute, mean_squared_error
from numpy_cae.ops.pooling import max_pool, unpool_even, unpool_random
from numpy_cae.ops.recurrent import gru, gru_step
from numpy_cae.ops.wasserstein import sliced_wasserstein

__all__ = [
    "arctanh",
    "conv1d",
    "gru",
    "gru_step",
    "linear",
    "max_pool",
    "mean_absolute",
    "mean_squared_error",
    "sigmoid",
    "sliced_wasserstein",
    "tanh",
    "transpose_filters",
    "unpool_even",
    "unpool_random",
]
