"""A motion with holes: as features that a network fills in, and back in its rig.

Which curve, and how strong a correction, is best in this motion? Each hole, a run of frames in
which joints are missing, is imitated in the known frames of its own motion, where the truth is
known: the same joints are hidden in as many frames, and every candidate k fills them in. With e_ik
the mean error of candidate k in trial i of I, for the joints of one kind of hole
(`filling.classify_holes`), and r_k the mean of log e_k in holes of that kind and length of other
sources (`fill_strengths.json`, which `python -m tools.fill_strengths` makes), the mean of the
candidates is

    X = Σ_k w_k X_k,    w_k ∝ exp(-p l_k),    l_k = (Σ_i log e_ik + P r_k) / (I + P)

with P = `PRIOR_TRIALS`. So w_k falls with the p-th power of the error. The candidates are first the
`CURVES` of the rig's rotations. For the end of a limb alone, each unknown rotation R_c on their
mean is moved towards the rotation R_v that the visible joints predict (`cleanup.joint_regression`),
by each share s of `STRENGTHS`: R_c (R_c⁻¹ R_v)^s. For other holes the candidates on the mean X_0 of
the curves are X_0 + s (X_N - X_0) for each s of `STRENGTHS`. X_N are the positions that the visible
joints predict for an arm or a leg, and for a pose the correction of `manifold.fill`. The mean of
candidates that differ in s only has s = Σ_k w_k s_k. A hole for which no trial fits into the file
has the weights of other sources, I = 0.
"""

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup.finding import Finding
from numpy_cae.cleanup.interpolation import (
    find_moved_joints,
    interpolate_channels,
    interpolate_joints,
    mark_damaged_channels,
    mark_missing_joints,
    mark_unknown_channels,
)
from numpy_cae.cleanup.joint_regression import (
    Regressed,
    ShareAt,
    blend_rotations,
    regress_positions,
    regress_rotations,
)
from numpy_cae.cleanup.kinds import MARKED
from numpy_cae.manifold.filling import HOLE_KINDS, classify_holes, complete_from_curves, fill
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retargeting.body import Body, at_rate_of, body_of
from numpy_cae.mocap.retargeting.to_rig import retarget
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, RATE, Motion, bone_lengths, change_lengths
from numpy_cae.motion.features import features_to_positions, local_positions, positions_to_features
from numpy_cae.motion.hole_curves import CURVES, Curve, CurveAt, eased, eased_everywhere, mean_curve
from numpy_cae.motion.masks import at_thirty, run_numbers, runs
from numpy_cae.motion.motion import blocks

BLOCK_FRAMES = 18_000
"""The distance from the manifold is measured over at most this many frames at a time, ten minutes
at thirty a second: so the memory of the network's arrays has a bound."""
UNKNOWN_METRES = 0.12
"""A motion is unlike what the manifold learned from if its residual exceeds this (m), which is more
than that of any take of a source left out of training (docs/lab_book/detection.md)."""
LONG_SECONDS = 0.1
"""The manifold corrects what was interpolated over at least this time (s)."""
STRENGTHS = np.linspace(0.0, 1.0, 5)
"""These values of s of the module's equations are tried."""
POWERS = {"curves": 8.0, "shares": 8.0, "strengths": 16.0}
"""The p of the module's equation, chosen on sources left out of training
(docs/lab_book/filling.md)."""
TURNED = ("end",)
"""Kinds of holes whose rotations are moved towards those that the visible joints predict."""
CORRECTED = ("arm", "leg", "pose")
"""Kinds of holes whose positions are corrected."""
PRIOR_TRIALS = 2.0
"""The number of trials that other sources count as, chosen in the same way."""
TRIALS_SECONDS = 5.0
"""Trials are at most this far before and after a hole (s)."""
MARGIN_SECONDS = 0.2
"""A trial is at least this far from an unknown frame (s)."""
BETWEEN_TRIALS_SECONDS = 0.5
"""Two trials are at least this far apart (s), and as far as they are long."""
MOST_HOLES = 40
"""This many holes, the longest ones, have trials; the rest has the prior's weights. The trials of
a hole take a tenth to half of a second."""
LEAST_ERROR_METRES = 2e-4
"""Smaller errors (m) count as this."""


