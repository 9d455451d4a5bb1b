"""Interpolation of two motions: holden2015, section 7, "Motion Interpolation".

"We interpolate two distinctly separate motions of doing press ups and walking forward. Compared
to a linear interpolation, which creates an impossible walk, interpolation along the manifold
creates motion which remains valid."

Beside press-ups and walking stand walks of two styles, of which the paper says that PCA "does not
perform well". PCA on windows is linear: between two motions it gives the projection of what linear
interpolation gives.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.baselines import PCA
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.interpolate import TRANSITION, interpolate, shares
from numpy_cae.measures import Validity, ValidityMeasure
from numpy_cae.motion import FEATURES, PARENTS, POSITIONS, cut_windows, features_to_positions
from numpy_cae.motion.windows import LENGTH
from numpy_cae.viz import (
    CORRUPTED,
    PLAIN,
    PROJECTED,
    TRUTH,
    Actor,
    save_figure,
    save_gif,
    strip_figure,
)

SHARES = (0.25, 0.5, 0.75)
SIZE = 200
"""Axes of PCA on windows, the best size for repairing them (`half_zeroed`)."""
PAIRS = 5
"""At most so many pairs of a kind, spread over all that there are."""
LINEAR, PCA_WINDOWS, ALONG = "linear", "PCA on windows", "along the manifold"
METHODS = (LINEAR, PCA_WINDOWS, ALONG)
ENDS, PROJECTED_ENDS = "the two motions", "the two, projected"


@dataclass(frozen=True)
class Pairs:
    """Pairs of one kind, and what was measured on each method's motion between them."""

    kind: str
    count: int
    rows: dict[str, Validity]

    def better(self, method: str, than: str) -> list[str]:
        """The measures on which one method is better than another; of jitter, the one that lies
        nearer to the two motions' own."""
        real = self.rows[ENDS].jitter
        one, other = (_errors(self.rows[name], real) for name in (method, than))
        names = (name.split(",")[0] for name in Validity.HEADER)
        return [name for name, a, b in zip(names, one, other, strict=True) if a < b]


def _errors(measured: Validity, real_jitter: float) -> tuple[float, ...]:
    return (
        measured.bone_length,
        measured.foot_sliding,
        measured.beyond_limits,
        abs(np.log(max(measured.jitter, 1e-9) / max(real_jitter, 1e-9))),
        measured.nearest_pose,
    )


@dataclass(frozen=True)
class Interpolation:
    """The tables, and one pair with the motions between them, as features (F, 63)."""

    pairs: list[Pairs]
    shown: dict[str, np.ndarray]
    rate: float
    title: str = "Interpolation of two motions"

    def text(self) -> str:
        """A table for each kind of pairs."""
        header = ["motion", *Validity.HEADER]
        parts = []
        for pairs in self.pairs:
            table = text_table(header, [[name, *row.cells()] for name, row in pairs.rows.items()])
            shares = ", ".join(map(str, SHARES))
            parts.append(f"{pairs.kind}, {pairs.count} pairs, s = {shares} and 0 to 1:\n\n{table}")
        return "\n\n".join(parts)

    def findings(self) -> list[Finding]:
        """What the paper says of a linear interpolation, and of PCA."""
        claims = (
            (
                PRESS_UPS,
                ALONG,
                LINEAR,
                "Compared to a linear interpolation of press-ups and walking, which creates an "
                "impossible walk, interpolation along the manifold creates motion which remains "
                "valid (holden2015, section 7).",
            ),
            (
                STYLES,
                ALONG,
                PCA_WINDOWS,
                "PCA does not perform well when interpolating motions of different style "
                "(holden2015, section 7).",
            ),
        )
        return [
            self._finding(pairs, method, than, claim)
            for kind, method, than, claim in claims
            for pairs in self.pairs
            if pairs.kind == kind
        ]

    def _finding(self, pairs: Pairs, method: str, than: str, claim: str) -> Finding:
        better = pairs.better(method, than)
        own, other = pairs.rows[method], pairs.rows[than]
        figures = "; ".join(
            f"{name} {a} against {b}"
            for name, a, b in zip(Validity.HEADER, own.cells(), other.cells(), strict=True)
        )
        return Finding(
            claim,
            len(better) == len(Validity.HEADER),
            f"{method} is better than {than} on {len(better)} of {len(Validity.HEADER)} "
            f"measures ({', '.join(better) or 'none'}): {figures}. Held means on all of them.",
        )

    def save_picture(self, path: str | Path) -> None:
        """Strips: the two motions, and those halfway between them."""
        local = {name: x[:, POSITIONS].reshape(len(x), -1, 3) for name, x in self.shown.items()}
        save_figure(strip_figure(_actors(local), self.rate, azimuth=75.0), path)

    def save_gif(self, path: str | Path) -> None:
        """The same, moving."""
        world = {name: features_to_positions(x) for name, x in self.shown.items()}
        save_gif(_actors(world), path, self.rate, azimuth=75.0, seconds=5.0)


def _actors(motions: dict[str, np.ndarray]) -> list[Actor]:
    colours = {LINEAR: CORRUPTED, PCA_WINDOWS: PLAIN, ALONG: PROJECTED}
    return [Actor(x, PARENTS, name, colours.get(name, TRUTH)) for name, x in motions.items()]


