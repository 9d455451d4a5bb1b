"""What the filters learned: holden2015, section 6, "Once training is complete …".

How many joints and frames the filters of each layer move, compared with the same network before
training.
"""

from dataclasses import dataclass

import numpy as np

from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.filters.responses import Responses, encoded, responses_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import JOINTS

WINDOWS = 64
"""Test windows that give the range of the hidden units."""
CAPTION = "How many joints and frames a filter moves (median; effective numbers by energy):"
HEADER = ("layer", "filters", "silent", "joints", "untrained", "frames", "untrained")


@dataclass(frozen=True)
class Measured:
    """The responses of one network's layers, and the mean absolute correlation of two first-layer
    units over test frames."""

    layers: list[Responses]
    correlation: float


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure the filters, and those of the same network before training.

    The seed is for the untrained network, where the manifold does not record its own.
    """
    clips = clips_of(manifold, [take.positions for take in material.testing]).evenly(WINDOWS)
    before = untrained(manifold, manifold.settings.get("seed", seed))  # its initial weights
    now, before = [_measured(each.network, clips.x, clips.real) for each in (manifold, before)]
    rows = []
    for n, pair in enumerate(zip(now.layers, before.layers, strict=True), 1):
        active = pair[0].active
        medians = [
            np.median(of(each)) for of in (Responses.joints, Responses.frames) for each in pair
        ]
        rows.append([f"layer {n}", len(active), int((~active).sum()), *medians])
    return Result(
        "What the filters learned",
        [Table(CAPTION, HEADER, rows, ".1f")],
        _claims(now, before),
        lambda: _figure(now.layers),
    )


def _measured(network: ConvAutoencoder, x: np.ndarray, real: np.ndarray) -> Measured:
    layers = network.layers
    units = [each[real[:, :: 2 ** (n + 1)]] for n, each in enumerate(encoded(layers, x))]
    responses = [responses_of(layers[: n + 1], each) for n, each in enumerate(units)]
    related = np.abs(np.corrcoef(units[0].T.astype(np.float64)))
    pairs = np.triu_indices(len(related), 1)
    return Measured(responses, float(np.nanmean(related[pairs])))


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