class Holes:
    """A motion in which some joints are damaged or missing in some frames.

    Parameters
    ----------
    body : Body
        The body of the motion.
    in_file : (frames, 20) array of bool
        What is damaged or missing, in the frames of the file.
    start : Motion, optional
        The frames of the motion that have holes, with the damaged rotations of the rig
        interpolated; those of `interpolate_joints` where None.

    Attributes
    ----------
    mask : (F, 20) array of bool
        What is damaged or missing at thirty frames a second.
    start : Motion
    features, root : (F, 63) array of float64, RootTransform
        Of the motion with the joints of the holes where they are in `start`: the X_0 of `fill`.
    """

    def __init__(self, body: Body, in_file: np.ndarray, start: Motion | None = None):
        self.body = body
        self.in_file = in_file
        self.mask = at_thirty(body.motion, in_file)
        in_holes = np.asarray(in_file.any(axis=1))
        if start is None:
            start = interpolate_joints(body.motion, in_file).at(in_holes)
        self.start = start
        positions = _positions_with(body, in_holes, start)
        self.lengths = bone_lengths(positions)
        positions = np.where(self.mask[..., None], positions, body.positions)
        positions = change_lengths(positions, self.lengths, body.mean_lengths)
        self.features, self.root = positions_to_features(positions, RATE)

    def positions_of(self, features: np.ndarray) -> np.ndarray:
        """World positions of features (F, 63) on the motion's own bones, (F, 20, 3) in metres."""
        on_mean_bones = features_to_positions(features, self.root)
        return change_lengths(on_mean_bones, self.body.mean_lengths, self.lengths)

    def typical_residual(self, manifold: MotionManifold) -> float:
        """The median distance of a joint outside the holes from its projection, metres."""
        if self.mask.all():
            return 0.0
        distance = np.zeros(self.mask.shape)
        for frames in blocks(np.arange(len(distance)), BLOCK_FRAMES):
            features = self.features[frames]
            completed = fill(manifold, features, self.mask[frames])
            projected = manifold.project(completed, average_shifts=True)
            distance[frames] = np.linalg.norm(local_positions(features - projected), axis=-1)
        return float(np.median(distance[~self.mask]))

    def move_to(self, features: np.ndarray) -> Motion:
        """The motion with the joints of the holes, and nothing else, moved to those of features
        (F, 63) on the mean skeleton."""
        motion = self.body.motion
        if not self.in_file.any():
            return motion
        correction = self.positions_of(features) - self.positions_of(self.features)
        correction[~self.mask] = 0.0
        weight = _ramps(self.in_file, motion.rate)
        joints = rig_of(motion).joints
        row = np.cumsum(self.in_file.any(axis=1)) - 1  # of a frame in `start`

        def targets(frames: np.ndarray) -> np.ndarray:
            interpolated = self.start.at(row[frames]).positions(joints)
            change = at_rate_of(motion, correction, frames)
            return interpolated + change * weight[frames, :, None]

        return retarget(motion, targets, self.in_file, self.start)


def holes_of(
    body: Body,
    findings: list[Finding],
    curve_at: CurveAt = eased_everywhere,
    share_at: ShareAt | None = None,
) -> Holes:
    """The holes of findings, with their damaged channels interpolated, and with their rotations
    predicted from the visible joints by the share that `share_at` has for each joint of the rig."""
    motion = body.motion
    missing = mark_missing_joints(motion, findings)
    in_holes = np.asarray(missing.any(axis=1))
    start = interpolate_channels(motion, findings, curve_at, in_holes)
    if share_at is not None:
        unknown, _ = mark_damaged_channels(motion, findings)
        unknown &= in_holes[:, None]
        start = blend_rotations(
            start, regress_rotations(body, unknown, missing), share_at, in_holes
        )
    return Holes(body, missing, start)


def _positions_with(body: Body, in_holes: np.ndarray, start: Motion) -> np.ndarray:
    """The positions (F, 20, 3) of a body whose motion is `start` in the frames of a mask."""
    motion = body.motion
    source = motion.source_frames(RATE)
    if source.dtype == int:  # frames are only dropped: no other pose changes
        positions = body.positions.copy()
        poses = np.flatnonzero(in_holes[source])
        rows = (np.cumsum(in_holes) - 1)[source[poses]]
        positions[poses] = start.at(rows).positions(rig_of(motion).joints)
        return positions
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[in_holes], translations[in_holes] = start.rotations, start.translations
    return body_of(replace(motion, rotations=rotations, translations=translations))


def _ramps(holes: np.ndarray, rate: float) -> np.ndarray:
    """A weight for each frame of a mask (frames, 20): 0 outside the holes, and within them it rises
    smoothly to 1 in 1/30 s from each end. A correction at thirty frames a second, resampled, is not
    exactly zero next to a hole; with this weight neither place nor speed jumps."""
    frame = np.arange(len(holes), dtype=np.float32)[:, None]
    before = np.maximum.accumulate(np.where(holes, -np.inf, frame), axis=0)
    after = np.minimum.accumulate(np.where(holes, np.inf, frame)[::-1], axis=0)[::-1]
    u = np.minimum(np.minimum(frame - before, after - frame) * (RATE / rate), 1.0)
    return u * u * (3 - 2 * u)