def interpolation(manifold: MotionManifold, material: Material, seed: int = 0) -> Interpolation:
    """Interpolate pairs of test takes linearly, in PCA's space, and along the manifold both ways.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        PCA, joint limits and nearest poses are of its training takes.
    seed : int
        Unused: nothing is drawn.

    Raises
    ------
    ValueError
        If the test takes have neither press-ups and walking nor walks of two styles.
    """
    kinds = {kind: found for kind, find in PAIRS_OF.items() if (found := find(material.testing))}
    if not kinds:
        raise ValueError(
            "the test takes hold neither press-ups and walking nor walks of two styles"
        )
    training = [manifold.features(take.positions)[0] for take in material.training]
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    between = _methods(manifold, training)
    pairs, shown = [], None
    for kind, found in kinds.items():
        clips = [clips_of_pair(manifold, *pair) for pair in found]
        pairs.append(Pairs(kind, len(clips), _measured(manifold, measure, between, clips)))
        if shown is None:
            one, other = clips[0]
            shown = {_name(take): x for take, x in zip(found[0], clips[0], strict=True)}
            shown |= {name: way(one, other)(0.5) for name, way in between.items()}
    return Interpolation(pairs, shown, manifold.rate)


Way = Callable[[np.ndarray, np.ndarray], Callable[[float | str], np.ndarray]]
"""From two motions to the motion between them by share."""


def _methods(manifold: MotionManifold, training: list[np.ndarray]) -> dict[str, Way]:
    length = manifold.settings.get("window", LENGTH)
    cut = [cut_windows(take, length, length // 2)[0] for take in training]
    windows = manifold.normalise(np.concatenate(cut)).reshape(-1, length * FEATURES)
    pca = PCA.fit(windows.astype(np.float64))

    def linear(one: np.ndarray, other: np.ndarray) -> Callable[[float | str], np.ndarray]:
        def at(share: float | str) -> np.ndarray:
            s = shares(share, len(one))
            return (1 - s) * one + s * other

        return at

    def along_pca(one: np.ndarray, other: np.ndarray) -> Callable[[float | str], np.ndarray]:
        def at(share: float | str) -> np.ndarray:
            mixed, _ = cut_windows(linear(one, other)(share), length, 0)
            rows = manifold.normalise(mixed).reshape(len(mixed), -1)
            projected = manifold.denormalise(pca.project(rows, SIZE).reshape(mixed.shape))
            return projected[0, : len(one)]

        return at

    return {
        LINEAR: linear,
        PCA_WINDOWS: along_pca,
        ALONG: lambda one, other: lambda share: interpolate(manifold, one, other, share),
    }


def _measured(
    manifold: MotionManifold,
    measure: ValidityMeasure,
    between: dict[str, Way],
    clips: list[tuple[np.ndarray, np.ndarray]],
) -> dict[str, Validity]:
    ends = [clip for pair in clips for clip in pair]
    rows = {
        ENDS: Validity.mean([measure.of(clip) for clip in ends]),
        PROJECTED_ENDS: Validity.mean([measure.of(manifold.project(clip)) for clip in ends]),
    }
    for name, way in between.items():
        ways = [way(*pair) for pair in clips]
        made = [at(share) for at in ways for share in (*SHARES, TRANSITION)]
        rows[name] = Validity.mean([measure.of(clip) for clip in made])
    return rows


def clips_of_pair(
    manifold: MotionManifold, one: LabelledTake, other: LabelledTake
) -> tuple[np.ndarray, np.ndarray]:
    """The features of both from their first frames on, as long as the shorter, a window at most."""
    first, second = (manifold.features(take.positions)[0] for take in (one, other))
    frames = min(len(first), len(second), manifold.settings.get("window", LENGTH))
    return first[:frames], second[:frames]


def _name(take: LabelledTake) -> str:
    named = take.content.replace("_", " ").replace("-", " ")
    return f"{named}, {take.style}" if take.style else named


def _walks(takes: list[LabelledTake]) -> list[LabelledTake]:
    return [take for take in takes if take.content in ("walk", "confident_walk")]


def _press_ups_and_walks(takes: list[LabelledTake]) -> list[tuple[LabelledTake, LabelledTake]]:
    down = [take for take in takes if "press_up" in take.content]
    return _spread([(one, other) for one in down for other in _walks(takes)])


def _walks_of_two_styles(takes: list[LabelledTake]) -> list[tuple[LabelledTake, LabelledTake]]:
    walks = [take for take in _walks(takes) if take.style]
    pairs = [(one, other) for n, one in enumerate(walks) for other in walks[n + 1 :]]
    return _spread([(a, b) for a, b in pairs if a.source == b.source and a.style != b.style])


def _spread(pairs: list) -> list:
    return [pairs[k * len(pairs) // PAIRS] for k in range(PAIRS)] if len(pairs) > PAIRS else pairs


PRESS_UPS, STYLES = "press-ups and walking", "walks of two styles"
PAIRS_OF = {PRESS_UPS: _press_ups_and_walks, STYLES: _walks_of_two_styles}
