"""The differentiable operations of both papers: one function each, returning value and pullback.

Every function returns its value and its pullback, the convention of `jax.vjp`. The pullback takes
the gradient of a loss L with respect to the value and returns the gradient of L with respect to
each differentiated argument, in the order of the arguments: a bare array for one, a tuple for
several. Nothing has state. This package imports nothing of the project.
"""

from numpy_cae.ops.activations import arctanh as arctanh
from numpy_cae.ops.activations import sigmoid as sigmoid
from numpy_cae.ops.activations import tanh as tanh
from numpy_cae.ops.convolution import conv1d as conv1d
from numpy_cae.ops.convolution import transpose_filters as transpose_filters
from numpy_cae.ops.gru import gru as gru
from numpy_cae.ops.gru import gru_step as gru_step
from numpy_cae.ops.linear import linear as linear
from numpy_cae.ops.losses import mean_absolute as mean_absolute
from numpy_cae.ops.losses import mean_squared_error as mean_squared_error
from numpy_cae.ops.pooling import max_pool as max_pool
from numpy_cae.ops.pooling import unpool_even as unpool_even
from numpy_cae.ops.pooling import unpool_random as unpool_random
from numpy_cae.ops.wasserstein import sliced_wasserstein as sliced_wasserstein

__all__ = [name for name in dir() if not name.startswith("_")]
