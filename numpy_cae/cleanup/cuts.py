"""Cuts: frames at which another clip begins. Many deliveries are several clips in one file.

At a cut all joints and the root change their pose from one frame to the next, by much more than in
the steps around. Other things do so, too, and are no cut:

- frames that were lost: with the speed that they have, the joints move as far in a short time;
- frames that were repeated before (`freezes`): the motion has gone on meanwhile;
- some frames of another pose: after them the pose is again what it was;
- motion that jumps all the time.

The parts between cuts are repaired as files of their own: nothing that is in one of them says what
is right in another.
"""

from itertools import combinations

import numpy as np

from numpy_cae.cleanup.channels import STILL_METRES
from numpy_cae.cleanup.judging import JUMPY_SHARE
from numpy_cae.cleanup.view import SHARP, View

CUT_TO_NEIGHBOURS_RATIO = 2.0
"""At a cut the step of a channel is longer than this times the steps before and after it."""
CUT_SHARE = 0.5
"""At a cut at least this share of the rotations that change make such a step. In takes of
data_synth at 24 and 30 frames a second the share is at most 0.28, at cuts between them at least
0.64 in 96%."""
CUT_METRES = 0.03
"""At a cut the joints move by more than this (m), in the mean. With 2 cm as many cuts are found;
with 5 cm 69% instead of 84% of those of Bandai by which joints move by 3 to 50 cm."""
LONGEST_LOST_SECONDS = 0.4
"""Frames were lost, and there is no cut, if the joints move by a jump in at most this time (s) at
the speeds that they have around it: chosen on CMU among 0.3, 0.4 and 0.5. Of takes that lost 0.1 to
0.3 s, and 0.4 to 0.6 s, a cut is found in 5% and 33% of CMU, 0% and 33% of Bandai, 1% and 36% of
data_synth; of cuts between takes by which the joints move by more than 0.5 m, 100%, 97% and 100%
are found."""
REACHING_SHARE = 0.8
"""At least this share of the joints move by a jump in the time of the line above. With 0.7 and 0.9
a cut is found in 5% and 8% of the takes of CMU that lost 0.1 to 0.3 s."""
AROUND_SECONDS = 1.0
"""The speeds of joints are measured in this time (s) before and after a jump. With 0.5 s
74% instead of 84% of the cuts of Bandai by which joints move by 3 to 50 cm are found, with 1.5 s
84%; the shares of lost frames that are cut change by at most 2%."""
USUAL_SPEED_SHARE = 0.9
"""The speed of a joint is this quantile of its speeds around a jump. With 0.8 and 0.95 a cut is
found in 47% and 25% of the takes of CMU that lost 0.4 to 0.6 s, and in 8% and 4% of those that lost
0.1 to 0.3 s; with 0.95 one of 19 cuts is missed."""
LATER_SHARE = 0.3
"""Some frames have another pose, and there is no cut, if after them the pose differs from that
before them by less than this share of the jump."""
LONGEST_OTHER_SECONDS = 1.5
"""Other poses of at most this time (s) are looked for, as by
`displacements.LONGEST_DISPLACED_SECONDS`."""
LONGEST_DROP_SECONDS = 1.0
"""A pose that is repeated for longer than this time (s) is held on purpose."""
DROP_RATIO = 3.0
"""Frames were dropped if the jump after them is at most this times the way that the slower one of
the motions before and after them takes in their time. Of takes in which 0.1 to 0.4 s repeat a pose
3% of CMU, 1% of Bandai and 9% of data_synth have a larger one; with a ratio of 2 12%, 2% and 13%.
"""
MEAN_CLIP_SECONDS = 1.0
"""Where clips would last less than this time (s) in the mean, the motion jumps all the time, and
has no cuts."""
SHORTEST_CLIP_SECONDS = 0.3
"""A clip lasts at least this time (s), or what begins there is noise."""


def find_cuts(view: View) -> list[int]:
    """The frames at which another clip begins.

    Examples
    --------
    >>> from data_synth import make_body, make_take
    >>> from numpy_cae.cleanup.result import join_motions
    >>> body = make_body(1.75)
    >>> walk = make_take("walk", 1, seconds=2.0, rate=30.0, body=body).motion
    >>> squats = make_take("squats", 2, seconds=2.0, rate=30.0, body=body).motion
    >>> find_cuts(View(walk)), find_cuts(View(join_motions(walk, squats)))
    ([], [60])
    """
    if len(view) < 4:
        return []
    rotations = np.array([channel.steps() for channel in view.channels if channel.is_rotation])
    root = np.array([channel.steps() for channel in view.channels if channel.is_root])
    if not len(rotations) or not len(root):
        return []
    is_cut = _are_long(rotations).mean(axis=0) >= CUT_SHARE
    is_cut &= _are_long(root).any(axis=0)
    is_still = rotations.mean(axis=0) <= STILL_METRES
    cuts = []
    for before in np.flatnonzero(is_cut).tolist():
        if _changes_clip(view, is_still, before):
            cuts.append(before + 1)
    return _drop_noise(view, _drop_other_poses(view, cuts))


