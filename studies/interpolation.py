"""Interpolation of two motions: holden2015, section 7, "Motion Interpolation".

"We interpolate two distinctly separate motions of doing press ups and walking forward. Compared
to a linear interpolation, which creates an impossible walk, interpolation along the manifold
creates motion which remains valid." Pairs of press-ups and a walk are interpolated, and pairs of
walks in two styles. Of PCA the paper says that it does less well at interpolating different styles;
since PCA is linear, its interpolation is the linear one, projected onto `AXES` axes of the training
takes. The simplest opponent is the linear interpolation whose bones are set to their lengths.
"""

from collections import defaultdict
from dataclasses import astuple
from itertools import combinations, product

import numpy as np

from numpy_cae.evaluation import PCA
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.interpolation import TRANSITION, interpolate, shares
from numpy_cae.motion import PARENTS
from numpy_cae.motion.features import local_positions
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.shared.judging import all_of, mean_of, negate, ratio_of_means
from studies.shared.material import LabelledTake, Material, evenly, features_of
from studies.shared.result import Claim, Result, Table, moving
from studies.shared.validity import Validity, ValidityMeasure, validity_table

SHARES = (0.25, 0.5, 0.75)
AXES = 30
"""Of PCA on single frames, which have 63 features."""
PAIRS = 5
"""Of each kind of pair at most this many are measured."""
LINEAR = "linear"
ALONG = "along the manifold"
WITH_LENGTHS = "linear, bones at their lengths"
PRINCIPAL = "PCA on frames"
IMPOSSIBLE = 2.0
"""A linear interpolation is impossible if a measure is more than this many times that of the two
motions."""
ENDS = "the two motions"
PROJECTED_ENDS = "the two, projected"
PRESS_UPS = "press-ups and walking"
STYLES = "walks of two styles"
Clips = tuple[np.ndarray, np.ndarray]
"""The features (F, 63) of two motions of one length."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Interpolate pairs of test takes linearly and along the manifold.

    Nearest poses are those of the training takes. Raises ValueError where the test takes have
    neither press-ups and walking nor walks of two styles. The seed is not used.
    """
    pairs = pairs_of(material.testing)
    if not pairs:
        raise ValueError("the test takes have neither press-ups and walks nor walks of two styles")
    training = features_of(manifold, material.training)
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    pca = PCA.fit(np.concatenate(training))
    tables = list[Table]()
    claims = list[Claim]()
    motions = {}
    for kind, takes in pairs.items():
        clips = [clips_of_pair(manifold, *pair) for pair in takes]
        measured = _measured(manifold, measure, pca, clips)
        listed = ", ".join(map(str, SHARES))
        caption = f"{kind}, {len(clips)} pairs, s = {listed} and 0 to 1:"
        means = {name: Validity.mean(of_pairs) for name, of_pairs in measured.items()}
        tables.append(validity_table(caption, means))
        if kind == PRESS_UPS:
            claims.append(_claim_of_linear(kind, measured))
        claims.append(_claim(kind, measured))
        claims.append(_claim(kind, measured, PRINCIPAL, "better_than_pca"))
        if not motions:
            first, second = clips[0]
            motions = {
                "one": (first, TRUTH),
                "the other": (second, TRUTH),
                LINEAR: (linear(first, second, 0.5), CORRUPTED),
                ALONG: (interpolate(manifold, first, second, 0.5), PROJECTED),
            }
    picture = moving(motions, manifold.rate, azimuth=75.0)
    return Result("Interpolation of two motions", tables, claims, {"interpolation": picture})


def linear(first: np.ndarray, second: np.ndarray, share: float | str) -> np.ndarray:
    """(1 - s) X_0 + s X_1."""
    s = shares(share, len(first))
    return (1 - s) * first + s * second


