"""The path of a root that does not follow the feet.

Many estimators from video give poses about a root that stands still. Let v_t be the step of the
hips from frame t to t + 1, and u_t the step with which the toe of the lower foot would stand still.
Where Σ‖v_t‖ < FOLLOWING_SHARE · Σ‖u_t‖ the root does not follow the feet. Then its path is the sum
of the medians of u_t over `CALM_SECONDS`, filtered (`PATH_HERTZ`). If the feet make no steps
(`STEPS_METRES`), its path holds the mean of both toes at one place. In height, it keeps the lower
toe at one height.
"""

import numpy as np

from numpy_cae.mocap.retarget.body import body_positions
from numpy_cae.mocap.retarget.to_rig import retarget
from numpy_cae.motion.contacts import FEET
from numpy_cae.motion.filters import butterworth, median_of
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.curves import body_size, usual_body

LEFT_LEG = [JOINTS.index(f"left_{joint}") for joint in ("hip", "knee", "ankle")]
HANDS = [JOINTS.index("left_wrist"), JOINTS.index("right_wrist")]
CALM_SECONDS = 0.1
"""CALM_SECONDS: steps and speeds are taken over so long before and after a frame (s)."""
PATH_HERTZ = 2.5
"""PATH_HERTZ: the root's path is filtered with this cut-off (Hz). It and `feet.SLOW_ON_PATH` were
chosen on takes of CMU and synthetic ones whose root was held still (docs/lab_book/evidence.md)."""
FOLLOWING_SHARE = 0.4
"""FOLLOWING_SHARE: a root follows the feet if its steps are at least this share of the steps with
which the feet would stand. In 119 takes without damage the share is at least 0.82; in seven files
from video it is at most 0.23."""
HELD_METRES = 0.1
"""HELD_METRES: a root gets no path if both hands stay within this (m) in most frames, as those of a
cyclist do: then the feet need not stand on a floor."""
UPRIGHT_LEGS = 0.7
"""UPRIGHT_LEGS: a root gets a path only if the hips are higher above the lower toe than this times
the length of a leg in most frames."""
STEPS_METRES = 0.3
"""STEPS_METRES: the feet make no steps if 10% and 90% quantiles of the place of one toe relative to
the other are less than this (m) apart along the floor. Of people who stand still and wave, with
noise of 3°, they are at most 0.23 m apart."""


def path_of_root(motion: Motion) -> np.ndarray:
    """What the path of the root lacks, (frames, 3) in metres of a body of usual size: 0 if the root
    follows the feet."""
    body = usual_body(motion)
    toes = body[:, FEET]
    hips = body[:, 0]
    lower_height = toes[..., 1].min(axis=1)
    leg = np.linalg.norm(np.diff(body[0, LEFT_LEG], axis=0), axis=-1).sum()
    none = np.zeros((len(motion), 3))
    if len(motion) < 3 or np.median(hips[:, 1] - lower_height) < UPRIGHT_LEGS * leg:
        return none
    if _hands_are_held(body):
        return none
    root_steps = np.diff(hips, axis=0)
    asked_steps = _steps_of_feet(root_steps, toes)
    asked = np.linalg.norm(asked_steps, axis=1).sum()
    if np.linalg.norm(root_steps, axis=1).sum() >= FOLLOWING_SHARE * asked:
        return none
    if _makes_steps(toes):
        missing = median_of(asked_steps - root_steps, max(round(CALM_SECONDS * motion.rate), 1))
        path = np.concatenate([none[:1], np.cumsum(missing, axis=0)])
    else:
        path = toes[0].mean(axis=0) - toes.mean(axis=1)
    path[:, 1] = np.median(lower_height) - lower_height
    return butterworth(path, PATH_HERTZ, motion.rate)


def moved_along(motion: Motion, path: np.ndarray) -> Motion:
    """The motion with its whole body moved along a path (frames, 3) of `path_of_root`."""
    return retarget(motion, body_positions(motion) + body_size(motion) * path[:, None])


def _steps_of_feet(root_steps: np.ndarray, toes: np.ndarray) -> np.ndarray:
    """The steps of the root (frames - 1, 3) with which the lower toe would stand still."""
    lower = (toes[1:, :, 1] + toes[:-1, :, 1]).argmin(axis=1)
    return root_steps - np.diff(toes, axis=0)[np.arange(len(root_steps)), lower]


def _hands_are_held(body: np.ndarray) -> bool:
    """Whether both hands of a body (frames, 20, 3) stay at one place."""
    low, high = np.quantile(body[:, HANDS], [0.1, 0.9], axis=0)
    return bool(np.linalg.norm(high - low, axis=-1).max() < HELD_METRES)


def _makes_steps(toes: np.ndarray) -> bool:
    """Whether the feet (frames, 2, 3) change places along the floor."""
    low, high = np.quantile(toes[:, 0] - toes[:, 1], [0.1, 0.9], axis=0)
    apart = high - low
    return bool(np.hypot(apart[0], apart[2]) > STEPS_METRES)
