"""Motions of any length and rig with jang2018's network, whose clips are two seconds long.

A motion is encoded in clips that overlap by half, and the decoded clips are blended,

    x_t = Σ_i w_i(t) x̂_i(t) / Σ_i w_i(t),    w_i(t) = sin²(π (t - t_i + ½) / F)

where clip i begins at t_i and has F frames. The first and last frames of a clip, which are the
worst, hardly count. Rotations are blended as quaternions of one sign. The translation of a clip is
relative to its first frame, so the position of the motion at t_i is added.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.manifold.sequence_manifold import SequenceManifold
from numpy_cae.motion.angle_table import TRANSLATION
from numpy_cae.motion.angles import ANGLE_RATE, AngleSequence, angles_of, motion_of, on_floor
from numpy_cae.motion.body import Body
from numpy_cae.motion.clips import cut_clips
from numpy_cae.motion.features import POSITIONS, positions_to_features
from numpy_cae.motion.io.t_pose import without_t_pose
from numpy_cae.motion.lengths import bone_lengths
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import from_vector, product, rotate
from numpy_cae.motion.retarget.rigs import body_positions
from numpy_cae.motion.retarget.to_body import body_of

CANDIDATES = 32
"""Clips drawn for each clip that is appended to a sample."""


def repair_sequence(
    motion: Motion, manifold: SequenceManifold, mapping: dict[str, str] | None = None
) -> Motion:
    """As `manifold.repair.repair`, for the action that a sequential manifold was learned from.

    A T-pose in the first frame of the motion is removed.
    """
    motion = without_t_pose(motion, mapping)
    projected = body_of(project_sequence(manifold, angles_of(motion, mapping)))
    body = Body(motion, bone_lengths(projected), mapping)
    positions = body.on_own_bones(projected)
    # Changing lengths scales the path of the hips; here the hips stay where they were.
    positions += projected[:, :1] - positions[:, :1]
    # 25 frames a second can end up to 1/25 s before 30 do.
    frames = len(body.positions)
    missing = max(frames - len(positions), 0)
    positions = np.concatenate([positions, positions[-1:].repeat(missing, axis=0)])
    return body.retarget(body.in_file_frames(positions[:frames]))


def project_sequence(manifold: SequenceManifold, sequence: AngleSequence) -> Motion:
    """The projection of a motion of any length, at 25 frames a second on the manifold's bones."""
    if sequence.table is not manifold.table:
        raise ValueError("the motion and the model have different tables of columns")
    if len(sequence) == 0:
        raise ValueError("the motion has no frames")
    starts = clip_starts(len(sequence), min(manifold.frames, len(sequence)))
    frames = len(sequence) - starts[-1]
    parts = [replace(sequence, numbers=sequence.numbers[t : t + frames]) for t in starts]
    clips = cut_clips(parts, frames, frames)
    decoded = manifold.denormalise(manifold.network.denoise(manifold.normalise(clips)))
    for clip, part in zip(decoded, parts, strict=True):
        clip[:, TRANSLATION] += part.numbers[0, TRANSLATION]
    motions = [motion_of(clip, manifold.table, manifold.offsets) for clip in decoded]
    return _blended(motions, starts, manifold.rate)


def sample_sequence(manifold: SequenceManifold, frames: int, rng: np.random.Generator) -> Motion:
    """A new motion of so many frames at 25 a second, from draws of the prior.

    Each clip begins in the middle of the one before: of `CANDIDATES` draws the one whose first half
    is nearest, in the body's frame, to the second half of the one before, rotated and moved to
    continue it.
    """
    if frames < 1:
        raise ValueError(f"frames is {frames}, expected 1 or more")
    half = manifold.frames // 2
    clips = [_draw(manifold, 1, rng)[0]]
    # Half a clip more than needed: the last frame of a clip, decoded first, is its worst.
    while half * len(clips) < frames:
        ending = _poses(clips[-1].at(slice(half, 2 * half)))
        candidates = _draw(manifold, CANDIDATES, rng)
        beginnings = [_poses(candidate.at(slice(half))) for candidate in candidates]
        errors = [np.mean((beginning - ending) ** 2) for beginning in beginnings]
        clips.append(_moved_to_continue(clips[-1], candidates[int(np.argmin(errors))], half))
    blended = _blended(clips, half * np.arange(len(clips)), manifold.rate)
    return on_floor(blended.at(slice(frames)))


def clip_starts(frames: int, length: int) -> np.ndarray:
    """First frames of clips that cover `frames` frames: every half clip, the last at the end."""
    starts = np.arange(0, frames - length + 1, max(length // 2, 1))
    return starts if starts[-1] == frames - length else np.append(starts, frames - length)


def _draw(manifold: SequenceManifold, count: int, rng: np.random.Generator) -> list[Motion]:
    clips = manifold.denormalise(manifold.network.sample(count, rng, manifold.frames))
    return [motion_of(clip, manifold.table, manifold.offsets) for clip in clips]


def _poses(motion: Motion) -> np.ndarray:
    """Positions in the body's frame of every frame, (F, 60)."""
    return positions_to_features(body_positions(motion), ANGLE_RATE)[0][:, POSITIONS]


def _blended(clips: list[Motion], starts: np.ndarray, rate: float) -> Motion:
    """One motion of overlapping clips of equal length."""
    length, joints = clips[0].rotations.shape[:2]
    frames = starts[-1] + length
    weight = (np.sin(np.pi * (np.arange(length) + 0.5) / length) ** 2)[:, None, None]
    rotations, translations = np.zeros((frames, joints, 4)), np.zeros((frames, joints, 3))
    total = np.zeros((frames, 1, 1))
    for start, clip in zip(starts, clips, strict=True):
        here = slice(start, start + length)
        # q and -q are the same rotation: add the one nearer to the sum so far.
        opposite = np.sum(rotations[here] * clip.rotations, axis=-1, keepdims=True) < 0
        rotations[here] += weight * np.where(opposite, -1, 1) * clip.rotations
        translations[here] += weight * clip.translations
        total[here] += weight
    rotations /= np.maximum(np.linalg.norm(rotations, axis=-1, keepdims=True), 1e-12)
    return Motion(clips[0].skeleton, rate, rotations, translations / total)


def _moved_to_continue(before: Motion, clip: Motion, half: int) -> Motion:
    """The clip rotated about Y and moved so that its first half is nearest to the second half of
    `before`."""
    ending = body_positions(before)[half : 2 * half]
    beginning = body_positions(clip)[:half]
    centre, own_centre = ending.mean(axis=(0, 1)), beginning.mean(axis=(0, 1))
    a, b = ending - centre, beginning - own_centre
    # The rotation θ about Y that brings b nearest to a: tan θ = Σ (b × a)_y / Σ b · a on the floor.
    theta = np.arctan2(
        np.sum(b[..., 2] * a[..., 0] - b[..., 0] * a[..., 2]),
        np.sum(b[..., 0] * a[..., 0] + b[..., 2] * a[..., 2]),
    )
    about_y = from_vector(np.array([0.0, theta, 0.0]))
    rotations, translations = clip.rotations.copy(), clip.translations.copy()
    rotations[:, 0] = product(about_y, rotations[:, 0])
    translations[:, 0] = rotate(about_y, translations[:, 0] - own_centre) + centre
    return replace(clip, rotations=rotations, translations=translations)
