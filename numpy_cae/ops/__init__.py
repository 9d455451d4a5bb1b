"""The calculus: one operation, one function, one pullback.

Every function returns its value and its pullback. The pullback takes the gradient of a loss L
with respect to the value and returns the gradient of L with respect to each differentiated
argument, in the order of the arguments: a bare array for one, a tuple for several. No state.
"""

from numpy_cae.ops.activations import arctanh, sigmoid, tanh
from numpy_cae.ops.convolution import conv1d, transpose_filters
from numpy_cae.ops.gru import gru, gru_step
from numpy_cae.ops.linear import linear
from numpy_cae.ops.losses import mean_absolute, mean_squared_error
from numpy_cae.ops.pooling import average_pool, max_pool, unpool_even, unpool_random
from numpy_cae.ops.wasserstein import sliced_wasserstein

__all__ = [
    "arctanh",
    "average_pool",
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
