"""Words that `repr` of a repair and the reports of the commands share."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from numpy_cae.motion import JOINTS
from numpy_cae.motion.masks import runs

MOST_PRINTED = 5
"""At most this many runs of frames, and findings, are printed in full."""
NOTHING_FOUND = "nothing to repair was found"


def count(number: int, noun: str) -> str:
    """A number with its noun.

    Examples
    --------
    >>> count(1, "finding"), count(2, "finding")
    ('1 finding', '2 findings')
    """
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def first_lines(lines: list[str]) -> list[str]:
    """The first lines, and how many more there are."""
    more = len(lines) - MOST_PRINTED
    if more <= 0:
        return lines
    return [*lines[:MOST_PRINTED], f"  and {more} more"]


def cuts_in_words(cuts: Sequence[int]) -> str:
    """Where clips begin, and what that means for a repair.

    Examples
    --------
    >>> cuts_in_words([101])
    'cut at frame 101: the clips before and after it are repaired apart'
    >>> cuts_in_words([60, 101])
    'cuts at frames 60, 101: the clips between them are repaired apart'
    """
    frames = ", ".join(map(str, cuts[:MOST_PRINTED]))
    if len(cuts) > MOST_PRINTED:
        frames += f" and {len(cuts) - MOST_PRINTED} more"
    if len(cuts) == 1:
        return f"cut at frame {frames}: the clips before and after it are repaired apart"
    return f"cuts at frames {frames}: the clips between them are repaired apart"


def frames_in_words(mask: np.ndarray) -> str:
    """The runs of a mask (frames,), such as "frames 30 to 45, 102"."""
    ends = runs(mask)
    texts = []
    for first, end in ends[:MOST_PRINTED].tolist():
        texts.append(f"{first} to {end - 1}" if end - first > 1 else f"{first}")
    noun = "frame" if mask.sum() == 1 else "frames"
    text = f"{noun} {', '.join(texts)}"
    if len(ends) > MOST_PRINTED:
        text += f" and {len(ends) - MOST_PRINTED} more"
    return text


def joints_in_words(joints: Sequence[int]) -> str:
    """The names of some of the twenty joints, given by their indices."""
    if len(joints) == len(JOINTS):
        return "all joints"
    return ", ".join(JOINTS[joint] for joint in joints)


def joints_by_frames(touched: np.ndarray) -> dict[str, list[int]]:
    """The joints of a mask (frames, 20) by their frames in words: those of the same frames
    together."""
    groups: dict[str, list[int]] = defaultdict(list)
    for joint in np.flatnonzero(touched.any(axis=0)).tolist():
        groups[frames_in_words(touched[:, joint])].append(joint)
    return dict(groups)
