"""What the filters learned: holden2015, section 6, "Once training is complete …".

How many joints and frames the filters of each layer move, compared with the same network before
training. A filter of the first layer can be drawn as it is, 15 frames of 63 features; a filter of
an upper layer cannot. So at one moment a unit is raised from its mean to its 99th percentile, and
the layers below decode the difference, with tanh⁻¹ and its bound.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.models import ConvLayer
from numpy_cae.motion import JOINTS, PARENTS, POSITIONS

WINDOWS = 64
"""Test windows that give the range of the hidden units."""
CAPTION = "How many joints and frames a filter moves (median; effective numbers by energy):"
HEADER = ("layer", "filters", "silent", "joints", "untrained", "frames", "untrained")
_SILENT = 1e-8


@dataclass(frozen=True)
class Responses:
    """What each filter of a layer adds: `added` (filters, frames, 63), in normalised features."""

    added: np.ndarray

    @property
    def active(self) -> np.ndarray:
        """(filters,) bool: whether a filter adds anything. Other methods leave out those that
        do not."""
        return np.square(self.added).sum(axis=(1, 2)) > _SILENT

    def by_joint(self) -> np.ndarray:
        """The share of a filter's energy in each joint and in the path, (filters, 21)."""
        energy = np.square(self.added[self.active], dtype=np.float64).sum(axis=1)
        joints = energy[:, POSITIONS].reshape(len(energy), len(JOINTS), 3).sum(axis=-1)
        path = energy[:, POSITIONS.stop :].sum(axis=-1, keepdims=True)
        return np.concatenate([joints, path], axis=1) / energy.sum(axis=1, keepdims=True)

    def joints(self) -> np.ndarray:
        """The effective number of joints that a filter moves, (filters,)."""
        return _effective_number(self.by_joint()[:, : len(JOINTS)])

    def frames(self) -> np.ndarray:
        """The effective number of frames that a filter lasts, (filters,)."""
        return _effective_number(np.square(self.added[self.active], dtype=np.float64).sum(axis=2))

    def temporal(self) -> np.ndarray:
        """A filter's correlation, about zero, with itself a frame later, (filters,)."""
        added = self.added[self.active].astype(np.float64)
        now, later = added[:, :-1], added[:, 1:]
        together = np.square(now).sum(axis=(1, 2)) * np.square(later).sum(axis=(1, 2))
        return (now * later).sum(axis=(1, 2)) / np.sqrt(together)

    def between_joints(self) -> np.ndarray:
        """Mean absolute cosine of a joint's movement over time and its parent's, (filters,)."""
        added = self.added[self.active, :, POSITIONS].astype(np.float64)
        joints = added.reshape(*added.shape[:2], len(JOINTS), 3)
        unit = joints / np.linalg.norm(joints, axis=(1, 3), keepdims=True)
        cosines = (unit[:, :, 1:] * unit[:, :, list(PARENTS[1:])]).sum(axis=(1, 3))
        return np.abs(cosines).mean(axis=1)


def _effective_number(energy: np.ndarray) -> np.ndarray:
    """(Σ e)² / Σ e² along the second axis: n where n are equal and the others zero."""
    squares = np.square(energy).sum(axis=1)
    total = energy.sum(axis=1)
    return np.divide(total**2, squares, out=np.zeros_like(total), where=squares > 0)


