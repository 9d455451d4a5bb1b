"""What the filters learned: holden2015, section 6, "Once training is complete …".

Temporal pictures, the filters of the first layer as they are, and inter-joint pictures, the energy
that the filters of each layer send to each joint. Beside them stand the numbers of the same network
before training: that a filter moves several joints is true of random filters too.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.filters.responses import LIMBS, PATH, Responses, encoded, responses_of
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import JOINTS
from numpy_cae.viz import save_figure

ENOUGH = 64
"""Windows that the filters are shown."""
TURNED = 0.9
"""A filter whose cosine with its first draw is below this has learned something else."""


@dataclass(frozen=True)
class Look:
    """One network, looked at.

    Parameters
    ----------
    weights : list of (taps, below, k) arrays, one a layer
    layers : list of Responses, one a layer
    alike : float
        Mean absolute correlation of two first-layer units over the held-out frames.
    """

    weights: list[np.ndarray]
    layers: list[Responses]
    alike: float


@dataclass(frozen=True)
class Filters:
    """The trained network and what it was before."""

    trained: Look
    before: Look
    title: str = "What the filters learned"

    def text(self) -> str:
        """How many joints and frames a filter moves, layer by layer, and which limbs."""
        spread = [
            [f"layer {n}", str(len(one.heard)), str((~one.heard).sum()),
             *[f"{np.median(each):.1f}" for each in (
                 one.joints(), other.joints(), one.frames(), other.frames())],
             *[f"{look.by_limb().max(axis=1).mean():.0%}" for look in (one, other)]]
            for n, (one, other) in enumerate(
                zip(self.trained.layers, self.before.layers, strict=True), 1)
        ]  # fmt: skip
        header = ["layer", "filters", "silent", "joints", "untrained", "frames", "untrained",
                  "strongest limb", "untrained"]  # fmt: skip
        limbs = [
            [f"layer {n}", *[f"{share:.0%}" for share in each.by_limb().mean(axis=0)]]
            for n, each in enumerate(self.trained.layers, 1)
        ]
        strongest = [
            [f"layer {n}", *[str(count) for count in np.bincount(
                each.by_limb().argmax(axis=1), minlength=len(LIMBS))]]
            for n, each in enumerate(self.trained.layers, 1)
        ]  # fmt: skip
        return (
            "How many joints and frames a filter moves (median; a joint or frame counts by its "
            "share of the energy), and the share of its strongest limb:\n\n"
            f"{text_table(header, spread)}\n\nThe share of the filters' energy in each limb:\n\n"
            f"{text_table(['layer', *LIMBS], limbs)}\n\nFilters of which a limb is the strongest:"
            f"\n\n{text_table(['layer', *LIMBS], strongest)}\n\n{self._kept()}"
        )

    def _kept(self) -> str:
        """How much of the first draw is still there."""
        cosines = []
        for now, old in zip(self.trained.weights, self.before.weights, strict=True):
            lengths = np.linalg.norm(now, axis=(0, 1)) * np.linalg.norm(old, axis=(0, 1))
            cosines.append((now * old).sum(axis=(0, 1)) / lengths)
        return (
            "Cosine of a filter and what it was drawn as before training, median, and how many "
            f"filters are below {TURNED}: "
            + "; ".join(
                f"layer {n} {np.median(each):.2f}, {np.sum(each < TURNED)} of {len(each)}"
                for n, each in enumerate(cosines, 1)
            )
            + "."
        )

    def findings(self) -> list[Finding]:
        """The sentences of section 6."""
        now, before = self.trained, self.before
        joints, frames = ([np.median(f(each)) for each in now.layers]
                          for f in (Responses.joints, Responses.frames))  # fmt: skip
        first = now.layers[0]
        several = np.mean((first.joints() >= 2) & (first.frames() >= 3))
        return [
            self._correspondences(),
            Finding(
                "Each filter expresses the movement of several joints over a period of time "
                "(holden2015, section 6).",
                bool(several == 1.0),
                f"{several:.0%} of the first layer's move at least 2 joints for at least 3 frames; "
                f"the median moves {joints[0]:.1f} joints for {frames[0]:.1f} frames, an untrained "
                f"one {np.median(before.layers[0].joints()):.1f} joints.",
            ),
            Finding(
                "The filters correspond to independent components of motion (holden2015, "
                "section 6): their units say less of one another than before training.",
                bool(now.alike < before.alike),
                f"two units of the first layer correlate {now.alike:.2f} (mean absolute value), "
                f"untrained {before.alike:.2f}.",
            ),
            Finding(
                "Filters on deeper layers represent higher level combinations (holden2015, "
                "section 6): they move more joints for longer, layer by layer.",
                bool(np.all(np.diff(joints) > 0) and np.all(np.diff(frames) > 0)),
                f"median joints {' → '.join(f'{n:.1f}' for n in joints)}, "
                f"frames {' → '.join(f'{n:.1f}' for n in frames)}.",
            ),
        ]

    def _correspondences(self) -> Finding:
        """Stronger in the median filter of every layer than in 19 of 20 untrained ones."""
        said, held = [], True
        for name, of in (
            ("in time, with itself a frame later", Responses.temporal),
            ("between joints, of a joint with its parent", Responses.between_joints),
        ):
            now = [np.median(of(each)) for each in self.trained.layers]
            chance = [np.quantile(of(each), 0.95) for each in self.before.layers]
            held = held and all(one > other for one, other in zip(now, chance, strict=True))
            said.append(
                f"correlation {name}: {', '.join(f'{n:.2f}' for n in now)} in the layers' median "
                f"filters (19 of 20 untrained are below {', '.join(f'{n:.2f}' for n in chance)})"
            )
        return Finding(
            "Once training is complete the filters express strong temporal and inter-joint "
            "correspondences (holden2015, section 6).",
            bool(held),
            "; ".join(said) + ".",
        )

    def save_picture(self, path: str | Path) -> None:
        """Above first-layer filters, tap by tap; below the energy at each joint, by layer, PNG."""
        figure = Figure(figsize=(15, 15))
        above, below = figure.subfigures(2, 1, height_ratios=[0.6, 0.4])
        self._draw_filters(above)
        self._draw_joints(below)
        save_figure(figure, path)

    def _draw_filters(self, figure) -> None:
        """The filter that is most about each limb, one row a feature, named by joint."""
        heard = np.flatnonzero(self.trained.layers[0].heard)
        shares = self.trained.layers[0].by_limb()
        chosen = heard[shares.argmax(axis=0)]
        all_axes = figure.subplots(1, len(LIMBS), sharey=True)
        figure.subplots_adjust(0.09, 0.06, 0.99, 0.93, wspace=0.06)
        figure.suptitle("First-layer filters: the one that is most about each limb", fontsize=11)
        names = [joint.replace("_", " ") for joint in JOINTS]
        for axes, limb, place in zip(all_axes, LIMBS, chosen, strict=True):
            w = self.trained.weights[0][:, :, place].T
            widest = np.abs(w).max()
            axes.imshow(w, aspect="auto", cmap="RdBu_r", vmin=-widest, vmax=widest)
            half = w.shape[1] // 2
            axes.set_xticks([0, half, 2 * half], [str(-half), "0", str(half)])
            axes.set_xlabel("frames")
            axes.set_title(f"{limb} (filter {place + 1})", fontsize=9)
            for edge in range(3, len(w), 3):
                thick = 1.2 if edge % 12 == 0 else 0.3
                axes.axhline(edge - 0.5, color="black", linewidth=thick)
            axes.set_yticks([*range(1, 60, 3), 60, 61, 62], [*names, "go x", "go z", "turn"])
            axes.tick_params(labelsize=8)

    def _draw_joints(self, figure) -> None:
        names = [*[joint.replace("_", " ") for joint in JOINTS], PATH]
        widths = [np.sqrt(each.heard.sum()) for each in self.trained.layers]
        all_axes = figure.subplots(1, len(widths), sharey=True, width_ratios=widths)
        figure.subplots_adjust(0.09, 0.08, 0.93, 0.92, wspace=0.05)
        for n, (axes, each) in enumerate(
            zip(np.atleast_1d(all_axes), self.trained.layers, strict=True), 1
        ):
            shares = each.by_joint()
            order = np.lexsort((-shares.max(axis=1), each.by_limb().argmax(axis=1)))
            shown = axes.imshow(
                shares[order].T, aspect="auto", cmap="magma", vmin=0, vmax=0.4, interpolation="none"
            )
            axes.set_yticks(range(len(names)), names, fontsize=8)
            axes.set_title(f"layer {n}: energy at each joint", fontsize=9)
            axes.set_xlabel("filters, by their strongest limb")
            for edge in range(4, len(names), 4):
                axes.axhline(edge - 0.5, color="white", linewidth=0.6)
        bar = figure.add_axes((0.945, 0.08, 0.012, 0.84))
        figure.colorbar(shown, cax=bar).set_label("share of a filter's energy")


def filters(manifold: MotionManifold, material: Material, seed: int = 0) -> Filters:
    """Look at the filters, and at those of the same network before training.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        Its testing takes say how high the hidden units go.
    seed : int
        Of the untrained network, where the manifold does not know its own.
    """
    clips = clips_of(manifold, [take.positions for take in material.testing]).evenly(ENOUGH)
    # The seed of its training draws the very weights that it began with.
    before = untrained(manifold, manifold.settings.get("seed", seed))
    return Filters(*[_look(each.network, clips.x, clips.real) for each in (manifold, before)])


def _look(network: ConvAutoencoder, x: np.ndarray, real: np.ndarray) -> Look:
    layers = network.layers
    units = [each[real[:, :: 2 ** (n + 1)]] for n, each in enumerate(encoded(layers, x))]
    responses = [responses_of(layers[: n + 1], each) for n, each in enumerate(units)]
    related = np.abs(np.corrcoef(units[0].T.astype(np.float64)))
    pairs = np.triu_indices(len(related), 1)
    return Look([layer.w for layer in layers], responses, float(np.nanmean(related[pairs])))
