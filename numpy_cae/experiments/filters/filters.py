"""What the filters learned: holden2015, section 6, "Once training is complete …".

The filters of the first layer over time, and the energy that the filters of each layer add to each
joint, compared with the same network before training.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.filters.responses import LIMBS, PATH, Responses, encoded, responses_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import JOINTS

WINDOWS = 64
"""Test windows that give the range of the hidden units."""
CHANGED = 0.9
"""A filter whose cosine with its initial weights is below this has changed."""
SPREAD = (
    "How many joints and frames a filter moves (median; effective numbers by energy), and the "
    "share of its strongest limb:"
)
SPREAD_HEADER = ("layer", "filters", "silent", "joints", "untrained", "frames", "untrained",
                 "strongest limb", "untrained")  # fmt: skip
SPREAD_FORMATS = ("", "", "", ".1f", ".1f", ".1f", ".1f", ".0%", ".0%")


@dataclass(frozen=True)
class Measured:
    """One network.

    Parameters
    ----------
    weights : list of (taps, below, k) arrays, one for each layer
    layers : list of Responses, one for each layer
    correlation : float
        Mean absolute correlation of two first-layer units over test frames.
    """

    weights: list[np.ndarray]
    layers: list[Responses]
    correlation: float


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure the filters, and those of the same network before training.

    The seed is for the untrained network, where the manifold does not record its own.
    """
    clips = clips_of(manifold, [take.positions for take in material.testing]).evenly(WINDOWS)
    before = untrained(manifold, manifold.settings.get("seed", seed))  # its initial weights
    now, before = [_measured(each.network, clips.x, clips.real) for each in (manifold, before)]
    spread, limbs, strongest = [], [], []
    for n, (each, old) in enumerate(zip(now.layers, before.layers, strict=True), 1):
        pairs = [
            *(float(np.median(of(one))) for of in (Responses.joints, Responses.frames)
              for one in (each, old)),
            *(float(one.by_limb().max(axis=1).mean()) for one in (each, old)),
        ]  # fmt: skip
        active = each.active
        spread.append([f"layer {n}", len(active), int((~active).sum()), *pairs])
        limbs.append([f"layer {n}", *each.by_limb().mean(axis=0)])
        counts = np.bincount(each.by_limb().argmax(axis=1), minlength=len(LIMBS))
        strongest.append([f"layer {n}", *counts.tolist()])
    header = ["layer", *LIMBS]
    return Result(
        "What the filters learned",
        [
            Table(SPREAD, SPREAD_HEADER, spread, SPREAD_FORMATS),
            Table("The share of the filters' energy in each limb:", header, limbs, ".0%"),
            Table("Filters whose strongest limb it is:", header, strongest),
        ],
        _claims(now, before),
        lambda: _figure(now),
        note=_change(now, before),
    )


def _measured(network: ConvAutoencoder, x: np.ndarray, real: np.ndarray) -> Measured:
    layers = network.layers
    units = [each[real[:, :: 2 ** (n + 1)]] for n, each in enumerate(encoded(layers, x))]
    responses = [responses_of(layers[: n + 1], each) for n, each in enumerate(units)]
    related = np.abs(np.corrcoef(units[0].T.astype(np.float64)))
    pairs = np.triu_indices(len(related), 1)
    return Measured([layer.w for layer in layers], responses, float(np.nanmean(related[pairs])))


def _change(now: Measured, before: Measured) -> str:
    """How far the weights are from their initial values."""
    parts = []
    for n, (w, old) in enumerate(zip(now.weights, before.weights, strict=True), 1):
        norms = np.linalg.norm(w, axis=(0, 1)) * np.linalg.norm(old, axis=(0, 1))
        cosine = (w * old).sum(axis=(0, 1)) / norms
        changed = np.sum(cosine < CHANGED)
        parts.append(f"layer {n} {np.median(cosine):.2f}, {changed} of {len(cosine)}")
    return (
        "Median cosine of a filter and its initial weights, and how many filters are below "
        f"{CHANGED}: {'; '.join(parts)}."
    )


