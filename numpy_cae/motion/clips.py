"""Clips of 50 frames: jang2018, "randomly selected from the input motion sequence"."""

from collections.abc import Sequence

import numpy as np

from numpy_cae.motion.angles import ANGLES, TRANSLATION, AngleSequence, remove_whole_turns

CLIP = 50
"""Frames in a clip: two seconds."""


def draw_clips(
    sequences: Sequence[AngleSequence], clips: int, rng: np.random.Generator, frames: int = CLIP
) -> np.ndarray:
    """Random clips; every possible first frame is equally likely.

    Parameters
    ----------
    sequences : sequence of AngleSequence
        Those shorter than a clip are ignored.
    clips : int
        The number of clips.
    rng : numpy.random.Generator
    frames : int
        Frames in a clip.

    Returns
    -------
    (clips, frames, 54) array of float64
        The translation is relative to the first frame of the clip.

    Raises
    ------
    ValueError
        If all sequences are shorter than a clip.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import angles_of
    >>> walk = angles_of(make_take("walk", 1, seconds=4.0, rate=50.0).motion)
    >>> clips = draw_clips([walk], 8, np.random.default_rng(0))
    >>> clips.shape
    (8, 50, 54)
    >>> bool((clips[:, 0, TRANSLATION] == 0).all())
    True
    """
    starts = np.array([max(len(sequence) - frames + 1, 0) for sequence in sequences])
    _require_clips(starts.sum(), frames)
    chosen = rng.integers(starts.sum(), size=clips)
    ends = np.cumsum(starts)
    sources = np.searchsorted(ends, chosen, side="right")
    firsts = chosen - (ends - starts)[sources]
    drawn = []
    for source, first in zip(sources, firsts, strict=True):
        drawn.append(sequences[source].numbers[first : first + frames])
    return _normalise(np.stack(drawn), sequences[0])


def cut_clips(
    sequences: Sequence[AngleSequence], step: int = CLIP // 2, frames: int = CLIP
) -> np.ndarray:
    """Clips that begin every `step` frames, for evaluation.

    Parameters
    ----------
    sequences : sequence of AngleSequence
    step, frames : int
        Frames between the beginnings of two clips, and in a clip.

    Returns
    -------
    (clips, frames, 54) array of float64
        The translation is relative to the first frame of the clip.

    Raises
    ------
    ValueError
        If no sequence is as long as a clip.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import angles_of
    >>> walk = angles_of(make_take("walk", 1, seconds=4.0, rate=50.0).motion)
    >>> cut_clips([walk]).shape  # they begin at frames 0, 25 and 50 of 100
    (3, 50, 54)
    """
    clips = []
    for sequence in sequences:
        for first in range(0, len(sequence) - frames + 1, step):
            clips.append(sequence.numbers[first : first + frames])
    _require_clips(len(clips), frames)
    return _normalise(np.stack(clips), sequences[0])


def _require_clips(count: int, frames: int) -> None:
    if not count:
        raise ValueError(f"no motion is as long as a clip of {frames} frames at 25 a second")


def _normalise(clips: np.ndarray, sequence: AngleSequence) -> np.ndarray:
    """Translations relative to the first frame, angles as short as they can be."""
    clips[..., TRANSLATION] -= clips[:, :1, TRANSLATION]
    table = sequence.table
    vectors = np.zeros((*clips.shape[:2], 3 * len(table.joints)))
    vectors[..., table.indices] = clips[..., ANGLES]
    shortest = remove_whole_turns(vectors.reshape(*clips.shape[:2], -1, 3))
    clips[..., ANGLES] = shortest.reshape(vectors.shape)[..., table.indices]
    return clips
