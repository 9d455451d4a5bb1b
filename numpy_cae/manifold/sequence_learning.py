"""From motions in joint space to a manifold of clips: jang2018, "Experimental Setup"."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.manifold.sequence_manifold import (
    SequenceManifold,
    common_bones,
    standardisation,
)
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.motion import CLIP, AngleSequence, cut_clips
from numpy_cae.training import Checkpoint, SequenceSchedule, train_sequential

HIDDEN, LATENT = 128, 8
"""Units of each GRU and numbers of z. The paper states neither."""

STEP = 5
"""The mean and the deviation are taken over clips that begin every so many frames."""

Watch = Callable[[SequenceManifold, int], None]


def learn_sequences(
    sequences: Sequence[AngleSequence],
    schedule: SequenceSchedule | None = None,
    seed: int = 0,
    hidden: int = HIDDEN,
    latent: int = LATENT,
    frames: int = CLIP,
    watch: Watch | None = None,
    network: type[SequentialAutoencoder] = SequentialAutoencoder,
    show_progress: bool = True,
    checkpoint: Checkpoint | None = None,
) -> SequenceManifold:
    """Train a manifold on motions of one action.

    Parameters
    ----------
    sequences : sequence of AngleSequence
        Motions shorter than a clip are passed over.
    schedule : SequenceSchedule, optional
    seed : int
        Of every draw: the first weights, the clips, the prior, the directions.
    hidden, latent : int
        Of `SequentialAutoencoder`.
    frames : int
        Of a clip.
    watch : (manifold, step) -> None, optional
        Called before the first step with 0 and after every one, to measure.
    network : type
        What to train; another loss can be put in its place to compare with.
    show_progress : bool
    checkpoint : Checkpoint, optional
        Of `train_sequential`.

    Returns
    -------
    SequenceManifold

    Raises
    ------
    ValueError
        If there are no motions, all are too short, or their rigs differ.
    """
    if not sequences:
        raise ValueError("there are no motions to learn from")
    schedule = schedule or SequenceSchedule()
    table, bones = common_bones(sequences)
    mean, deviation = standardisation(cut_clips(sequences, STEP, frames))
    rng = np.random.default_rng(seed)
    model = accelerate(network(len(table.columns), hidden, latent, rng))
    manifold = SequenceManifold(model, mean, deviation, table, bones)
    if watch is not None:
        watch(manifold, 0)
    history = train_sequential(
        model,
        manifold.drawing_from(sequences, frames),
        schedule,
        rng,
        show_progress,
        None if watch is None else lambda step: watch(manifold, step),
        checkpoint,
    )
    manifold.settings = {
        "seed": seed,
        "frames": frames,
        "motions": len(sequences),
        "schedule": asdict(schedule),
        "reconstruction": history.reconstruction[-1:],
        "discrepancy": history.discrepancy[-1:],
    }
    return manifold
