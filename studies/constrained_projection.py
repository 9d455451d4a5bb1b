"""Compare a projection that keeps bone lengths, standing feet and the ground with the plain one.

It is future work in holden2015, section 7. docs/lab_book/constraints.md has the findings.

    python -m studies constrained_projection --data bandai --test '*_005.bvh' -m best.npz
"""

import numpy as np

from numpy_cae.evaluation import position_error
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.training import zero_values
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH
from studies.constraints.constrained import project_constrained
from studies.shared.body import bone_length_error
from studies.shared.material import LabelledTake, Material, evenly
from studies.shared.result import Claim, Result, Table, moving

TAKES = 6
"""Of each source, spread over all test takes; an optimisation takes about a second."""
MAX_FRAMES = 320
P = 0.5
PLAIN_ROW, KEPT_ROW, TRUE = "plain projection", "constrained projection", "truth"
COLOURS = {TRUE: TRUTH, PLAIN_ROW: PLAIN, KEPT_ROW: PROJECTED}
HEADER = ("method", "position, cm", "bone length, cm", "of it, %", "sliding, cm/s")
FORMATS = ("", ".2f", ".3f", ".3f", ".2f")
Measured = dict[str, np.ndarray]
"""Method to the values of a row."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Project test takes, as they are and with half of their values removed, in both ways.

    Sliding is measured in the contacts that the constraint was given: those found in the plain
    projection, as the truth is unknown where a motion has to be repaired.
    """
    tables = []
    claims = []
    motions = None
    for source in dict.fromkeys(take.source for take in material.testing):
        takes = evenly(material.of(source).testing, TAKES)
        for lost, state in ((0.0, "as they are"), (P, "with half of the values removed")):
            rng = np.random.default_rng(seed)
            each = [_measured(manifold, take, lost, rng) for take in takes]
            of_takes = [values for values, _ in each]
            measured = {name: np.mean([of[name] for of in of_takes], axis=0) for name in COLOURS}
            name = f"{source}, {len(takes)} takes {state}"
            rows = [[method, *values] for method, values in measured.items()]
            tables.append(Table(f"{name}:", HEADER, rows, FORMATS))
            claims.append(_constraint_claim(name, measured))
            motions = motions or each[0][1]
    drawn = {name: (x, COLOURS[name]) for name, x in motions.items()}
    return Result(
        "Constrained projection: bones, feet and ground",
        tables,
        claims,
        {"constrained_projection": moving(drawn, manifold.rate, azimuth=75.0)},
    )


def _measured(
    manifold: MotionManifold, take: LabelledTake, lost: float, rng: np.random.Generator
) -> tuple[Measured, dict[str, np.ndarray]]:
    """The row of each method on one take, and its motions as features."""
    features, start = manifold.features(take.positions[:MAX_FRAMES])
    given = manifold.denormalise(zero_values(manifold.normalise(features), lost, rng))
    plain = manifold.project(given, average_shifts=True)
    contacts = find_contacts(features_to_positions(plain, start), manifold.rate)
    kept = project_constrained(manifold, given, start, contacts)
    motions = {TRUE: features, PLAIN_ROW: plain, KEPT_ROW: kept}
    rows = {}
    for name, motion in motions.items():
        positions = features_to_positions(motion, start)
        bones = bone_length_error(positions, manifold.lengths)
        share = bones / manifold.lengths[1:].mean()
        sliding = _sliding(positions, contacts, manifold.rate)
        rows[name] = np.array([position_error(motion, features), bones, share, sliding])
    return rows, motions


def _sliding(positions: np.ndarray, contacts: np.ndarray, rate: float) -> float:
    """Mean speed along the ground of feet in contact, cm/s."""
    steps = np.linalg.norm(np.diff(positions[:, FEET][..., [0, 2]], axis=0), axis=-1)
    stands = contacts[1:] & contacts[:-1]
    return 100 * rate * float(steps[stands].mean()) if stands.any() else 0.0


def _constraint_claim(name: str, measured: Measured) -> Claim:
    position, _, share, sliding = measured[PLAIN_ROW]
    kept_position, _, kept_share, kept_sliding = measured[KEPT_ROW]
    kept = kept_share < 0.1 and kept_sliding <= sliding / 5 and kept_position <= position
    figures = f"bones {share:.2f}% off before, {kept_share:.1e}% after; feet slide {sliding:.2f} "
    figures += f"cm/s before, {kept_sliding:.2f} after; position {position:.2f} cm before, "
    return Claim("constraints_kept", bool(kept), f"{figures}{kept_position:.2f} after.", name)