def complete_holes(
    motion: Motion, manifold: MotionManifold, findings: list[Finding]
) -> tuple[Motion, float]:
    """The motion with the holes of findings filled in by the manifold, and the typical distance (m)
    of the motion from the manifold.

    A motion that is unlike what the manifold learned from gets only what the user marked.
    """
    manifold = manifold.remember_projections()
    body = Body(motion, manifold.lengths)
    long_findings = [finding for finding in findings if _is_filled(finding, motion.rate)]
    residual = holes_of(body, long_findings).typical_residual(manifold)
    if residual > UNKNOWN_METRES:
        long_findings = [finding for finding in long_findings if finding.row is MARKED]
    return fill_holes(manifold, body, long_findings), residual


def fill_holes(manifold: MotionManifold, body: Body, findings: list[Finding]) -> Motion:
    """The motion of a body with the holes of findings filled in by the manifold."""
    missing = mark_missing_joints(body.motion, findings)
    chosen = choose_candidates(manifold, body, missing)
    ends = find_moved_joints(body.motion)
    holes = holes_of(
        body,
        findings,
        chosen.curve_at,
        lambda joint, first: chosen.share_at(ends[joint], first),
    )
    corrected = correct_features(manifold, holes.features, holes.mask)
    strength = np.where(holes.mask.all(axis=0), 1.0, chosen.strength)
    return holes.move_to(mix_features(holes.features, corrected, strength))


def correct_features(
    manifold: MotionManifold, features: np.ndarray, missing: np.ndarray
) -> np.ndarray:
    """X_N of the module's equation, (F, 63), from X_0 (F, 63) and what is missing (F, 20).

    A joint that is missing in all frames is what the manifold makes of the mean pose.
    """
    kinds = classify_holes(missing)
    always = np.asarray(missing.all(axis=0))
    is_pose = missing & ((kinds == HOLE_KINDS.index("pose")) | always)
    by_network = complete_from_curves(manifold, features, is_pose, np.ones(missing.shape))
    by_visible = regress_positions(features, missing)
    is_limb = (kinds == HOLE_KINDS.index("arm")) | (kinds == HOLE_KINDS.index("leg"))
    return mix_features(by_network, by_visible, is_limb & ~always)


def mix_features(features: np.ndarray, target: np.ndarray, share: np.ndarray) -> np.ndarray:
    """The features (F, 63) with the positions of joints moved by a share (F, 20) towards those of
    target features (F, 63)."""
    mixed = np.array(features, dtype=np.float64)
    points = local_positions(mixed)  # a view
    points += share[..., None] * (local_positions(target) - points)
    return mixed


def _is_filled(finding: Finding, rate: float) -> bool:
    """Whether the manifold fills in a finding."""
    if not finding.is_repaired:
        return False
    is_long = finding.frames[1] - finding.frames[0] >= LONG_SECONDS * rate
    return finding.row is MARKED or (finding.row.is_filled and is_long)


class Trials(NamedTuple):
    """Holes that are imitated in known frames.

    Parameters
    ----------
    hole_kinds : (frames, 20) array of str
        The kinds of the joints that are hidden (`filling.classify_holes`), else "".
    starts : list of int
        The first frame of each trial.
    size : int
        The frames of a trial.
    """

    hole_kinds: np.ndarray
    starts: list[int]
    size: int


class Choice(NamedTuple):
    """The mean of the candidates for joints of one kind in a hole.

    Parameters
    ----------
    curve : Curve
        The mean of `CURVES`.
    share : float
        The share s of the rotations that the visible joints predict.
    strength : float
        The strength s of the correction by the network.
    """

    curve: Curve
    share: float
    strength: float


class Choices(NamedTuple):
    """The means of the candidates in all holes of a motion.

    Parameters
    ----------
    curve_at : CurveAt
        The curve for one of the twenty joints and a frame in which it is missing.
    share_at : ShareAt
        The share for the same.
    strength : (F, 20) array of float
        At thirty frames a second; 0 where nothing is missing.
    """

    curve_at: CurveAt
    share_at: ShareAt
    strength: np.ndarray


