"""Max pooling (Ψ) and the two approximate inverses (Ψ†) of holden2015.

After max pooling it is unknown which frame had the maximum and what value the other had. While a
layer is trained the paper unpools at random: one frame, chosen at random, gets the value and the
other gets 0. Pooling this again returns max(y, 0). In fine tuning and afterwards it unpools evenly:
each frame gets half of the value, which is smooth over time. Pooling this again returns y / 2.
"""

import numpy as np

from numpy_cae.ops.shapes import Pullback, require_shape


def max_pool(x: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """y[t] = max(x[2t], x[2t + 1]) in each channel; in a tie the earlier frame counts.

    The value depends on the larger frame alone, so that frame gets the whole gradient. In a tie
    both frames have the value, but the gradient must not count twice: one frame has to be chosen,
    and always the earlier one, so that runs can be repeated.

        dL/dx[2t]     = dy[t] where x[2t] >= x[2t + 1], else 0
        dL/dx[2t + 1] = dy[t] where x[2t] <  x[2t + 1], else 0

    Parameters
    ----------
    x : (B, T, C) array of float
        T is even.

    Returns
    -------
    y : (B, T/2, C) array
    pullback : dy -> dx

    Raises
    ------
    ValueError
        If x does not have three axes or T is odd.

    See Also
    --------
    unpool_even, unpool_random : Two ways back.

    References
    ----------
    holden2015, section 5, the Ψ of equation 1.

    Examples
    --------
    >>> y, pullback = max_pool(np.array([1.0, 5.0, 2.0, 2.0]).reshape(1, 4, 1))
    >>> y.ravel(), pullback(np.ones((1, 2, 1))).ravel()
    (array([5., 2.]), array([0., 1., 1., 0.]))
    """
    _require_pairs(x)
    earlier, later = x[:, 0::2], x[:, 1::2]
    earlier_is_max = earlier >= later
    y = np.maximum(earlier, later)

    def pullback(dy: np.ndarray) -> np.ndarray:
        require_shape("dy", dy, y.shape)
        dx = np.empty(x.shape, dtype=dy.dtype)
        dx[:, 0::2] = dy * earlier_is_max
        dx[:, 1::2] = dy * ~earlier_is_max
        return dx

    return y, pullback


def unpool_even(y: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """x[2t] = x[2t + 1] = y[t] / 2: half of the value on both frames.

    Half, because the next convolution adds up both frames: together they carry the value once.

        dL/dy[t] = (dx[2t] + dx[2t + 1]) / 2

    Parameters
    ----------
    y : (B, T, C) array of float

    Returns
    -------
    x : (B, 2T, C) array
    pullback : dx -> dy

    Raises
    ------
    ValueError
        If y does not have three axes.

    See Also
    --------
    unpool_random : The value on one frame of the pair.
    max_pool : What it undoes.

    References
    ----------
    holden2015, section 5, the Ψ† of equation 2 in fine tuning and in use.

    Examples
    --------
    >>> x, pullback = unpool_even(np.array([4.0, 2.0]).reshape(1, 2, 1))
    >>> x.ravel()
    array([2., 2., 1., 1.])
    """
    require_shape("y", y, ("batch", "frames", "channels"))
    x = np.repeat(y / 2, 2, axis=1)

    def pullback(dx: np.ndarray) -> np.ndarray:
        require_shape("dx", dx, x.shape)
        return (dx[:, 0::2] + dx[:, 1::2]) / 2

    return x, pullback


def unpool_random(y: np.ndarray, first: np.ndarray) -> tuple[np.ndarray, Pullback]:
    """x[2t] = y[t] where `first`, else x[2t + 1] = y[t]; the other frame of the pair is 0.

    Pooling forgets which frame had the maximum, so a fixed choice would be wrong half of the time.
    The mask is an argument, so that the function itself draws nothing and can be differentiated:

        dL/dy[t] = dx[2t] where `first`, else dx[2t + 1]

    Parameters
    ----------
    y : (B, T, C) array of float
    first : (B, T, C) array of bool
        True where the first frame of a pair gets the value; drawn by the caller.

    Returns
    -------
    x : (B, 2T, C) array
    pullback : dx -> dy
        The mask gets no gradient.

    Raises
    ------
    ValueError
        If the shapes differ or `first` is not boolean.

    See Also
    --------
    unpool_even : Half of the value on both frames.
    max_pool : What it undoes.

    References
    ----------
    holden2015, section 5, the Ψ† of equation 2 while a layer is trained.

    Examples
    --------
    >>> first = np.array([True, False]).reshape(1, 2, 1)  # rng.random(y.shape) < 0.5 in training
    >>> x, pullback = unpool_random(np.array([4.0, 2.0]).reshape(1, 2, 1), first)
    >>> x.ravel()
    array([4., 0., 0., 2.])
    """
    require_shape("y", y, ("batch", "frames", "channels"))
    require_shape("first", first, y.shape)
    if np.asarray(first).dtype != bool:
        raise ValueError(f"first has dtype {np.asarray(first).dtype}, expected bool")
    batch, frames, channels = y.shape
    x = np.empty((batch, 2 * frames, channels), dtype=y.dtype)
    x[:, 0::2] = y * first
    x[:, 1::2] = y * ~first

    def pullback(dx: np.ndarray) -> np.ndarray:
        require_shape("dx", dx, x.shape)
        return dx[:, 0::2] * first + dx[:, 1::2] * ~first

    return x, pullback


def _require_pairs(x: np.ndarray) -> None:
    require_shape("x", x, ("batch", "frames", "channels"))
    if x.shape[1] % 2 == 1:
        raise ValueError(f"x has shape {x.shape}, expected an even number of frames to pool")
