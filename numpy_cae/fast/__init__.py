"""The computations of `numpy_cae.models`, faster, with NumPy alone.

`accelerate(model)` returns an object with the methods of the model that computes the same numbers
(up to rounding) on the model's own weights. Each technique has a readable counterpart in
`numpy_cae.ops` or `numpy_cae.models`, and tests compare the two.

Reading order, each file using those before it:

blocks                       a convolution of a block of frames as y = C ((A x) ∘ (G w))
products                     matrix products in pieces that BLAS multiplies at full speed, and the
                             memory of their arrays
thread_team                  Python threads that share the windows, each with one BLAS thread
layer_convolution            the convolutions with W in the encoder and W̃ in the decoder:
                             `SpectralConvolution` by blocks, with one transform of the filters, and
                             `DirectConvolution` for one window, by the definition's form
workspace                    `FastLayer`, a layer with its pullbacks in fixed buffers; `Worker`, one
                             thread's windows through all layers and back; `Workspace`, the threads
                             together
fast_conv_autoencoder        `ConvAutoencoder` with these
fast_sequential_autoencoder  `SequentialAutoencoder` by one recurrence without frames
"""

from typing import Any

from numpy_cae.fast.fast_conv_autoencoder import FastConvAutoencoder
from numpy_cae.fast.fast_sequential_autoencoder import FastSequentialAutoencoder
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder

__all__ = [
    "FastConvAutoencoder",
    "FastSequentialAutoencoder",
    "accelerate",
    "with_engine",
]


def accelerate(model: Any, threads: int | None = None) -> Any:
    """The same model, computed faster on the same weight arrays.

    The weights may be changed between two calls, in place or by assigning another array to
    `layers[k].w` or `weights[name]`, of the model or of the accelerated model.

    Parameters
    ----------
    model : ConvAutoencoder or SequentialAutoencoder
        Any other object, such as an accelerated model or a subclass with another loss, is returned
        unchanged.
    threads : int, optional
        By default as many as BLAS would use. The last digits of a result depend on this number, and
        on nothing else.

    Returns
    -------
    FastConvAutoencoder or FastSequentialAutoencoder
        Subclasses of the model's class.

    Examples
    --------
    >>> import numpy as np
    >>> model = ConvAutoencoder(features=5, filters=(6, 7), taps=3)
    >>> x = np.sin(np.arange(160, dtype=np.float32)).reshape(1, 32, 5)
    >>> fast = accelerate(model)
    >>> fast.layers is model.layers, np.allclose(fast.project(x), model.project(x), atol=1e-5)
    (True, True)
    """
    if type(model) is ConvAutoencoder:
        return FastConvAutoencoder(model, threads)
    if type(model) is SequentialAutoencoder:
        return FastSequentialAutoencoder(model, threads)
    return model


def with_engine(model: Any, engine: str) -> Any:
    """The model, accelerated if `engine` is "fast", plain if it is "ops"."""
    if engine not in ("fast", "ops"):
        raise ValueError(f"engine is {engine!r}, expected 'fast' or 'ops'")
    return accelerate(model) if engine == "fast" else model
