"""Missing joints of a motion, predicted from the joints that are visible meanwhile.

In a hole the visible joints, in the body's frame (`motion.features`), predict what is hidden
(`motion.regression`): of an arm or a leg the positions of its joints in the same frame. Of a limb's
end alone, such as a wrist whose elbow is visible, they predict the rotation that moves it, as a
vector relative to its mean R̄ over the known frames,

    y_t = log(R̄⁻¹ R_t),    R_t = R̄ exp(ŷ_t)

Positions are better for arms and legs, whose feet stand while the hips move, and rotations for
ends (docs/lab_book/filling.md).
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from numpy_cae.mocap.retargeting.body import Body, at_rate_of
from numpy_cae.motion import JOINTS, RATE, Motion
from numpy_cae.motion.angles import unwrap
from numpy_cae.motion.features import heading, local_positions, rotate_about_y
from numpy_cae.motion.hole_curves import find_holes
from numpy_cae.motion.quaternions import from_vector, inverse, product, slerp, to_vector
from numpy_cae.motion.regression import predict_hidden

TAKE_SECONDS = 10.0
"""The regression is fitted to at most this time (s) before and after a hole."""
_HIPS = 0
_ACROSS = [
    [JOINTS.index(f"{side}_{joint}") for side in ("left", "right")] for joint in ("hip", "shoulder")
]
"""The pairs of joints that give the heading of the body."""

ShareAt = Callable[[int, int], float]
"""From a joint and the first frame of a hole in it to the share of the regression, 0 to 1."""


class Regressed(NamedTuple):
    """Rotations (n, C, 4) of some joints of the rig in the frames of a hole."""

    hole: slice
    columns: np.ndarray
    rotations: np.ndarray


def regress_positions(features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """The features of a motion with the positions of missing joints predicted.

    Parameters
    ----------
    features : (F, 63) array of float
        At thirty frames a second.
    missing : (F, 20) array of bool
        A joint that is missing in all frames stays where it is, and predicts nothing.

    Returns
    -------
    (F, 63) array of float64
        Only the missing joints differ from `features`. Where there are too few complete frames
        nothing does.
    """
    predicted = np.array(features, dtype=np.float64)
    into = local_positions(predicted)  # a view
    points = local_positions(features)
    reach = round(TAKE_SECONDS * RATE)
    for hole in find_holes(missing, RATE):
        near = slice(max(hole.first - reach, 0), min(hole.end + reach, len(features)))
        is_visible = np.asarray(~missing[hole.first : hole.end].any(axis=0))
        inside = predict_hidden(
            points[near][:, is_visible].reshape(near.stop - near.start, -1),
            points[near][:, hole.columns].reshape(near.stop - near.start, -1),
            np.asarray(~missing[near][:, is_visible].any(axis=1)),
            np.asarray(~missing[near][:, hole.columns].any(axis=1)),
            slice(hole.first - near.start, hole.end - near.start),
            RATE,
        )
        if inside is not None:
            into[hole.first : hole.end, hole.columns] = inside.reshape(len(inside), -1, 3)
    return predicted


def regress_rotations(body: Body, unknown: np.ndarray, missing: np.ndarray) -> Iterator[Regressed]:
    """The unknown rotations of each hole in which the hips are visible and the heading is known.

    Parameters
    ----------
    body : Body
        The body of the motion.
    unknown : (frames, J) array of bool
        The rotations that are unknown.
    missing : (frames, 20) array of bool
        The joints that are missing.
    """
    motion = body.motion
    reach = round(TAKE_SECONDS * motion.rate)
    for hole in find_holes(unknown, motion.rate):
        near = slice(max(hole.first - reach, 0), min(hole.end + reach, len(motion)))
        inside = slice(hole.first - near.start, hole.end - near.start)
        is_visible = np.asarray(~missing[hole.first : hole.end].any(axis=0))
        positions = at_rate_of(motion, body.positions, np.arange(near.start, near.stop))
        visible = visible_positions(positions, is_visible, motion.rate)
        if visible is None:
            continue
        known_joints = np.asarray(~missing[near][:, is_visible].any(axis=1))
        known_rotations = np.asarray(~unknown[near][:, hole.columns].any(axis=1))
        rotations = motion.rotations[near][:, hole.columns]
        mean = mean_rotation(rotations[known_rotations])
        vectors = to_vector(product(inverse(mean), rotations))
        vectors[known_rotations] = unwrap(vectors[known_rotations])
        flat = vectors.reshape(len(vectors), -1)
        predicted = predict_hidden(
            visible, flat, known_joints, known_rotations, inside, motion.rate
        )
        if predicted is not None:
            turned = product(mean, from_vector(predicted.reshape(-1, len(hole.columns), 3)))
            yield Regressed(slice(hole.first, hole.end), hole.columns, turned)


def visible_positions(
    positions: np.ndarray, is_visible: np.ndarray, rate: float
) -> np.ndarray | None:
    """Of world positions (F, 20, 3) those of the visible joints in the body's frame, (F, 3 V).

    None where this frame is not known: the hips, or a joint of each pair of `_ACROSS`, are
    hidden."""
    pairs = [pair for pair in _ACROSS if is_visible[pair].all()]
    if not is_visible[_HIPS] or not pairs:
        return None
    placed = positions.copy()
    for pair in _ACROSS:
        if pair not in pairs:
            placed[:, pair] = positions[:, [_HIPS]]  # counts nothing in the heading
    theta = heading(placed, rate)
    floor = positions[:, _HIPS] * [1.0, 0.0, 1.0]
    local = rotate_about_y(positions[:, is_visible] - floor[:, None], -theta[:, None])
    return local.reshape(len(local), -1)


def mean_rotation(rotations: np.ndarray) -> np.ndarray:
    """The mean R̄ (C, 4) of rotations (F, C, 4), which are not spread over more than half a turn;
    q and -q are the same rotation."""
    sign = np.where(np.sum(rotations * rotations[:1], axis=-1, keepdims=True) < 0, -1.0, 1.0)
    mean = np.mean(sign * rotations, axis=0)
    return mean / np.linalg.norm(mean, axis=-1, keepdims=True)


def blend_rotations(
    start: Motion,
    regressed: Iterable[Regressed],
    share_at: ShareAt,
    frames: np.ndarray | None = None,
) -> Motion:
    """A motion whose unknown rotations are moved towards those that the visible joints predict.

    Parameters
    ----------
    start : Motion
        The motion with its unknown rotations on curves; or some frames of it.
    regressed : iterable of Regressed
        As `regress_rotations` returns them.
    share_at : ShareAt
        Its joints are those of the rig.
    frames : (frames,) array of bool, optional
        Which frames of the motion `start` has; all by default. Frames of the holes are among them.

    Returns
    -------
    Motion
        As many frames as `start` has.
    """
    rotations = start.rotations.copy()
    for hole, columns, predicted in regressed:
        first = hole.start
        if frames is not None:
            first = int(np.count_nonzero(frames[: hole.start]))
        inside = slice(first, first + len(predicted))
        share = np.array([share_at(column, hole.start) for column in columns])
        rotations[inside, columns] = slerp(rotations[inside, columns], predicted, share)
    return replace(start, rotations=rotations)
