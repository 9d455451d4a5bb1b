"""Interpolation of two motions: holden2015, section 7, "Motion Interpolation".

"We interpolate two distinctly separate motions of doing press ups and walking forward. Compared
to a linear interpolation, which creates an impossible walk, interpolation along the manifold
creates motion which remains valid." Pairs of press-ups and a walk are interpolated, and pairs of
walks in two styles. Of PCA the paper says that it does less well at interpolating different styles;
since PCA is linear, its interpolation is the linear one, projected onto `AXES` axes of the training
takes.
"""

from itertools import combinations, product

import numpy as np

from numpy_cae.evaluation import PCA
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.interpolation import TRANSITION, interpolate, shares
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
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
PRINCIPAL = "PCA on frames"
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
        tables.append(validity_table(caption, measured))
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


def _measured(
    manifold: MotionManifold, measure: ValidityMeasure, pca: PCA, pairs: list[Clips]
) -> dict[str, Validity]:
    """Name of a kind of motion to the mean of its measures."""
    ends: list[np.ndarray] = []
    straight = []
    along = []
    for first, second in pairs:
        ends += [first, second]
        for share in (*SHARES, TRANSITION):
            straight.append(linear(first, second, share))
            along.append(interpolate(manifold, first, second, share))
    motions = {
        ENDS: ends,
        PROJECTED_ENDS: [manifold.project(clip) for clip in ends],
        LINEAR: straight,
        PRINCIPAL: [pca.project(clip, AXES) for clip in straight],
        ALONG: along,
    }
    return {name: measure.mean(clips) for name, clips in motions.items()}


def _claim(
    kind: str,
    measured: dict[str, Validity],
    opponent: str = LINEAR,
    key: str = "interpolation_is_valid",
) -> Claim:
    """Compare all measures with another method; for jitter, which is nearer to the jitter of the
    two motions."""

    def errors(motion: Validity) -> tuple[float, ...]:
        jitter = abs(np.log(max(motion.jitter, 1e-9) / max(measured[ENDS].jitter, 1e-9)))
        return motion.bone_length, motion.foot_sliding, jitter, motion.nearest_pose

    columns = zip(Validity.HEADER, errors(measured[ALONG]), errors(measured[opponent]), strict=True)
    better = [heading.split(",")[0] for heading, ours, theirs in columns if ours < theirs]
    figures = (
        f"{ALONG} is better than {opponent} on {len(better)} of {len(Validity.HEADER)} measures "
    )
    figures += f"({', '.join(better) or 'none'}): {measured[ALONG].against(measured[opponent])}."
    return Claim(key, len(better) == len(Validity.HEADER), figures, kind)


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
