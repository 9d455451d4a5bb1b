"""The activation functions: tanh and its clipped inverse, and the sigmoid.

tanh maps the hidden units into [-1, 1], the parametrisation of the manifold (holden2015, section
3); the decoder inverts it with arctanh (equation 2). arctanh is infinite at ±1, and the output of
a decoding layer is unbounded, so our arctanh takes a bound to which it clips its argument (see
docs/lab_book/equations.md). The gates of jang2018's recurrent networks are sigmoids.
"""

import numpy as np

from numpy_cae.ops.shapes import Pullback, require_shape


def tanh(x: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """y = tanh(x), elementwise.   dL/dx = (1 - y²) · dL/dy

    The pullback needs only y: where a unit saturates (|y| near 1), 1 - y² is near 0 and the unit
    hardly learns.

    Parameters
    ----------
    x : array of float, any shape

    Returns
    -------
    y : array of the same shape
    pullback : dy -> dx

    See Also
    --------
    arctanh : Its inverse, which the decoder uses.

    References
    ----------
    holden2015, section 5, equation 1.

    Examples
    --------
    >>> y, pullback = tanh(np.array([0.0, 3.0]))
    >>> pullback(np.ones(2)).round(3)  # the saturated unit gets 1% of the gradient
    array([1.  , 0.01])
    """
    y = np.tanh(x)

    def pullback(dy: np.ndarray) -> np.ndarray:
        require_shape("dy", dy, y.shape)
        return dy * (1 - y * y)

    return y, pullback


def arctanh(y: np.ndarray, bound: float) -> tuple[np.ndarray, Pullback]:
    """x = arctanh(clip(y, -bound, bound)), elementwise.

        dL/dy = dL/dx / (1 - y²) where |y| <= bound, else 0

    arctanh(±1) is infinite, so y is clipped first. Beyond the bound the clipped value does not
    depend on y, so the gradient there is 0.

    Parameters
    ----------
    y : array of float, any shape
    bound : float
        Between 0 and 1, both excluded.

    Returns
    -------
    x : array of the same shape
        Between -arctanh(bound) and arctanh(bound).
    pullback : dx -> dy

    Raises
    ------
    ValueError
        If the bound is not between 0 and 1.

    See Also
    --------
    tanh : Its inverse.

    References
    ----------
    holden2015, section 5, the tanh⁻¹ of equation 2.

    Examples
    --------
    >>> x, pullback = arctanh(np.array([0.5, 2.0]), bound=0.9)
    >>> x.round(3), pullback(np.ones(2)).round(3)
    (array([0.549, 1.472]), array([1.333, 0.   ]))
    """
    if not 0 < bound < 1:
        raise ValueError(f"bound is {bound}, expected a number between 0 and 1, both excluded")
    bound = float(bound)  # a number of NumPy would turn float32 into float64
    clipped = np.clip(y, -bound, bound)
    inside = np.abs(y) <= bound
    x = np.arctanh(clipped)

    def pullback(dx: np.ndarray) -> np.ndarray:
        require_shape("dx", dx, x.shape)
        return dx * inside / (1 - clipped * clipped)

    return x, pullback


def sigmoid(x: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """y = 1 / (1 + exp(-x)), elementwise.   dL/dx = y (1 - y) · dL/dy

    A gate multiplies a value by a share from 0 to 1. The slope y (1 - y) is near 0 at both ends,
    so a gate that is open or closed hardly learns.

    Parameters
    ----------
    x : array of float, any shape

    Returns
    -------
    y : array of the same shape
    pullback : dy -> dx

    References
    ----------
    The gates of the GRU; Cho et al., "Learning Phrase Representations using RNN Encoder-Decoder
    for Statistical Machine Translation", EMNLP 2014.

    Examples
    --------
    >>> y, pullback = sigmoid(np.array([-2.0, 0.0, 2.0]))
    >>> y.round(3), pullback(np.ones(3)).round(3)
    (array([0.119, 0.5  , 0.881]), array([0.105, 0.25 , 0.105]))
    """
    e = np.exp(-np.abs(x))  # at most 1, so it cannot overflow
    y = np.where(x < 0, e, 1) / (1 + e)

    def pullback(dy: np.ndarray) -> np.ndarray:
        require_shape("dy", dy, y.shape)
        return dy * y * (1 - y)

    return y, pullback
