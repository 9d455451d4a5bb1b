"""The calculus: one operation, one function, one pullback.

Every function returns its value and its pullback. The pullback takes the gradient of a loss L
with respect to the value and returns the gradient of L with respect to each differentiated
argument, in the order of the arguments: a bare array for one, a tuple for several. No state.
"""

from numpy_cae.ops.activations import arctanh, tanh
from numpy_cae.ops.convolution import conv1d, transpose_filters
from numpy_cae.ops.losses import mean_absolute, mean_squared_error
from numpy_cae.ops.pooling import max_pool, unpool_even, unpool_random

__all__ = [
    "arctanh",
    "conv1d",
    "max_pool",
    "mean_absolute",
    "mean_squared_error",
    "tanh",
    "transpose_filters",
    "unpool_even",
    "unpool_random",
]
