"""The computations of `numpy_cae.models`, faster, with NumPy alone.

`accelerate(model)` returns an object with the methods of the model that computes the same numbers
(up to rounding) on the model's own weights. Each technique has a readable counterpart in
`numpy_cae.ops` or `numpy_cae.models`, and tests compare the two.

Reading order, each file using those before it:

blocks                       a convolution of a block of frames as y = C ((A x) ∘ (G w))
convolution                  `conv1d` by blocks, with its pullback: the whole idea in one function
aligned                      arrays that start at a cache line
products                     matrix products in pieces that BLAS multiplies at full speed
tied_convolution             W in the encoder and W̃ in the decoder with one transform of the filters
fast_layer                   equations 1 and 2 with their pullbacks in fixed buffers
blas, thread_team            Python threads that share the windows, each with one BLAS thread
workspace                    the buffers of all threads, and what they share
fast_conv_autoencoder        `ConvAutoencoder` with these
recurrence                   one GRU over a clip, without temporary arrays
gru_matrices                 its weights, rearranged into one matrix per product
sequence_worker              one thread's clips through both GRUs and back
fast_sequential_autoencoder  `SequentialAutoencoder` with these
"""

from typing import Any

from numpy_cae.fast.convolution import conv1d
from numpy_cae.fast.fast_conv_autoencoder import FastConvAutoencoder
from numpy_cae.fast.fast_sequential_autoencoder import FastSequentialAutoencoder
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder

__all__ = ["FastConvAutoencoder", "FastSequentialAutoencoder", "accelerate", "conv1d"]


def accelerate(model: Any, threads: int | None = None) -> Any:
    """The same model, computed faster on the same weight arrays.

    The weights may be changed between two calls in any manner, in place or by assigning another
    array to `layers[k].w` or `weights[name]`, through the model or through what is returned.

    Parameters
    ----------
    model : ConvAutoencoder or SequentialAutoencoder
        Any other object (a model that is accelerated already, a subclass that computes something
        else) is returned as it is.
    threads : int, optional
        As many as BLAS would use where None. A result depends on this number in its last digits,
        and on nothing else.

    Returns
    -------
    FastConvAutoencoder or FastSequentialAutoencoder
        Subclasses of the model's class.
    """
    if type(model) is ConvAutoencoder:
        return FastConvAutoencoder(model, threads)
    if type(model) is SequentialAutoencoder:
        return FastSequentialAutoencoder(model, threads)
    return model