def choose_candidates(manifold: MotionManifold, body: Body, missing: np.ndarray) -> Choices:
    """Weigh the candidates in each hole.

    Parameters
    ----------
    manifold : MotionManifold
    body : Body
        The body of the motion.
    missing : (frames, 20) array of bool
        In the frames of the file.

    Returns
    -------
    Choices
    """
    source = body.motion.source_frames(RATE)
    number = run_numbers(missing)
    hole_kinds = classify_holes(missing)
    kinds_at_rate = classify_holes(at_thirty(body.motion, missing))
    strength = np.zeros(kinds_at_rate.shape)
    choices = dict[int, Choice]()
    always = np.asarray(missing.all(axis=0))
    holes = runs(np.asarray((missing & ~always).any(axis=1)))
    longest_first = holes[np.argsort(holes[:, 0] - holes[:, 1], kind="stable")]
    for rank, (first, end) in enumerate(longest_first.tolist()):
        hole = slice(first, end)
        best = choose_in_hole(manifold, body, hole_kinds, always, hole, rank < MOST_HOLES)
        at_rate = slice(*np.searchsorted(source, [first - 1, end + 1]))
        for kind, choice in best.items():
            is_kind = kinds_at_rate[at_rate] == HOLE_KINDS.index(kind)
            strength[at_rate][is_kind] = choice.strength
            of_kind = number[first:end][hole_kinds[first:end] == HOLE_KINDS.index(kind)]
            choices |= dict.fromkeys(np.unique(of_kind), choice)
    default = Choice(eased, 0.0, 0.0)

    def choice_at(joint: int, frame: int) -> Choice:
        return choices.get(number[frame, joint], default)

    return Choices(
        lambda joint, frame: choice_at(joint, frame).curve,
        lambda joint, frame: choice_at(joint, frame).share,
        strength,
    )


def choose_in_hole(
    manifold: MotionManifold,
    body: Body,
    hole_kinds: np.ndarray,
    always: np.ndarray,
    hole: slice,
    tried: bool,
) -> dict[str, Choice]:
    """The choice for each kind in a hole, which is a run of frames.

    `hole_kinds` (frames, 20) are those of `classify_holes`; `always` (20,) says which joints are
    missing in all frames. Only if `tried` there are trials.
    """
    rate = body.motion.rate
    pattern = np.where(always, "", np.array(HOLE_KINDS)[hole_kinds[hole]])
    margin = round(TRIALS_SECONDS * rate)
    near = slice(max(hole.start - margin, 0), hole.stop + margin)
    clip = Body(body.motion.at(near), body.mean_lengths)
    missing = hole_kinds[near] > 0
    is_visible = np.asarray(~missing[:, (pattern != "").any(axis=0)].any(axis=1))
    trials = place_trials(is_visible & tried, pattern, rate)
    hidden = missing | (trials.hole_kinds != "")
    names = np.unique(pattern[pattern != ""]).tolist()
    seconds = {kind: float((pattern == kind).any(axis=1).sum() / rate) for kind in names}
    on_curve = (interpolate_body(clip, hidden, curve) for curve in CURVES.values())
    by_curve = _weights_of("curves", seconds, measure_errors(clip, trials, on_curve))
    curves = {kind: mean_curve(weight) for kind, weight in by_curve.items()}

    def curve_at(joint: int, frame: int) -> Curve:
        return curves.get(trials.hole_kinds[frame, joint], eased)

    start = interpolate_joints(clip.motion, hidden, curve_at)
    shares = dict[str, float]()
    turned_kinds = {kind: seconds[kind] for kind in names if kind in TURNED}
    if turned_kinds:
        unknown, _ = mark_unknown_channels(clip.motion, hidden)
        regressed = list(regress_rotations(clip, unknown, hidden)) if trials.starts else []
        errors = measure_errors(clip, trials, regress_body(start, regressed))
        for kind, weight in _weights_of("shares", turned_kinds, errors).items():
            shares[kind] = float(weight @ STRENGTHS)
        ends = find_moved_joints(clip.motion)

        def share_at(joint: int, frame: int) -> float:
            return shares.get(trials.hole_kinds[frame, ends[joint]], 0.0)

        start = blend_rotations(start, regressed, share_at)
    strengths = dict[str, float]()
    corrected_kinds = {kind: seconds[kind] for kind in names if kind in CORRECTED}
    if corrected_kinds:
        errors = measure_errors(clip, trials, correct_body(manifold, clip, hidden, start))
        for kind, weight in _weights_of("strengths", corrected_kinds, errors).items():
            strengths[kind] = float(weight @ STRENGTHS)
    choices = {}
    for kind in names:
        choices[kind] = Choice(curves[kind], shares.get(kind, 0.0), strengths.get(kind, 0.0))
    return choices