def _are_long(steps: np.ndarray) -> np.ndarray:
    """Which of the steps (channels, frames - 1) are much longer than those before and after."""
    padded = np.pad(steps, ((0, 0), (1, 1)))
    neighbours = np.maximum(padded[:, :-2], padded[:, 2:])
    return np.asarray(steps > np.maximum(CUT_TO_NEIGHBOURS_RATIO * neighbours, STILL_METRES))


def _changes_clip(view: View, is_still: np.ndarray, before: int) -> bool:
    """Whether the pose after frame `before` is that of another clip: it is another, and neither
    frames that were lost nor repeated ones explain it."""
    after = before + 1
    body = view.body
    jump = body[after] - body[before]
    if np.linalg.norm(jump, axis=-1).mean() < CUT_METRES:
        return False
    start = before
    while start > 0 and is_still[start - 1]:
        start -= 1
    speed_before = body[start] - body[max(start - 1, 0)]
    speed_after = body[min(after + 1, len(body) - 1)] - body[after]
    frames = after - start
    if start < before:
        return not is_drop(frames, view.rate, jump, speed_before, speed_after)
    return _seconds_of_way(view, before) > LONGEST_LOST_SECONDS


def _seconds_of_way(view: View, before: int) -> float:
    """The time in which the hips, in the world, and most joints, from the hips, move by the jump
    after frame `before`, at the speeds that they have around it."""
    around = view.frames(AROUND_SECONDS)
    first = max(before - around, 0)
    body = view.body[first : before + around + 2]
    from_hips = body - body[:, :1]
    from_hips[:, 0] = body[:, 0]
    ways = np.linalg.norm(np.diff(from_hips, axis=0), axis=-1)
    jump = before - first
    speeds = np.quantile(np.delete(ways, jump, axis=0), USUAL_SPEED_SHARE, axis=0) * view.rate
    seconds = ways[jump] / np.maximum(speeds, STILL_METRES)
    return float(max(seconds[0], np.quantile(seconds[1:], REACHING_SHARE)))


def is_drop(
    frames: int, rate: float, jump: np.ndarray, speed_before: np.ndarray, speed_after: np.ndarray
) -> bool:
    """Whether frames that repeat a pose were dropped: the motion before them and after them is as
    fast as what it made up by a jump. Else the pose was held, and what follows begins another.

    Parameters
    ----------
    frames : int
        How many steps of the motion the jump makes up for.
    rate : float
        Frames a second.
    jump, speed_before, speed_after : (N, 3) array
        The jump, and the steps from frame to frame before the pose stood still and after the jump,
        in metres.
    """
    if frames > LONGEST_DROP_SECONDS * rate + 1:
        return False
    size, *speeds = [np.linalg.norm(x, axis=-1).mean() for x in (jump, speed_before, speed_after)]
    # Where frames are dropped twice in a row, the pose after the jump stands still again.
    moving = [speed for speed in speeds if speed > STILL_METRES]
    return bool(moving and size <= DROP_RATIO * frames * min(moving))


def _drop_other_poses(view: View, cuts: list[int]) -> list[int]:
    """The cuts but for those between which some frames have another pose."""
    dropped: set[int] = set()
    for first, end in combinations(cuts, 2):
        if end - first > LONGEST_OTHER_SECONDS * view.rate:
            continue
        jumps = [view.body[cut] - view.body[cut - 1] for cut in (first, end)]
        smaller = min(np.linalg.norm(jump, axis=-1).mean() for jump in jumps)
        remaining = view.body[end] - view.body[first - 1]
        if np.linalg.norm(remaining, axis=-1).mean() < LATER_SHARE * smaller:
            dropped |= {first, end}
    return [cut for cut in cuts if cut not in dropped]


def _drop_noise(view: View, cuts: list[int]) -> list[int]:
    """The cuts between which clips last, without those next to which one does not; none if the
    motion jumps all the time."""
    sharp_frames = np.count_nonzero((view.jumps == SHARP).any(axis=1)) if cuts else 0
    is_jumpy = sharp_frames > JUMPY_SHARE * len(view)
    if is_jumpy or len(view) < MEAN_CLIP_SECONDS * view.rate * (len(cuts) + 1):
        return []
    shortest = SHORTEST_CLIP_SECONDS * view.rate
    ends = [0, *cuts, len(view)]
    lasting = []
    for before, cut, after in zip(ends, cuts, ends[2:], strict=False):
        if cut - before >= shortest and after - cut >= shortest:
            lasting.append(cut)
    return lasting
