"""Motions of any length on jang2018's manifold, whose clips are two seconds long.

A motion is read in clips that overlap by half, and what they are decoded to is blended,

    x_t = Σ_i w_i(t) x̂_i(t) / Σ_i w_i(t),    w_i(t) = sin²(π (t - t_i + ½) / F)

where clip i begins at t_i and has F frames: each gives way to the next over half its length, its
own first and last frames, the worst, hardly count, and there is no seam. Rotations are blended as
quaternions of one sign; a clip's translation, which is relative to its first frame, is put back to
where the motion was there.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.manifold.sequence_manifold import SequenceManifold
from numpy_cae.motion import ANGLE_RATE, AngleSequence, Motion, body_positions
from numpy_cae.motion.angle_table import TRANSLATION
from numpy_cae.motion.angles import motion_of, on_floor
from numpy_cae.motion.clips import cut_clips
from numpy_cae.motion.features import POSITIONS, positions_to_features

CANDIDATES = 32
"""Clips that are drawn for each that follows in a sample."""


def project_sequence(manifold: SequenceManifold, sequence: AngleSequence) -> Motion:
    """The motion on the manifold that stands for a motion of any length.

    Parameters
    ----------
    manifold : SequenceManifold
    sequence : AngleSequence
        In the manifold's table of numbers.

    Returns
    -------
    Motion
        As many frames at 25 a second, on the manifold's own bones.

    Raises
    ------
    ValueError
        If the motion's numbers are those of another table, or it has no frames.
    """
    if sequence.table is not manifold.table:
        raise ValueError("the motion and the model have different numbers a frame")
    if len(sequence) == 0:
        raise ValueError("the motion has no frames")
    begin = starts(len(sequence), min(_frames(manifold), len(sequence)))
    frames = len(sequence) - begin[-1]
    pieces = [
        AngleSequence(sequence.numbers[t : t + frames], sequence.table, sequence.offsets)
        for t in begin
    ]
    clips = cut_clips(pieces, frames, frames)
    decoded = manifold.denormalise(manifold.network.denoise(manifold.normalise(clips)))
    for clip, piece in zip(decoded, pieces, strict=True):
        clip[:, TRANSLATION] += piece.numbers[0, TRANSLATION]
    return _blended(manifold, [_motion(manifold, clip) for clip in decoded], begin)


def sample_sequence(manifold: SequenceManifold, frames: int, rng: np.random.Generator) -> Motion:
    """A motion of any length that nobody made, from draws of the prior.

    Each clip begins where the one before is halfway through: of `CANDIDATES` draws it is the one
    whose first half is most like the other's second half, seen from the body, and it is turned and
    moved to go on from there.

    Parameters
    ----------
    manifold : SequenceManifold
    frames : int
        At 25 a second.
    rng : numpy.random.Generator

    Raises
    ------
    ValueError
        If there are no frames.
    """
    if frames < 1:
        raise ValueError(f"frames is {frames}, expected 1 or more")
    length = _frames(manifold)
    half = length // 2
    drawn = [_draw(manifold, 1, rng)[0]]
    # Half a clip more than is wanted: the last frame of a clip, the first written, is its worst.
    while half * len(drawn) < frames:
        ahead = _poses(_part(drawn[-1], slice(half, 2 * half)))
        others = _draw(manifold, CANDIDATES, rng)
        misses = [np.mean((_poses(_part(other, slice(half))) - ahead) ** 2) for other in others]
        drawn.append(_joined(drawn[-1], others[int(np.argmin(misses))], half))
    begin = half * np.arange(len(drawn))
    whole = _blended(manifold, drawn, begin)
    return on_floor(_part(whole, slice(frames)))


def starts(frames: int, length: int) -> np.ndarray:
    """Where clips of so many frames begin that cover all: every half clip, the last at the end."""
    begin = np.arange(0, frames - length + 1, max(length // 2, 1))
    return begin if begin[-1] == frames - length else np.append(begin, frames - length)


def _frames(manifold: SequenceManifold) -> int:
    return manifold.settings.get("frames", 50)


def _motion(manifold: SequenceManifold, numbers: np.ndarray) -> Motion:
    return motion_of(numbers, manifold.table, manifold.offsets)


def _draw(manifold: SequenceManifold, count: int, rng: np.random.Generator) -> list[Motion]:
    clips = manifold.network.sample(count, rng, _frames(manifold))
    return [_motion(manifold, manifold.denormalise(clip)) for clip in clips]


def _part(motion: Motion, frames: slice) -> Motion:
    return Motion(
        motion.skeleton, motion.rate, motion.rotations[frames], motion.translations[frames]
    )


def _poses(motion: Motion) -> np.ndarray:
    """The pose features of every frame: where it is and where it faces do not matter."""

    return positions_to_features(body_positions(motion), ANGLE_RATE)[0][:, POSITIONS]


def _blended(manifold: SequenceManifold, pieces: list[Motion], begin: np.ndarray) -> Motion:
    """One motion of overlapping ones of equal length."""
    length = len(pieces[0])
    frames = begin[-1] + length
    weight = np.sin(np.pi * (np.arange(length) + 0.5) / length) ** 2
    joints = pieces[0].rotations.shape[1]
    turned, moved = np.zeros((frames, joints, 4)), np.zeros((frames, joints, 3))
    total = np.zeros((frames, 1, 1))
    for first, piece in zip(begin, pieces, strict=True):
        here, w = slice(first, first + length), weight[:, None, None]
        # q and -q are one rotation: the sign nearer to what is there already.
        against = np.sum(turned[here] * piece.rotations, axis=-1, keepdims=True) < 0
        turned[here] += w * np.where(against, -1, 1) * piece.rotations
        moved[here] += w * piece.translations
        total[here] += w
    rotations = turned / np.maximum(np.linalg.norm(turned, axis=-1, keepdims=True), 1e-12)
    return Motion(pieces[0].skeleton, manifold.rate, rotations, moved / total)


def _joined(before: Motion, then: Motion, half: int) -> Motion:
    """`then` turned about Y and moved along the floor so that its first half runs on average where
    the second half of `before` does."""

    ahead, own = (body_positions(m) for m in (before, then))
    ahead, own = ahead[half : 2 * half], own[:half]
    middle, own_middle = ahead.mean(axis=(0, 1)), own.mean(axis=(0, 1))
    a, b = ahead - middle, own - own_middle
    # The turn θ about Y that brings b nearest to a: tan θ = Σ (b × a)_y / Σ b · a on the floor.
    theta = np.arctan2(
        np.sum(b[..., 2] * a[..., 0] - b[..., 0] * a[..., 2]),
        np.sum(b[..., 0] * a[..., 0] + b[..., 2] * a[..., 2]),
    )
    turn = Rotation.from_rotvec([0.0, theta, 0.0])
    rotations, translations = then.rotations.copy(), then.translations.copy()
    rotations[:, 0] = (turn * Rotation.from_quat(rotations[:, 0])).as_quat()
    translations[:, 0] = turn.apply(translations[:, 0] - own_middle) + middle
    return Motion(then.skeleton, then.rate, rotations, translations)
