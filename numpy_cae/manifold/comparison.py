"""Distance between two motions: holden2015, section 7, "Motion Comparison", equation 4.

    G(X_0, X_1) = ‖max_i Φ(X_0) - max_i Φ(X_1)‖² + ‖min_i Φ(X_0) - min_i Φ(X_1)‖²

i counts the hidden frames, the time steps of Y. Only the largest and the smallest value of each
unit (channel of Y) enter, so neither the time of an event nor the length of a clip matters.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold


def hidden_units(manifold: MotionManifold, features: np.ndarray) -> np.ndarray:
    """Φ(X) of a clip, with one hidden frame for each `stride` frames of the clip.

    Unlike `MotionManifold.encode`, the clip is padded by whole hidden frames, which are removed
    again, so that frame i belongs to hidden frame i // stride; and the input is not rescaled.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton, at thirty frames a second; F is at least 1.

    Returns
    -------
    (⌈F / stride⌉, k) array
        k units, in [-1, 1].

    Raises
    ------
    ValueError
        If there are no frames.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import hidden_units, starter
    >>> from numpy_cae.mocap import body_of
    >>> walk = body_of(make_take("walk", 0, seconds=2.0, rate=30.0).motion)
    >>> features, _ = starter().features(walk)
    >>> len(features), hidden_units(starter(), features).shape
    (60, (8, 256))
    """
    if len(features) == 0:
        raise ValueError("features have no frames to encode")
    before = -(-manifold.receptive_radius // manifold.stride)
    padded = manifold.pad(manifold.normalise(features)[None], before * manifold.stride)
    # The ⌈frames / stride⌉ hidden frames after those of the padding:
    return manifold.network.encode(padded)[0, before : before - (-len(features) // manifold.stride)]


def signature(series: np.ndarray) -> np.ndarray:
    """The largest and the smallest value of each unit of a time series.

    Parameters
    ----------
    series : (i, k) array

    Returns
    -------
    (2k,) array
        max_i, then min_i.

    Examples
    --------
    >>> signature(np.array([[0.1, 0.5], [0.3, -0.5]]))
    array([ 0.3,  0.5,  0.1, -0.5])
    """
    return np.concatenate([series.max(axis=0), series.min(axis=0)])


def G(y_0: np.ndarray, y_1: np.ndarray) -> float:
    """The distance of equation 4.

    Parameters
    ----------
    y_0, y_1 : (i, k), (j, k) arrays
        The hidden units of two motions.

    Returns
    -------
    float

    Examples
    --------
    >>> G(np.array([[0.0], [1.0]]), np.array([[0.5], [0.5], [1.0]]))
    0.25
    """
    return float(distance_matrix([signature(y_0)], [signature(y_1)])[0, 0])


def distance_matrix(
    signatures: Sequence[np.ndarray], columns: Sequence[np.ndarray] | None = None
) -> np.ndarray:
    """`G` of all pairs of motions, from their signatures.

    The two squared norms of equation 4 together are the squared norm of the difference of the
    signatures.

    Parameters
    ----------
    signatures, columns : M and N arrays (2k,)
        Of the motions of the rows and of the columns; the same motions where `columns` is None.

    Returns
    -------
    (M, N) array of float64

    Examples
    --------
    >>> distance_matrix([np.array([0.0, 1.0]), np.array([1.0, 1.0])])
    array([[0., 1.],
           [1., 0.]])
    """
    rows = np.asarray(signatures, dtype=np.float64)
    compared = rows if columns is None else np.asarray(columns, dtype=np.float64)
    return np.array([np.sum((row - compared) ** 2, axis=-1) for row in rows])
