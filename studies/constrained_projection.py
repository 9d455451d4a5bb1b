"""A projection that is set on bones of constant length, with feet that stand still.

It is future work in holden2015, section 7: "Currently the manifold projection cannot guarantee
constraints such as ground contact and joint lengths." The projection is fitted by rotations of
bones of the manifold's lengths (`motion.fit_motion`); then its feet are mended as `repair --feet`
mends them. docs/lab_book/constraints.md has the findings, also of an optimisation over the hidden
units, which was nearer to the truth and took a quarter of a minute a take.

    python -m studies constrained_projection --data bandai --test '*_005.bvh' -m best.npz
"""

import numpy as np

from numpy_cae.evaluation import position_error
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import body_positions
from numpy_cae.motion import features_to_positions
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.motion.fit import fit_motion
from numpy_cae.repair.feet import find_feet, mend_feet
from numpy_cae.training import zero_values
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH
from studies.shared.body import bone_length_error
from studies.shared.material import LabelledTake, Material, evenly
from studies.shared.result import Claim, Result, Table, moving

TAKES = 6
"""TAKES: at most so many test takes, spread over all."""
P = 0.5
TRUE = "truth"
PLAIN_ROW = "plain projection"
KEPT_ROW = "constrained projection"
COLOURS = {TRUE: TRUTH, PLAIN_ROW: PLAIN, KEPT_ROW: PROJECTED}
HEADER = ("method", "position, cm", "bone length, cm", "sliding, cm/s")
FORMATS = ("", ".2f", ".3f", ".2f")
MOST_OFF = 0.01
"""MOST_OFF: bones keep their lengths if they are off by at most this (cm)."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Project test takes, as they are and with half of their values removed, in both ways."""
    tables = []
    claims = []
    takes = evenly(material.testing, TAKES)
    for lost, state in ((0.0, "as they are"), (P, "with half of the values removed")):
        rng = np.random.default_rng(seed)
        made = [_motions(manifold, take, lost, rng) for take in takes]
        measured = np.mean([_measured(manifold, each) for each in made], axis=0)
        rows = [[name, *values] for name, values in zip(COLOURS, measured, strict=True)]
        of = f"{len(takes)} takes {state}"
        tables.append(Table(f"{of}:", HEADER, rows, FORMATS))
        claims.append(_claim(of, *measured[1:]))
    drawn = {name: (x, COLOURS[name]) for name, (x, _) in made[0].items()}
    pictures = {"constrained_projection": moving(drawn, manifold.rate, azimuth=75.0)}
    return Result("Constrained projection: bones and feet", tables, claims, pictures)


def _motions(
    manifold: MotionManifold, take: LabelledTake, lost: float, rng: np.random.Generator
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The features and the positions of a take and of its projections."""
    features, start = manifold.features(take.positions)
    given = manifold.denormalise(zero_values(manifold.normalise(features), lost, rng))
    plain = manifold.project(given, average_shifts=True)
    positions = features_to_positions(plain, start)
    fitted = fit_motion(positions, manifold.lengths, manifold.rate)
    kept = body_positions(mend_feet(fitted, find_feet(fitted, sensitivity=1.0)))
    return {
        TRUE: (features, features_to_positions(features, start)),
        PLAIN_ROW: (plain, positions),
        KEPT_ROW: (manifold.features(kept)[0], kept),
    }


def _measured(
    manifold: MotionManifold, motions: dict[str, tuple[np.ndarray, np.ndarray]]
) -> list[tuple[float, float, float]]:
    """The rows of a table. Sliding is measured where feet stand in the plain projection, since the
    truth is unknown where a motion has to be repaired."""
    contacts = find_contacts(motions[PLAIN_ROW][1], manifold.rate)
    return [
        (
            position_error(features, motions[TRUE][0]),
            bone_length_error(positions, manifold.lengths),
            _sliding(positions, contacts, manifold.rate),
        )
        for features, positions in motions.values()
    ]


def _sliding(positions: np.ndarray, contacts: np.ndarray, rate: float) -> float:
    """Mean speed along the ground of feet in contact, cm/s."""
    steps = np.linalg.norm(np.diff(positions[:, FEET][..., [0, 2]], axis=0), axis=-1)
    stands = contacts[1:] & contacts[:-1]
    return 100 * rate * float(steps[stands].mean()) if stands.any() else 0.0


def _claim(of: str, plain: np.ndarray, kept: np.ndarray) -> Claim:
    position, bones, sliding = kept
    confirmed = bones < MOST_OFF and sliding <= plain[2] / 5 and position <= plain[0]
    figures = f"bones {plain[1]:.2f} cm off before, {bones:.1e} after; feet slide {plain[2]:.2f} "
    figures += f"cm/s before, {sliding:.2f} after; position {plain[0]:.2f} cm before, "
    return Claim("constraints_kept", bool(confirmed), f"{figures}{position:.2f} after.", of)