def responses_of(layers: Sequence[ConvLayer], units: np.ndarray) -> Responses:
    """Raise each unit of the last of the layers (lowest first) and decode through all of them, with
    even unpooling.

    `units` (N, k), its values in many frames, give the means and percentiles.
    """
    reach = sum(len(layer.w) // 2 * 2**n for n, layer in enumerate(layers))
    middle = -(-reach // 2 ** len(layers))
    mean, high = units.mean(axis=0), np.quantile(units, 0.99, axis=0)
    still = np.repeat(mean[None], 2 * middle + 1, axis=0)
    raised = np.repeat(still[None], units.shape[1] + 1, axis=0)  # the last one stays as it is
    filters = np.arange(units.shape[1])
    raised[filters, middle, filters] = high
    for layer in reversed(layers):
        raised, _ = layer.decode_with_pullback(raised.astype(layer.w.dtype))
    return Responses(raised[:-1] - raised[-1])


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure the filters, and those of the same network before training.

    The seed is for the untrained network, where the manifold does not record its own.
    """
    clips = clips_of(manifold, [take.positions for take in material.testing]).evenly(WINDOWS)
    initial = untrained(manifold, manifold.settings.get("seed", seed))
    (now, related), (before, unrelated) = (
        _measured(each.network.layers, clips.x, clips.real) for each in (manifold, initial)
    )
    rows = []
    for n, pair in enumerate(zip(now, before, strict=True), 1):
        active = pair[0].active
        medians = [
            np.median(of(each)) for of in (Responses.joints, Responses.frames) for each in pair
        ]
        rows.append([f"layer {n}", len(active), int((~active).sum()), *medians])
    independent = Claim(
        "The filters correspond to independent components of motion (holden2015, section 6): "
        "their units correlate less than before training.",
        bool(related < unrelated),
        f"two units of the first layer correlate {related:.2f} (mean absolute value), "
        f"untrained {unrelated:.2f}.",
    )
    several, higher = _movements(now, before)
    return Result(
        "What the filters learned",
        [Table(CAPTION, HEADER, rows, ".1f")],
        [_correspondences(now, before), several, independent, higher],
        lambda: _figure(now),
    )


def _measured(
    layers: list[ConvLayer], x: np.ndarray, real: np.ndarray
) -> tuple[list[Responses], float]:
    """The responses of each layer, and the mean absolute correlation of two first-layer units."""
    responses, correlations = [], []
    for n, layer in enumerate(layers, 1):
        x, _ = layer.encode_with_pullback(x)
        units = x[real[:, :: 2**n]]
        responses.append(responses_of(layers[:n], units))
        related = np.abs(np.corrcoef(units.T.astype(np.float64)))
        correlations.append(np.nanmean(related[np.triu_indices(len(related), 1)]))
    return responses, float(correlations[0])


def _movements(now: list[Responses], before: list[Responses]) -> tuple[Claim, Claim]:
    """Of the first layer's filters, and of the layers one after the other."""
    joints, frames = (
        [np.median(of(each)) for each in now] for of in (Responses.joints, Responses.frames)
    )
    several = np.mean((now[0].joints() >= 2) & (now[0].frames() >= 3))
    return (
        Claim(
            "Each filter expresses the movement of several joints over a period of time "
            "(holden2015, section 6).",
            bool(several == 1.0),
            f"{several:.0%} of the first layer's move at least 2 joints for at least 3 frames; "
            f"the median moves {joints[0]:.1f} joints for {frames[0]:.1f} frames, an untrained "
            f"one {np.median(before[0].joints()):.1f} joints.",
        ),
        Claim(
            "Filters on deeper layers represent higher level combinations (holden2015, "
            "section 6): they move more joints for longer, layer by layer.",
            bool(np.all(np.diff(joints) > 0) and np.all(np.diff(frames) > 0)),
            f"median joints {' → '.join(f'{n:.1f}' for n in joints)}, "
            f"frames {' → '.join(f'{n:.1f}' for n in frames)}.",
        ),
    )


def _correspondences(now: list[Responses], before: list[Responses]) -> Claim:
    """Stronger in the median filter of every layer than in 19 of 20 untrained ones."""
    parts, held = [], True
    for name, of in (
        ("in time, with itself a frame later", Responses.temporal),
        ("between joints, of a joint with its parent", Responses.between_joints),
    ):
        medians = [np.median(of(each)) for each in now]
        chance = [np.quantile(of(each), 0.95) for each in before]
        held = held and all(one > other for one, other in zip(medians, chance, strict=True))
        parts.append(
            f"correlation {name}: {', '.join(f'{n:.2f}' for n in medians)} in the layers' median "
            f"filters (19 of 20 untrained are below {', '.join(f'{n:.2f}' for n in chance)})"
        )
    return Claim(
        "Once training is complete the filters express strong temporal and inter-joint "
        "correspondences (holden2015, section 6).",
        bool(held),
        "; ".join(parts) + ".",
    )


def _figure(layers: list[Responses]):
    """The share of each filter's energy at each joint, by layer."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 6), layout="constrained")
    widths = [np.sqrt(each.active.sum()) for each in layers]
    all_axes = figure.subplots(1, len(layers), sharey=True, width_ratios=widths, squeeze=False)[0]
    for n, (axes, each) in enumerate(zip(all_axes, layers, strict=True), 1):
        shares = each.by_joint()
        order = np.lexsort((-shares.max(axis=1), shares.argmax(axis=1)))
        image = axes.imshow(shares[order].T, aspect="auto", cmap="magma", vmin=0, vmax=0.4)
        axes.set_yticks(range(21), [*[joint.replace("_", " ") for joint in JOINTS], "path"])
        axes.set(title=f"layer {n}", xlabel="filters, by their strongest joint")
    figure.colorbar(image, ax=all_axes).set_label("share of a filter's energy")
    return figure
