"""Clips of 50 frames: jang2018, "randomly selected from the input motion sequence"."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from numpy_cae.motion.angle_table import ANGLES, TRANSLATION
from numpy_cae.motion.angles import AngleSequence
from numpy_cae.motion.unwrap import nearest_turn

CLIP = 50
"""Frames, two seconds."""


def draw_clips(
    sequences: Sequence[AngleSequence], clips: int, rng: np.random.Generator, frames: int = CLIP
) -> np.ndarray:
    """Clips that begin anywhere, each beginning as likely as every other.

    Parameters
    ----------
    sequences : sequence of AngleSequence
        Those shorter than a clip are passed over.
    clips : int
    rng : numpy.random.Generator
    frames : int

    Returns
    -------
    (clips, frames, 54) array of float64
        The translation relative to the first frame of the clip.

    Raises
    ------
    ValueError
        If no sequence is as long as a clip.
    """
    starts = np.array([max(len(sequence) - frames + 1, 0) for sequence in sequences])
    _require(starts.sum(), frames)
    chosen = rng.integers(starts.sum(), size=clips)
    ends = np.cumsum(starts)
    whose = np.searchsorted(ends, chosen, side="right")
    first = chosen - (ends - starts)[whose]
    return _as_clips(
        np.stack([sequences[w].numbers[f : f + frames] for w, f in zip(whose, first, strict=True)]),
        sequences[0],
    )


def cut_clips(
    sequences: Sequence[AngleSequence], step: int = CLIP // 2, frames: int = CLIP
) -> np.ndarray:
    """Clips that begin every `step` frames, for measuring: (clips, frames, 54).

    Raises
    ------
    ValueError
        If no sequence is as long as a clip.
    """
    cut = [
        sequence.numbers[first : first + frames]
        for sequence in sequences
        for first in range(0, len(sequence) - frames + 1, step)
    ]
    _require(len(cut), frames)
    return _as_clips(np.stack(cut), sequences[0])


def _require(count: int, frames: int) -> None:
    if not count:
        raise ValueError(f"no motion is as long as a clip of {frames} frames at 25 a second")


def _as_clips(clips: np.ndarray, sequence: AngleSequence) -> np.ndarray:
    clips[..., TRANSLATION] -= clips[:, :1, TRANSLATION]
    table = sequence.table
    whole = np.zeros((*clips.shape[:2], 3 * len(table.joints)))
    whole[..., table.places] = clips[..., ANGLES]
    turned = nearest_turn(whole.reshape(*clips.shape[:2], -1, 3))
    clips[..., ANGLES] = turned.reshape(whole.shape)[..., table.places]
    return clips