def _claims(now: Measured, before: Measured) -> list[Claim]:
    joints, frames = (
        [np.median(of(each)) for each in now.layers] for of in (Responses.joints, Responses.frames)
    )
    first = now.layers[0]
    several = np.mean((first.joints() >= 2) & (first.frames() >= 3))
    return [
        _correspondences(now, before),
        Claim(
            "Each filter expresses the movement of several joints over a period of time "
            "(holden2015, section 6).",
            bool(several == 1.0),
            f"{several:.0%} of the first layer's move at least 2 joints for at least 3 frames; "
            f"the median moves {joints[0]:.1f} joints for {frames[0]:.1f} frames, an untrained "
            f"one {np.median(before.layers[0].joints()):.1f} joints.",
        ),
        Claim(
            "The filters correspond to independent components of motion (holden2015, section 6): "
            "their units correlate less than before training.",
            bool(now.correlation < before.correlation),
            f"two units of the first layer correlate {now.correlation:.2f} (mean absolute value), "
            f"untrained {before.correlation:.2f}.",
        ),
        Claim(
            "Filters on deeper layers represent higher level combinations (holden2015, "
            "section 6): they move more joints for longer, layer by layer.",
            bool(np.all(np.diff(joints) > 0) and np.all(np.diff(frames) > 0)),
            f"median joints {' → '.join(f'{n:.1f}' for n in joints)}, "
            f"frames {' → '.join(f'{n:.1f}' for n in frames)}.",
        ),
    ]


def _correspondences(now: Measured, before: Measured) -> Claim:
    """Stronger in the median filter of every layer than in 19 of 20 untrained ones."""
    parts, held = [], True
    for name, of in (
        ("in time, with itself a frame later", Responses.temporal),
        ("between joints, of a joint with its parent", Responses.between_joints),
    ):
        medians = [np.median(of(each)) for each in now.layers]
        chance = [np.quantile(of(each), 0.95) for each in before.layers]
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


def _figure(measured: Measured):
    """First-layer filters over time, above; the energy at each joint, by layer, below."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 15))
    above, below = figure.subfigures(2, 1, height_ratios=[0.6, 0.4])
    _draw_filters(above, measured)
    _draw_joints(below, measured)
    return figure


def _draw_filters(figure, measured: Measured) -> None:
    """For each limb the filter with the largest share of it: a row for each feature."""
    first = measured.layers[0]
    chosen = np.flatnonzero(first.active)[first.by_limb().argmax(axis=0)]
    all_axes = figure.subplots(1, len(LIMBS), sharey=True)
    figure.subplots_adjust(0.09, 0.06, 0.99, 0.93, wspace=0.06)
    figure.suptitle("First-layer filters: the one with the largest share of each limb", fontsize=11)
    names = [joint.replace("_", " ") for joint in JOINTS]
    for axes, limb, place in zip(all_axes, LIMBS, chosen, strict=True):
        w = measured.weights[0][:, :, place].T
        largest = np.abs(w).max()
        axes.imshow(w, aspect="auto", cmap="RdBu_r", vmin=-largest, vmax=largest)
        half = w.shape[1] // 2
        axes.set_xticks([0, half, 2 * half], [str(-half), "0", str(half)])
        axes.set_xlabel("frames")
        axes.set_title(f"{limb} (filter {place + 1})", fontsize=9)
        for edge in range(3, len(w), 3):
            axes.axhline(edge - 0.5, color="black", linewidth=1.2 if edge % 12 == 0 else 0.3)
        axes.set_yticks([*range(1, 60, 3), 60, 61, 62], [*names, "v x", "v z", "rotation"])
        axes.tick_params(labelsize=8)


def _draw_joints(figure, measured: Measured) -> None:
    names = [*[joint.replace("_", " ") for joint in JOINTS], PATH]
    widths = [np.sqrt(each.active.sum()) for each in measured.layers]
    all_axes = figure.subplots(1, len(widths), sharey=True, width_ratios=widths, squeeze=False)[0]
    figure.subplots_adjust(0.09, 0.08, 0.93, 0.92, wspace=0.05)
    for n, (axes, each) in enumerate(zip(all_axes, measured.layers, strict=True), 1):
        shares = each.by_joint()
        order = np.lexsort((-shares.max(axis=1), each.by_limb().argmax(axis=1)))
        image = axes.imshow(
            shares[order].T, aspect="auto", cmap="magma", vmin=0, vmax=0.4, interpolation="none"
        )
        axes.set_yticks(range(len(names)), names, fontsize=8)
        axes.set_title(f"layer {n}: energy at each joint", fontsize=9)
        axes.set_xlabel("filters, by their strongest limb")
        for edge in range(4, len(names), 4):
            axes.axhline(edge - 0.5, color="white", linewidth=0.6)
    bar = figure.add_axes((0.945, 0.08, 0.012, 0.84))
    figure.colorbar(image, cax=bar).set_label("share of a filter's energy")
