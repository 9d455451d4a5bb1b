"""Projection that keeps bones, feet, ground and pins, beside the plain one: what holden2015,
section 7, leaves to the future.

Pins: a wrist wanted 15 cm above where the plain projection has it, for half a second; and the hips
on the path that they really went, from which the sum of a half zeroed motion's velocities strays.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.beyond import Pins, project_constrained
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import LabelledTake, Material, evenly
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.measures import bone_length_error, position_error
from numpy_cae.motion import JOINTS, PARENTS, RootTransform, features_to_positions
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.training import zero_values
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH, Actor, save_figure, save_gif, strip_figure

TAKES = 6
"""Of each source, spread over all test takes; a descent takes about a second."""
LONGEST = 320
P = 0.5
PINNED = 3
"""Takes of each source that are pinned."""
WRIST, HALF_A_SECOND, ABOVE = JOINTS.index("left_wrist"), 15, 0.15
NEAR = 2.0
"""cm within which a pin counts as followed."""
PLAIN_ROW, KEPT_ROW, TRUE_ROW = "plain projection", "constrained projection", "the motion itself"


@dataclass(frozen=True)
class Row:
    """Means over takes: position error, cm; bone length error, cm and % of the bones' mean length;
    speed of a foot in contact, cm/s."""

    position: float
    bones: float
    share: float
    sliding: float


@dataclass(frozen=True)
class PinnedRow:
    """Means over takes, cm: how far the pinned wrist is off, how far the hips are off their path;
    bones; and the speed of a foot in contact, cm/s."""

    wrist: float
    path: float
    bones: float
    sliding: float


@dataclass(frozen=True)
class ConstrainedProjection:
    """A table for each source and input, one of pins for each source, and one take as features
    (F, 63) with its start."""

    tables: dict[str, dict[str, Row]]
    pinned: dict[str, dict[str, PinnedRow]]
    shown: dict[str, np.ndarray]
    start: RootTransform
    rate: float
    title: str = "Constrained projection: bones, feet, ground and pins"

    def text(self) -> str:
        """Every table."""
        header = ["method", "position, cm", "bone length, cm", "of it, %", "sliding, cm/s"]
        parts = []
        for name, rows in self.tables.items():
            lines = [
                [
                    method,
                    f"{row.position:.2f}",
                    f"{row.bones:.3f}",
                    f"{row.share:.3f}",
                    f"{row.sliding:.2f}",
                ]
                for method, row in rows.items()
            ]
            parts.append(f"{name}:\n\n{text_table(header, lines)}")
        header = ["wrist and path pinned", "wrist, cm", "path, cm", "bone length, cm",
                  "sliding, cm/s"]  # fmt: skip
        lines = [
            [f"{source}: {method}", f"{row.wrist:.2f}", f"{row.path:.2f}", f"{row.bones:.3f}",
             f"{row.sliding:.2f}"]
            for source, rows in self.pinned.items() for method, row in rows.items()
        ]  # fmt: skip
        parts.append(f"Half zeroed, how far from the pins:\n\n{text_table(header, lines)}")
        return "\n\n".join(parts)

    def findings(self) -> list[Finding]:
        """The three things that were to be reached, for every table."""
        found = []
        for name, rows in self.tables.items():
            plain, kept = rows[PLAIN_ROW], rows[KEPT_ROW]
            reached = (
                kept.share < 0.1
                and kept.sliding <= plain.sliding / 5
                and kept.position <= plain.position
            )
            found.append(
                Finding(
                    "A constrained projection can keep joint lengths (to 0.1%) and ground contact "
                    "(a fifth of the sliding) at no cost in position (holden2015, section 7: "
                    f"future work), {name}.",
                    reached,
                    f"bones {plain.share:.2f}% off before, {kept.share:.1e}% after; feet slide "
                    f"{plain.sliding:.2f} cm/s before, {kept.sliding:.2f} after; position "
                    f"{plain.position:.2f} cm before, {kept.position:.2f} after.",
                )
            )
        for source, rows in self.pinned.items():
            plain, kept = rows[PLAIN_ROW], rows[KEPT_ROW]
            found += [
                Finding(
                    f"It follows pins, a wrist at a point and the hips on a path, to {NEAR:g} cm "
                    f"on average (not in the paper), {source}.",
                    max(kept.wrist, kept.path) < NEAR,
                    f"wrist {plain.wrist:.2f} cm off before, {kept.wrist:.2f} after; path "
                    f"{plain.path:.2f} cm before, {kept.path:.2f} after.",
                ),
                Finding(
                    f"Where it follows pins feet slide a fifth as much too, {source}.",
                    kept.sliding <= plain.sliding / 5,
                    f"{plain.sliding:.2f} cm/s before, {kept.sliding:.2f} after.",
                ),
            ]
        return found

    def save_picture(self, path: str | Path) -> None:
        """Strips of the motion, its plain and its constrained projection."""
        save_figure(strip_figure(self._actors(), self.rate, azimuth=75.0), path)

    def save_gif(self, path: str | Path) -> None:
        """The same, moving."""
        save_gif(self._actors(), path, self.rate, azimuth=75.0, seconds=5.0)

    def _actors(self) -> list[Actor]:
        colours = {PLAIN_ROW: PLAIN, KEPT_ROW: PROJECTED, TRUE_ROW: TRUTH}
        return [
            Actor(features_to_positions(x, self.start), PARENTS, name, colours[name])
            for name, x in self.shown.items()
        ]


def constrained_projection(
    manifold: MotionManifold, material: Material, seed: int = 0
) -> ConstrainedProjection:
    """Project test takes, as they are and half zeroed, plainly and constrained.

    Sliding is measured in the contacts that the constraint was given: those found in the plain
    projection, for the truth is not at hand where a motion has to be repaired.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
    seed : int
        Of the lost values.
    """
    tables, pinned, shown = {}, {}, None
    for source in dict.fromkeys(take.source for take in material.testing):
        takes = evenly(material.of(source).testing, TAKES)
        for lost, name in ((0.0, "as they are"), (P, "half zeroed")):
            rng = np.random.default_rng(seed)
            measured = [_measured(manifold, take, lost, rng) for take in takes]
            tables[f"{source}, {len(takes)} takes {name}"] = {
                method: Row(*np.mean([rows[method] for rows, *_ in measured], axis=0))
                for method in (TRUE_ROW, PLAIN_ROW, KEPT_ROW)
            }
            shown = shown or measured[0]
        rng = np.random.default_rng(seed)
        measured = [_pinned(manifold, take, rng) for take in evenly(takes, PINNED)]
        pinned[f"{source}, {len(measured)} takes"] = {
            method: PinnedRow(*np.mean([rows[method] for rows in measured], axis=0))
            for method in (PLAIN_ROW, KEPT_ROW)
        }
    _, motions, start = shown
    return ConstrainedProjection(tables, pinned, motions, start, manifold.rate)


def _measured(manifold: MotionManifold, take: LabelledTake, lost: float, rng: np.random.Generator):
    features, start = manifold.features(take.positions[:LONGEST])
    given = manifold.denormalise(zero_values(manifold.normalise(features), lost, rng))
    plain = manifold.project(given, manifold.shifts)
    contacts = find_contacts(features_to_positions(plain, start), manifold.rate)
    kept = project_constrained(manifold, given, start, contacts)
    motions = {TRUE_ROW: features, PLAIN_ROW: plain, KEPT_ROW: kept}
    rows = {
        name: _row(manifold, motion, features, start, contacts) for name, motion in motions.items()
    }
    return rows, motions, start


def _pinned(manifold: MotionManifold, take: LabelledTake, rng: np.random.Generator):
    features, start = manifold.features(take.positions[:LONGEST])
    given = manifold.denormalise(zero_values(manifold.normalise(features), P, rng))
    plain = manifold.project(given, manifold.shifts)
    before = features_to_positions(plain, start)
    contacts = find_contacts(before, manifold.rate)
    middle = slice(len(plain) // 2, len(plain) // 2 + HALF_A_SECOND)
    targets, weights = np.zeros(before.shape), np.zeros(before.shape)
    targets[middle, WRIST] = before[len(plain) // 2, WRIST] + [0.0, ABOVE, 0.0]
    weights[middle, WRIST] = 1.0
    targets[:, 0] = features_to_positions(features, start)[:, 0]
    weights[:, 0, [0, 2]] = 1.0
    kept = project_constrained(manifold, given, start, contacts, Pins(targets, weights))

    def row(motion: np.ndarray) -> tuple[float, float, float, float]:
        positions = features_to_positions(motion, start)
        off = 100 * np.sqrt(np.sum(weights * (positions - targets) ** 2, axis=-1))
        _, bones, _, sliding = _row(manifold, motion, features, start, contacts)
        return off[middle, WRIST].mean(), off[:, 0].mean(), bones, sliding

    return {PLAIN_ROW: row(plain), KEPT_ROW: row(kept)}


def _row(
    manifold: MotionManifold,
    motion: np.ndarray,
    truth: np.ndarray,
    start: RootTransform,
    contacts: np.ndarray,
) -> tuple[float, float, float, float]:
    positions = features_to_positions(motion, start)
    bones = bone_length_error(positions, manifold.lengths)
    steps = np.linalg.norm(np.diff(positions[:, FEET][..., [0, 2]], axis=0), axis=-1)
    stands = contacts[1:] & contacts[:-1]
    sliding = 100 * manifold.rate * float(steps[stands].mean()) if stands.any() else 0.0
    share = bones / (100 * manifold.lengths[1:].mean()) * 100
    return position_error(motion, truth), bones, share, sliding
