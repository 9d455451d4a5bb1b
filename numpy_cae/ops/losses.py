"""The two terms of equation 3, as means over elements.

The paper has norms, sums over elements; a mean keeps the learning rate independent of the window's
length, the number of features and the batch. With sums, training diverges at the paper's rate of
0.5 in the fourth step. The paper's α is our α multiplied by N / N_Y, where N is the number of
elements of the input X and N_Y that of the hidden units Y: our 0.01 is 0.0197 in the paper's sums
for layer 1, whose input has 160 x 63 elements and whose output 80 x 64, and 0.01 for layers 2 and
3, where both are equal (measured: docs/lab_book/equations.md). A loss is a scalar, so its pullback
takes a number: 1 by default, or the weight of the loss if the loss is one term of a sum.
"""

import numpy as np

from numpy_cae.ops.shapes import Pullback, require_shape


def mean_squared_error(x_hat: np.ndarray, x: np.ndarray) -> tuple[float, Pullback]:
    """L = mean((x_hat - x)²) over every element.   dL/dx_hat = 2 (x_hat - x) / N

    The gradient is proportional to the error: large errors are corrected first.

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

    Examples
    --------
    >>> loss, pullback = mean_squared_error(np.array([1.0, 5.0]), np.array([1.0, 3.0]))
    >>> float(loss), pullback()
    (2.0, array([0., 2.]))
    """
    require_shape("x_hat", x_hat, np.shape(x))
    difference = x_hat - x
    loss = np.mean(difference * difference)

    def pullback(dloss: float = 1.0) -> np.ndarray:
        return (2 * float(dloss) / difference.size) * difference

    return loss, pullback


def mean_absolute(y: np.ndarray) -> tuple[float, Pullback]:
    """L = mean(|y|) over every element.   dL/dy = sign(y) / N, and 0 at y = 0

    The gradient is as large for small values as for large ones, so small values reach 0: that makes
    the hidden units sparse. At 0 the slope jumps from -1/N to 1/N; 0 keeps a unit there.

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

    Examples
    --------
    >>> loss, pullback = mean_absolute(np.array([-3.0, 0.0, 1.0, 4.0]))
    >>> float(loss), pullback(0.1)  # 0.1 is the weight α of this term
    (2.0, array([-0.025,  0.   ,  0.025,  0.025]))
    """
    loss = np.mean(np.abs(y))

    def pullback(dloss: float = 1.0) -> np.ndarray:
        return (float(dloss) / y.size) * np.sign(y)

    return loss, pullback
