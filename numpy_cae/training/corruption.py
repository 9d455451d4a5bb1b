"""What is random in a step of holden2015's training: the corruption, and where a layer unpools."""

import numpy as np

from numpy_cae.training.schedule import Stage


def corrupt(x: np.ndarray, stage: Stage, rng: np.random.Generator) -> np.ndarray:
    """X_c of a batch of windows (B, T, C), with all the corruption of a stage of training.

        X_c = zero_values(X, p),   p ~ U(zeroed),   and where rescaled   X_c / (1 - p)

    `stage.zeroed` is p, or the two numbers between which each window's p is drawn; below 1 if
    `stage.rescaled`. Zeroing values with probability p multiplies their expected sum by 1 - p.
    Dividing by 1 - p restores the sum for every p, so the filters are not fitted to one p.
    Where the stage has a `damage`, it is applied to X_c; neither paper has one.
    """
    p: float | np.ndarray
    if isinstance(stage.zeroed, tuple):
        p = rng.uniform(*stage.zeroed, size=(len(x), 1, 1)).astype(x.dtype)
    else:
        p = stage.zeroed
    corrupted = zero_values(x, p, rng)
    if stage.rescaled:
        corrupted = corrupted / (1 - p)
    if stage.damage is not None:
        corrupted = stage.damage(corrupted, rng)
    return corrupted


def zero_values(x: np.ndarray, p: float | np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """X_c: each value of x set to zero with probability p, independently; zero is the mean pose.

    Parameters
    ----------
    x : array of float, any shape
    p : float or array
        Between 0 and 1; an array must broadcast to x.
    rng : numpy.random.Generator

    Returns
    -------
    corrupted : array of the same shape

    Raises
    ------
    ValueError
        If p is not a probability.

    References
    ----------
    holden2015, section 6: the corruption of denoising autoencoding.

    Examples
    --------
    >>> x = np.ones((1, 1000, 5), np.float32)
    >>> corrupted = zero_values(x, 0.1, np.random.default_rng(0))
    >>> round(float(corrupted.mean()), 1)
    0.9
    """
    if not np.all((0 <= np.asarray(p)) & (np.asarray(p) <= 1)):
        raise ValueError(f"p is {p}, expected a probability between 0 and 1")
    return x * (rng.random(x.shape, dtype=np.float32) >= p)


def unpooling_mask(x: np.ndarray, filters: int, rng: np.random.Generator) -> np.ndarray:
    """The mask of `ops.unpool_random` for a layer whose input is x, (B, T, C): (B, T/2, D).

    True (with probability 1/2) puts the unpooled value on the first frame of its pair, False on
    the second.
    """
    batch, frames, _ = x.shape
    return rng.random((batch, frames // 2, filters), dtype=np.float32) < 0.5
