"""The two inverses of max pooling in use: holden2015, section 5.

    random      the pooled value on one frame of its pair, zero on the other
    even        half of it on both

The paper trains its layers with the first and decodes its results with the second. Here one
trained network decodes the same hidden units with both.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.clips import cut_ends, hold_ends, project_ends_held
from numpy_cae.experiments.example import Example
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.split import testing_of
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import joint_slice
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Curve, curves_figure, save_figure

EVEN, RANDOM, TRUE = "even", "random", "truth"
SHOWN = "left_wrist"


@dataclass(frozen=True)
class TwoUnpoolings:
    """Error in cm and jitter in m/s² by unpooling; the truth has no error."""

    rows: dict[str, tuple[float, float]]
    example: Example
    sample: str
    title: str = "The two unpoolings in use"

    def text(self) -> str:
        """One table."""
        truth = self.rows[TRUE][1]
        lines = [
            [name, f"{error:.2f}", f"{jitter:.2f}", f"{jitter / truth:.2f}"]
            for name, (error, jitter) in self.rows.items()
        ]
        header = ["unpooling", "error, cm", "jitter, m/s²", "of the truth's"]
        return f"{text_table(header, lines)}\n\n{self.sample}"

    def findings(self) -> list[Finding]:
        """The two sentences of section 5."""
        even, random, truth = (self.rows[name][1] for name in (EVEN, RANDOM, TRUE))
        return [
            Finding(
                "Unpooling at random results in some noise (holden2015, section 5; held if the "
                "jitter is more than twice the truth's).",
                random > 2 * truth,
                f"{random:.1f} m/s², truth {truth:.1f}; error {self.rows[RANDOM][0]:.2f} cm.",
            ),
            Finding(
                "Unpooling evenly results in smooth animation with no high-frequency noise "
                "(section 5; held if the jitter is no more than the truth's).",
                even <= truth,
                f"{even:.1f} m/s², truth {truth:.1f}, at random {random:.1f}; error "
                f"{self.rows[EVEN][0]:.2f} cm.",
            ),
        ]

    def save_picture(self, path: str | Path) -> None:
        """The height of a wrist over time, PNG."""
        height = joint_slice(SHOWN).start + 1
        curves = [
            Curve(np.arange(len(x)) / self.example.rate, 100 * x[:, height], label, colour)
            for label, (x, colour) in self.example.motions.items()
        ]
        up = f"height of the {SHOWN.replace('_', ' ')}, cm"
        save_figure(curves_figure(curves, "time, s", up, (9.5, 4.0)), path)

    def save_gif(self, path: str | Path) -> None:
        """Decoded at random, evenly, and the truth."""
        self.example.save_gif(path)


def two_unpoolings(manifold: MotionManifold, material: Material, seed: int = 0) -> TwoUnpoolings:
    """Encode held-out windows, decode them with either unpooling.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
    seed : int
        Of the random places.
    """
    testing, sample = testing_of(manifold, material)
    decoded = {
        RANDOM: decode_at_random(manifold, testing.x, np.random.default_rng(seed)),
        EVEN: project_ends_held(manifold, testing.x),
        TRUE: testing.x,
    }
    rows = {name: (testing.error(x), testing.jitter(x)) for name, x in decoded.items()}
    colours = {RANDOM: CORRUPTED, EVEN: PROJECTED, TRUE: TRUTH}
    motions = {name: (x, colours[name]) for name, x in decoded.items()}
    return TwoUnpoolings(rows, Example.of(testing, testing.typical(), motions), sample)


def decode_at_random(
    manifold: MotionManifold, x: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Φ†(Φ(X)) with every pooled value on one frame of its pair, drawn, (N, T, 63) to the same."""
    y = manifold.network.encode(hold_ends(manifold, x))
    for layer in reversed(manifold.network.layers):
        y, _ = layer.decode_with_pullback(y, rng.random(y.shape) < 0.5)
    return cut_ends(manifold, y, x.shape[1])
