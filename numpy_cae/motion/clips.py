"""Clips of 50 frames: jang2018, "randomly selected from the input motion sequence"."""

from collections.abc import Sequence

import numpy as np

from numpy_cae.motion.angle_table import ANGLES, TRANSLATION
from numpy_cae.motion.angles import AngleSequence, shortest_clips

CLIP = 50
"""Frames, two seconds."""


def draw_clips(
    sequences: Sequence[AngleSequence], clips: int, rng: np.random.Generator, frames: int = CLIP
) -> np.ndarray:
    """Random clips (clips, frames, 54); every possible first frame is equally likely.

    Sequences shorter than a clip are ignored; ValueError if all are. The translation is relative to
    the first frame of the clip.
    """
    starts = np.array([max(len(sequence) - frames + 1, 0) for sequence in sequences])
    _require_clips(starts.sum(), frames)
    chosen = rng.integers(starts.sum(), size=clips)
    ends = np.cumsum(starts)
    sources = np.searchsorted(ends, chosen, side="right")
    firsts = chosen - (ends - starts)[sources]
    drawn = [
        sequences[source].numbers[first : first + frames]
        for source, first in zip(sources, firsts, strict=True)
    ]
    return _normalised(np.stack(drawn), sequences[0])


def cut_clips(
    sequences: Sequence[AngleSequence], step: int = CLIP // 2, frames: int = CLIP
) -> np.ndarray:
    """Clips that begin every `step` frames, for evaluation: (clips, frames, 54).

    Raises ValueError if no sequence is as long as a clip.
    """
    cut = [
        sequence.numbers[first : first + frames]
        for sequence in sequences
        for first in range(0, len(sequence) - frames + 1, step)
    ]
    _require_clips(len(cut), frames)
    return _normalised(np.stack(cut), sequences[0])


def _require_clips(count: int, frames: int) -> None:
    if not count:
        raise ValueError(f"no motion is as long as a clip of {frames} frames at 25 a second")


def _normalised(clips: np.ndarray, sequence: AngleSequence) -> np.ndarray:
    """Translations relative to the first frame, angles as short as they can be."""
    clips[..., TRANSLATION] -= clips[:, :1, TRANSLATION]
    table = sequence.table
    vectors = np.zeros((*clips.shape[:2], 3 * len(table.joints)))
    vectors[..., table.indices] = clips[..., ANGLES]
    shortest = shortest_clips(vectors.reshape(*clips.shape[:2], -1, 3))
    clips[..., ANGLES] = shortest.reshape(vectors.shape)[..., table.indices]
    return clips