def _weights_of(
    name: str, seconds: dict[str, float], errors: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """The weights of the candidates for "curves", "shares" or "strengths", for each kind of
    hole."""
    priors = {kind: prior(name, kind, duration) for kind, duration in seconds.items()}
    return {kind: weights(r, errors.get(kind), POWERS[name]) for kind, r in priors.items()}


def interpolate_body(body: Body, missing: np.ndarray, curve: Curve) -> np.ndarray:
    """The positions (F, 20, 3) with all unknown rotations on one curve."""
    return body_of(interpolate_joints(body.motion, missing, lambda *_: curve))


def regress_body(start: Motion, regressed: list[Regressed]) -> Iterator[np.ndarray]:
    """The positions (F, 20, 3) of a motion whose unknown rotations are on curves, with each of
    `STRENGTHS` as the share of the regression.

    The positions between those of the shares 0 and 1 are linear, as if rotations were small.
    """
    x0 = body_of(start)
    x1 = body_of(blend_rotations(start, regressed, lambda *_: 1.0))
    for share in STRENGTHS:
        yield x0 + share * (x1 - x0)


def correct_body(
    manifold: MotionManifold, body: Body, missing: np.ndarray, start: Motion
) -> Iterator[np.ndarray]:
    """The positions (F, 20, 3) for each of `STRENGTHS`; `start` is the motion of X_0."""
    holes = Holes(body, missing, start.at(np.asarray(missing.any(axis=1))))
    full = correct_features(manifold, holes.features, holes.mask)
    x0 = holes.positions_of(holes.features)
    xn = holes.positions_of(full)
    for s in STRENGTHS:
        yield x0 + s * (xn - x0)


def measure_errors(
    body: Body, trials: Trials, candidates: Iterable[np.ndarray]
) -> dict[str, np.ndarray]:
    """The mean errors (m) of candidates (F, 20, 3) in trials, (I, K), for each kind of hole.

    Without trials no candidate is computed.
    """
    if not trials.starts:
        return {}
    distances = [np.linalg.norm(x - body.positions, axis=-1) for x in candidates]
    source = body.motion.source_frames(RATE)
    errors: dict[str, list[list[float]]] = defaultdict(list)
    for kind in np.unique(trials.hole_kinds[trials.hole_kinds != ""]):
        mask = at_thirty(body.motion, trials.hole_kinds == kind)
        for start in trials.starts:
            frames = slice(*np.searchsorted(source, [start, start + trials.size]))
            if mask[frames].any():
                errors[str(kind)].append([x[frames][mask[frames]].mean() for x in distances])
    return {kind: np.array(rows) for kind, rows in errors.items()}


def weights(prior: np.ndarray, errors: np.ndarray | None, power: float) -> np.ndarray:
    """w of the module's equation, (K,), from r (K,) and the errors of trials (I, K), if any."""
    if errors is None:
        errors = np.empty((0, len(prior)))
    logs = np.log(np.maximum(errors, LEAST_ERROR_METRES))
    logs -= logs[:, :1]  # trials that are hard for all candidates weigh no more
    score = (logs.sum(axis=0) + PRIOR_TRIALS * prior) / (len(logs) + PRIOR_TRIALS)
    weight = np.exp(-power * (score - score.min()))
    return weight / weight.sum()


def place_trials(is_visible: np.ndarray, pattern: np.ndarray, rate: float) -> Trials:
    """As many trials as fit into the runs of visible frames (frames,), evenly spread over each.

    `pattern` (n, 20) are the kinds of the joints that are missing in the hole, else "".
    """
    margin = round(MARGIN_SECONDS * rate)
    size = len(pattern)
    hole_kinds = np.zeros((len(is_visible), len(JOINTS)), "U4")
    starts = list[int]()
    distance = size + max(size, round(BETWEEN_TRIALS_SECONDS * rate))
    for first, end in runs(is_visible) + [margin, -margin - size]:
        if end >= first:
            starts += np.linspace(first, end, (end - first) // distance + 1).astype(int).tolist()
    for start in starts:
        hole_kinds[start : start + size] = pattern
    return Trials(hole_kinds, starts, size)


def prior(name: str, kind: str, seconds: float) -> np.ndarray:
    """r of the module's equation for "curves", "shares" or "strengths", by the kind and duration of
    a hole, interpolated over the logarithm of the duration."""
    table = read_fill_table()
    lengths = np.log(table["lengths"])
    columns = np.transpose(table[name][kind])
    return np.array([np.interp(np.log(seconds * RATE), lengths, column) for column in columns])


@cache
def read_fill_table() -> dict:
    """Lengths of holes, in frames at 30 a second, and r for each kind of hole, length and candidate
    relative to the first candidate."""
    return json.loads(files("numpy_cae.cleanup").joinpath("fill_strengths.json").read_text("utf-8"))
