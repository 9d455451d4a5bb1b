"""Takes of many people as features on the bones of their mean (holden2015, section 4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from numpy_cae.motion.features import positions_to_features
from numpy_cae.motion.lengths import bone_lengths, change_lengths


def features_on_mean_skeleton(
    takes: Sequence[np.ndarray], rate: float
) -> tuple[list[np.ndarray], np.ndarray]:
    """Each take's features, and the bone lengths of the mean skeleton that they are on.

    Parameters
    ----------
    takes : sequence of (F, 20, 3) arrays of float
        World positions of the twenty joints in metres.
    rate : float
        Frames a second.

    Returns
    -------
    features : list of (F, 63) arrays of float64
    lengths : (20,) array of float64
        In metres; each take counts once, however long it is.
    """
    own = [bone_lengths(take) for take in takes]
    mean = np.mean(own, axis=0)
    features = [
        positions_to_features(change_lengths(take, lengths, mean), rate)[0]
        for take, lengths in zip(takes, own, strict=True)
    ]
    return features, mean
