"""Work on long motions in pieces: an hour at 120 Hz takes 0.75 GB, and each of its copies too.

Whatever needs positions or filtered curves of many frames goes through one of these functions.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from numpy_cae.motion.masks import runs, with_margin
from numpy_cae.motion.motion import RATE, Motion, blocks


def chunks(frames: np.ndarray, margin: int = 0) -> Iterator[tuple[np.ndarray, slice]]:
    """Ascending frames in pieces, each with the slice of the motion around it: `margin` more frames
    on both sides, where the motion has them."""
    for part in blocks(frames):
        yield part, slice(max(int(part[0]) - margin, 0), int(part[-1]) + margin + 1)


def changed_around(
    motion: Motion, frames: np.ndarray, margin: int, least: int, change: Callable[[slice], Motion]
) -> Motion:
    """The motion with `change` applied around some frames.

    Parameters
    ----------
    motion : Motion
    frames : (frames,) array of bool
    margin : int
        `change` gets each run of these frames with so many more on both sides.
    least : int
        `change` gets at least so many frames, if the motion has them.
    change : function from a slice of frames to the changed motion of these frames

    Returns
    -------
    Motion
    """
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    for first, end in runs(with_margin(frames[:, None], margin)[:, 0]).tolist():
        around = slice(first, max(end, min(first + least, len(motion))))
        changed = change(around)
        rotations[around], translations[around] = changed.rotations, changed.translations
    return replace(motion, rotations=rotations, translations=translations)


def at_about_thirty(motion: Motion) -> tuple[Motion, int]:
    """Every n-th frame of a motion, about thirty a second, and n."""
    step = max(1, round(motion.rate / RATE))
    return replace(motion.at(slice(None, None, step)), rate=motion.rate / step), step
