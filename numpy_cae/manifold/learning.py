"""From takes to a manifold: holden2015, sections 4 and 6, in their order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.features import (
    FEATURES,
    POSITIONS,
    TURN,
    VELOCITY,
)
from numpy_cae.motion.mean_skeleton import features_on_mean_skeleton
from numpy_cae.motion.retarget.to_body import RATE
from numpy_cae.motion.windows import LENGTH, OVERLAP, cut_windows
from numpy_cae.training import Checkpoint, Schedule, train_autoencoder

RMS = 0.25
"""What each kind of features is scaled to, root mean square. The paper does not say; much
smaller and the rate 0.5 hardly learns, much larger and it diverges (lessons/papers_to_code.md)."""
LOUDEST = 2.0
"""How many times that the loudest window may have: at one window a step, a person lying down among
people standing is enough to diverge."""


STILL = 1e-3
"""A kind of features that varies less (metres, radians) is not blown up to be seen: where nobody
turned in training, the first who does must not be a thousand."""


def learn_manifold(
    takes: Sequence[np.ndarray],
    schedule: Schedule | None = None,
    seed: int = 0,
    window: int = LENGTH,
    overlap: int = OVERLAP,
    filters: Sequence[int] = (64, 128, 256),
    taps: int = 15,
    bound: float = 0.9,
    rms: float = RMS,
    show_progress: bool = True,
    checkpoint: Checkpoint | None = None,
) -> MotionManifold:
    """Train a manifold on takes.

    Parameters
    ----------
    takes : sequence of (F, 20, 3) arrays of float
        World positions of the twenty joints in metres, at 30 frames a second.
    schedule : Schedule, optional
        The paper's where none is given.
    seed : int
        Of every draw: the first weights, the order, the corruption, the unpooling.
    window, overlap : int
        In frames; `window` is a multiple of 8 with three layers.
    filters, taps, bound
        Of `ConvAutoencoder`.
    rms : float
        What the features are scaled to, root mean square; less where a single window would have
        more than `LOUDEST` times it.
    checkpoint : Checkpoint, optional
        Of `train_autoencoder`.

    Returns
    -------
    MotionManifold

    Raises
    ------
    ValueError
        If there are no takes or the window does not suit the network.
    """
    if not takes:
        raise ValueError("there are no takes to learn from")
    schedule = schedule or Schedule()
    rng = np.random.default_rng(seed)
    network = accelerate(ConvAutoencoder(filters=filters, taps=taps, bound=bound, rng=rng))
    if window % network.frames_per_unit:
        raise ValueError(f"window is {window}, expected a multiple of {network.frames_per_unit}")

    features, lengths = features_on_mean_skeleton(takes, RATE)
    # Of a large database the features are gigabytes: here they are there once, as parts of frames.
    frames = np.concatenate(features)
    features = np.split(frames, np.cumsum([len(take) for take in features])[:-1])
    mean_pose, scale = _mean_and_scale(frames, features, window, overlap, rms)
    manifold = MotionManifold(network, mean_pose, scale, lengths, RATE)
    windows = _windows(manifold, features, window, overlap)
    del features, frames
    history = train_autoencoder(network, windows, schedule, rng, show_progress, checkpoint)
    manifold.settings = {
        "seed": seed,
        "window": window,
        "overlap": overlap,
        "takes": len(takes),
        "windows": len(windows),
        "schedule": asdict(schedule),
        "losses": history.losses,
        "seconds": history.seconds,
    }
    return manifold


def _windows(
    manifold: MotionManifold, features: Sequence[np.ndarray], window: int, overlap: int
) -> np.ndarray:
    """The windows of all takes as the network sees them, single precision, take by take."""
    counts = [len(cut_windows(take, window, overlap)[0]) for take in features]
    dtype = manifold.network.layers[0].w.dtype
    windows = np.empty((sum(counts), window, FEATURES), dtype)
    for end, count, take in zip(np.cumsum(counts), counts, features, strict=True):
        windows[end - count : end] = manifold.normalise(cut_windows(take, window, overlap)[0])
    return windows


def _mean_and_scale(
    frames: np.ndarray, features: Sequence[np.ndarray], window: int, overlap: int, rms: float
) -> tuple[np.ndarray, np.ndarray]:
    """The mean pose and what each feature is multiplied by, (63,) both: one factor for a kind.

    Each kind (positions, velocity, turn) is brought to `rms`, or none would learn to turn: a turn
    of a frame is a hundredth of a radian where positions are a tenth of a metre.
    """
    mean_pose = frames.mean(axis=0)
    scale = np.ones(FEATURES)
    for kind in (POSITIONS, VELOCITY, TURN):
        spread = np.sqrt(np.mean((frames[:, kind] - mean_pose[kind]) ** 2))
        if kind is POSITIONS and spread < STILL:
            raise ValueError("every frame of the takes is the same: there is nothing to learn")
        scale[kind] = rms / max(spread, STILL)
    loudest = max(
        np.sqrt(np.mean(((windows - mean_pose) * scale) ** 2, axis=(1, 2)).max())
        for windows in (cut_windows(take, window, overlap)[0] for take in features)
    )
    return mean_pose, scale * min(1.0, LOUDEST * rms / loudest)
