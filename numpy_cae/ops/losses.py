"""The two terms of equation 3, as means over elements.

The paper has norms, sums over elements; a mean keeps the learning rate independent of the window's
length, the number of features and the batch (docs/lab_book/equations.md). With N elements of X
and N_Y of Y, our α corresponds to the paper's times N_Y / N. A loss is a scalar, so its pullback
takes a number: 1 by default, the weight of the loss where it is one term of a sum.
"""

import numpy as np

from numpy_cae.ops.shapes import Pullback, require_shape


def mean_squared_error(x_hat: np.ndarray, x: np.ndarray) -> tuple[float, Pullback]:
    """L = mean((x_hat - x)²) over every element.   dL/dx_hat = 2 (x_hat - x) / N

    Parameters
    ----------
    x_hat : array of float, any shape
        The reconstruction.
    x : array of the same shape
        The target, which gets no gradient.

    Returns
    -------
    loss : float, in the dtype of the arrays
    pullback : dloss=1.0 -> dx_hat

    Raises
    ------
    ValueError
        If the shapes differ.

    References
    ----------
    holden2015, section 6, the first term of equation 3.
    """
    require_shape("x_hat", x_hat, np.shape(x))
    difference = x_hat - x
    loss = np.mean(difference * difference)

    def pullback(dloss: float = 1.0) -> np.ndarray:
        return (2 * float(dloss) / difference.size) * difference

    return loss, pullback


def mean_absolute(y: np.ndarray) -> tuple[float, Pullback]:
    """L = mean(|y|) over every element.   dL/dy = sign(y) / N, and 0 at y = 0

    Parameters
    ----------
    y : array of float, any shape

    Returns
    -------
    loss : float, in the dtype of the array
    pullback : dloss=1.0 -> dy

    References
    ----------
    holden2015, section 6, the sparsity term of equation 3.
    """
    loss = np.mean(np.abs(y))

    def pullback(dloss: float = 1.0) -> np.ndarray:
        return (float(dloss) / y.size) * np.sign(y)

    return loss, pullback
