"""Interpolation of two motions: holden2015, section 7, "Motion Interpolation".

"We interpolate two distinctly separate motions of doing press ups and walking forward. Compared
to a linear interpolation, which creates an impossible walk, interpolation along the manifold
creates motion which remains valid." Also walks of two styles, for which PCA "does not perform
well". PCA on windows is linear: it projects the linear interpolation.
"""

from collections.abc import Callable
from dataclasses import astuple
from functools import partial
from itertools import combinations, product

import numpy as np

from numpy_cae.evaluation import PCA, Validity, ValidityMeasure
from numpy_cae.experiments.material import LabelledTake, Material, features_of
from numpy_cae.experiments.result import Claim, Result, Table, moving
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.interpolate import TRANSITION, interpolate, shares
from numpy_cae.motion import FEATURES, cut_windows
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, TRUTH

SHARES = (0.25, 0.5, 0.75)
SIZE = 200
"""Axes of PCA on windows, the best size for repairing them (`half_removed`)."""
PAIRS = 5
"""At most so many pairs of a kind, spread over all."""
LINEAR, PCA_WINDOWS, ALONG = "linear", "PCA on windows", "along the manifold"
ENDS, PROJECTED_ENDS = "the two motions", "the two, projected"
PRESS_UPS, STYLES = "press-ups and walking", "walks of two styles"
Method = Callable[[np.ndarray, np.ndarray, float | str], np.ndarray]
"""From two motions and a share to the motion between them."""
Measured = dict[str, Validity]
Pair = tuple[LabelledTake, LabelledTake]


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Interpolate pairs of test takes linearly, with PCA, and along the manifold.

    PCA and nearest poses are of the training takes. Raises ValueError where the test
    takes have neither press-ups and walking nor walks of two styles.
    """
    kinds = pairs_of(material.testing)
    if not kinds:
        raise ValueError("the test takes have neither press-ups and walks nor walks of two styles")
    training = features_of(manifold, material.training)
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    methods = _methods(manifold, training)
    tables, claims, motions = [], [], {}
    for kind, pairs in kinds.items():
        clips = [clips_of_pair(manifold, *pair) for pair in pairs]
        measured = _measured(manifold, measure, methods, clips)
        listed = ", ".join(map(str, SHARES))
        caption = f"{kind}, {len(clips)} pairs, s = {listed} and 0 to 1:"
        rows = [[name, *astuple(each)] for name, each in measured.items()]
        tables.append(Table(caption, ["motion", *Validity.HEADER], rows, Validity.FORMATS))
        claims.append(_claim(kind, measured))
        if not motions:
            motions = {_name(take): (x, TRUTH) for take, x in zip(pairs[0], clips[0], strict=True)}
            colours = {LINEAR: CORRUPTED, PCA_WINDOWS: PLAIN, ALONG: PROJECTED}
            for name, method in methods.items():
                motions[name] = method(*clips[0], 0.5), colours[name]
    return Result(
        "Interpolation of two motions",
        tables,
        claims,
        *moving(motions, manifold.rate, azimuth=75.0),
    )


def _methods(manifold: MotionManifold, training: list[np.ndarray]) -> dict[str, Method]:
    length = manifold.window
    cut = [cut_windows(take, length, length // 2)[0] for take in training]
    windows = manifold.normalise(np.concatenate(cut)).reshape(-1, length * FEATURES)
    pca = PCA.fit(windows.astype(np.float64))

    def linear(one: np.ndarray, other: np.ndarray, share: float | str) -> np.ndarray:
        s = shares(share, len(one))
        return (1 - s) * one + s * other

    def along_pca(one: np.ndarray, other: np.ndarray, share: float | str) -> np.ndarray:
        mixed, _ = cut_windows(linear(one, other, share), length, 0)
        projected = manifold.denormalise(pca.project(manifold.normalise(mixed), SIZE))
        return projected[0, : len(one)]

    return {LINEAR: linear, PCA_WINDOWS: along_pca, ALONG: partial(interpolate, manifold)}


def _measured(
    manifold: MotionManifold,
    measure: ValidityMeasure,
    methods: dict[str, Method],
    clips: list[tuple[np.ndarray, np.ndarray]],
) -> Measured:
    ends = [clip for pair in clips for clip in pair]
    measured = {
        ENDS: Validity.mean([measure.of(clip) for clip in ends]),
        PROJECTED_ENDS: Validity.mean([measure.of(manifold.project(clip)) for clip in ends]),
    }
    for name, method in methods.items():
        made = [method(*pair, share) for pair in clips for share in (*SHARES, TRANSITION)]
        measured[name] = Validity.mean([measure.of(clip) for clip in made])
    return measured


def _claim(kind: str, measured: Measured) -> Claim:
    other, sentence = {
        PRESS_UPS: (
            LINEAR,
            "Compared to a linear interpolation of press-ups and walking, which creates an "
            "impossible walk, interpolation along the manifold creates motion which remains valid "
            "(holden2015, section 7).",
        ),
        STYLES: (
            PCA_WINDOWS,
            "PCA does not perform well when interpolating motions of different style (holden2015, "
            "section 7).",
        ),
    }[kind]
    better = better_measures(measured, ALONG, other)
    return Claim(
        sentence,
        len(better) == len(Validity.HEADER),
        f"{ALONG} is better than {other} on {len(better)} of {len(Validity.HEADER)} measures "
        f"({', '.join(better) or 'none'}): {measured[ALONG].against(measured[other])}. Confirmed "
        "if better on all of them.",
    )


def better_measures(measured: Measured, method: str, than: str) -> list[str]:
    """The measures in which a method is better than another; for jitter, nearer to the jitter of
    the two motions."""
    real = measured[ENDS].jitter

    def errors(name: str) -> tuple[float, ...]:
        each = measured[name]
        jitter = abs(np.log(max(each.jitter, 1e-9) / max(real, 1e-9)))
        return each.bone_length, each.foot_sliding, jitter, each.nearest_pose

    each = zip(Validity.HEADER, errors(method), errors(than), strict=True)
    return [heading.split(",")[0] for heading, a, b in each if a < b]


def clips_of_pair(
    manifold: MotionManifold, one: LabelledTake, other: LabelledTake
) -> tuple[np.ndarray, np.ndarray]:
    """The features of both from their first frames, the longer one truncated, at most a window."""
    first, second = (manifold.features(take.positions)[0] for take in (one, other))
    frames = min(len(first), len(second), manifold.window)
    return first[:frames], second[:frames]


def _name(take: LabelledTake) -> str:
    content = take.content.replace("_", " ").replace("-", " ")
    return f"{content}, {take.style}" if take.style else content


def pairs_of(takes: list[LabelledTake]) -> dict[str, list[Pair]]:
    """The pairs of each kind that there is, at most `PAIRS`."""
    walks = [take for take in takes if take.content in ("walk", "confident_walk")]
    press_ups = [take for take in takes if "press_up" in take.content]
    styled = [(one, other) for one, other in combinations(walks, 2) if one.style and other.style]
    styles = [(a, b) for a, b in styled if a.source == b.source and a.style != b.style]
    kinds = {}
    for kind, pairs in ((PRESS_UPS, list(product(press_ups, walks))), (STYLES, styles)):
        if count := min(PAIRS, len(pairs)):
            kinds[kind] = [pairs[k * len(pairs) // count] for k in range(count)]
    return kinds