def set_bone_lengths(features: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Features (F, 63) whose bones keep their directions and have the lengths (20,), metres."""
    changed = np.array(features, dtype=np.float64)
    points = local_positions(changed)  # a view
    directions = points - points[:, [0, *PARENTS[1:]]]
    for joint, parent in enumerate(PARENTS[1:], start=1):
        bone = directions[:, joint]
        length = np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-9)
        points[:, joint] = points[:, parent] + bone / length * lengths[joint]
    return changed


def _measured(
    manifold: MotionManifold, measure: ValidityMeasure, pca: PCA, pairs: list[Clips]
) -> dict[str, list[Validity]]:
    """Name of a kind of motion to the means of its measures for each pair."""
    measured: dict[str, list[Validity]] = defaultdict(list)
    for first, second in pairs:
        all_shares = (*SHARES, TRANSITION)
        straight = [linear(first, second, share) for share in all_shares]
        motions = {
            ENDS: [first, second],
            PROJECTED_ENDS: [manifold.project(first), manifold.project(second)],
            LINEAR: straight,
            WITH_LENGTHS: [set_bone_lengths(clip, manifold.lengths) for clip in straight],
            PRINCIPAL: [pca.project(clip, AXES) for clip in straight],
            ALONG: [interpolate(manifold, first, second, share) for share in all_shares],
        }
        for name, clips in motions.items():
            measured[name].append(measure.mean(clips))
    return dict(measured)


def _claim_of_linear(kind: str, measured: dict[str, list[Validity]]) -> Claim:
    """Whether the linear interpolation has impossible bones, feet or poses."""
    of_pairs = np.array([astuple(validity) for validity in measured[LINEAR]])
    of_ends = np.array([astuple(validity) for validity in measured[ENDS]])
    ratios = {}
    for name, ours, theirs in zip(Validity.HEADER, of_pairs.T, of_ends.T, strict=True):
        if not name.startswith("jitter"):
            ratios[name.split(",")[0]] = ratio_of_means(ours, theirs)
    is_possible = all_of(*(ratio.at_most(IMPOSSIBLE) for ratio in ratios.values()))
    listed = "; ".join(f"{name} {ratio:.1f}" for name, ratio in ratios.items())
    figures = f"times those of the two motions: {listed}."
    return Claim("linear_impossible", negate(is_possible), figures, kind)


def _claim(
    kind: str,
    measured: dict[str, list[Validity]],
    opponent: str = LINEAR,
    key: str = "interpolation_is_valid",
) -> Claim:
    """Compare all measures with another method."""
    better = compare_measures(measured, ALONG, opponent)
    names = [name for name, is_better in better.items() if is_better]
    along, of_opponent = (Validity.mean(measured[name]) for name in (ALONG, opponent))
    figures = (
        f"{ALONG} is better than {opponent} on {len(names)} of {len(better)} measures "
        f"({', '.join(names) or 'none'}): {along.against(of_opponent)}."
    )
    also = ""
    simplest = ""
    if opponent == LINEAR:
        simplest = f"{WITH_LENGTHS}: {Validity.mean(measured[WITH_LENGTHS]).listed()}."
        if all_of(*compare_measures(measured, WITH_LENGTHS, LINEAR).values()):
            also = WITH_LENGTHS
    return Claim(key, all_of(*better.values()), figures, kind, simplest, also)


def compare_measures(
    measured: dict[str, list[Validity]], ours: str, opponent: str
) -> dict[str, bool | None]:
    """Whether each measure of a method is lower than that of another one; for jitter, whether it is
    nearer to the jitter of the two motions. None where the pairs do not decide."""

    def errors(name: str) -> np.ndarray:
        rows = []
        for motion, ends in zip(measured[name], measured[ENDS], strict=True):
            jitter = abs(np.log(max(motion.jitter, 1e-9) / max(ends.jitter, 1e-9)))
            rows.append((motion.bone_length, motion.foot_sliding, jitter, motion.nearest_pose))
        return np.array(rows)

    differences = (errors(ours) - errors(opponent)).T
    better = {}
    for heading, of_pairs in zip(Validity.HEADER, differences, strict=True):
        better[heading.split(",")[0]] = mean_of(of_pairs).below(0)
    return better


def clips_of_pair(manifold: MotionManifold, first: LabelledTake, second: LabelledTake) -> Clips:
    """The features of both from their first frames, the longer one truncated, at most a window."""
    features, second_features = features_of(manifold, [first, second])
    frames = min(len(features), len(second_features), manifold.window)
    return features[:frames], second_features[:frames]


def pairs_of(takes: list[LabelledTake]) -> dict[str, list[tuple[LabelledTake, LabelledTake]]]:
    """The pairs of each kind that there is, at most `PAIRS`."""
    walks = [take for take in takes if take.content in ("walk", "confident_walk")]
    press_ups = [take for take in takes if "press_up" in take.content]
    styles = []
    for a, b in combinations(walks, 2):
        if a.style and b.style and a.source == b.source and a.style != b.style:
            styles.append((a, b))
    pairs_of_kind = {PRESS_UPS: list(product(press_ups, walks)), STYLES: styles}
    return {kind: evenly(pairs, PAIRS) for kind, pairs in pairs_of_kind.items() if pairs}
